// Laws that name values outside the zoom, in states where a fluent is `elsewhere`.

#include <algorithm>

#include <gtest/gtest.h>

#include "fixtures.hpp"

namespace kr3::refinement
{
namespace
{

using test::Domain;

/// A box on one of six shelves of three racks, whose lamps are magnified.
Domain racks(const std::string& low_axioms)
{
  LowLevelDomain low_level = test::composed(R"(
sorts
  shelf = {near_c0, near_c1, far_c0, far_c1, high_c0, high_c1}.
  rack = {near, far, high}.
  thing = {box}.
  lamp = {ceiling}.
statics
  of_rack(shelf) : rack.
  dark(shelf).
facts
  of_rack(near_c0) = near.
  of_rack(near_c1) = near.
  of_rack(far_c0) = far.
  of_rack(far_c1) = far.
  of_rack(high_c0) = high.
  of_rack(high_c1) = high.
  dark(far_c0).
  dark(high_c0).
fluents
  inertial on(thing) : shelf.
actions
  push(thing, shelf).
axioms
  push(X, S) causes on(X) = S.
)",
                                            R"(
magnify lamp into bulb by of_lamp.
fluents
  inertial warm(thing).
  inertial probed(thing).
  inertial dusty(shelf).
  defined shaded(thing).
  defined cased(thing).
actions
  probe(thing).
axioms
  probe(X) causes probed(X).
)" + low_axioms,
                                            gridMap({"ceiling"}, 2, 1.0));
  Models models = parseModels(R"(
actions:
  push(X, S): {cost: {base_s: 1.0, impossible_s: 2.0}}
  probe(X): {cost: {base_s: 1.0, impossible_s: 2.0}}
)",
                              "models.yaml", low_level.description());
  return {std::move(low_level), std::move(models)};
}

/// Both shelves of the rack `near` are in the zoom, the others are not.
PomdpTask pushingWith(const std::string& low_axioms)
{
  return racks(low_axioms)
      .task("push(box, near_c1)", {"on(box) = near_c0"}, {{}, {{"on(box)", {{"near_c0", 0.5}}}}});
}

/// The states with a value of on(box).
std::vector<std::size_t> statesAt(const PomdpTask& task, const std::string& value)
{
  std::vector<std::size_t> states;
  for (std::size_t state = 0; state < task.boundaryState(); ++state)
  {
    if (task.model().stateName(state).find("on(box)=" + value) != std::string::npos)
    {
      states.push_back(state);
    }
  }
  EXPECT_FALSE(states.empty()) << value;
  return states;
}

/// The probe can be carried out when the box is at a value, and nothing else is so.
bool canProbe(const std::string& low_axioms, const std::string& value)
{
  const PomdpTask task = pushingWith(low_axioms);
  const std::size_t probe = *task.model().findAction("probe(box)");
  const std::vector<std::size_t> states = statesAt(task, value);
  return std::any_of(states.begin(), states.end(),
                     [&](std::size_t state) { return task.isExecutable(probe, state); });
}

struct Law
{
  std::string axioms;
  bool inside = false;     ///< it can be carried out on near_c0
  bool elsewhere = false;  ///< and elsewhere
};

// Elsewhere, what some value outside forbids is forbidden, and what differs from values inside is
// known to differ.
TEST(Elsewhere, ForbidsWhatSomeValueOutsideForbids)
{
  const std::vector<Law> laws{
      {"impossible probe(X) if on(X) = near_c0.", false, true},
      {"impossible probe(X) if on(X) = far_c0.", true, false},
      {"impossible probe(X) if on(X) != near_c0.", true, false},
      {"impossible probe(X) if on(X) != far_c0.", false, false},
      {"impossible probe(X) if on(X) = S, of_rack(S) = far.", true, false},
      {"impossible probe(X) if on(X) = S, of_rack(S) = near.", false, true},
      {"impossible probe(X) if on(X) = S, of_rack(S) != near.", true, false},
      {"impossible probe(X) if on(X) = S, of_rack(S) != far.", false, false},
      {"impossible probe(X) if on(X) = S, dark(S).", true, false},
      {"impossible probe(X) if on(X) = S, dark(S), of_rack(S) = near.", true, true},
      {"impossible probe(X) if on(X) = S, S = far_c1.", true, false},
      {"impossible probe(X) if on(X) = S, S != near_c0.", true, false},
      {"impossible probe(X) if on(X) = S, S != near_c0, S = near_c1.", true, true},
      {"impossible probe(X) if on(X) = S, dusty(S).", true, false},  // of far_c0: not in the state
      {"shaded(X) if on(X) = far_c0.\nimpossible probe(X) if shaded(X).", true, false},
      {"shaded(X) if on(X) = far_c0.\nimpossible probe(X) if -shaded(X).", false, false},
      {"shaded(X) if on(X) = S, of_rack(S) != near.\nimpossible probe(X) if -shaded(X).", false,
       true},
      {"shaded(X) if on(X) = far_c0.\ncased(X) if shaded(X).\nimpossible probe(X) if cased(X).",
       true, false},
  };
  for (const Law& law : laws)
  {
    EXPECT_EQ(canProbe(law.axioms, "near_c0"), law.inside) << law.axioms;
    EXPECT_EQ(canProbe(law.axioms, "elsewhere"), law.elsewhere) << law.axioms;
  }
}

/// Pr(warm(box) after a probe of the cold box elsewhere).
double warmed(const std::string& low_axioms)
{
  const PomdpTask task = pushingWith(low_axioms);
  const pomdp::Model& model = task.model();
  const std::size_t probe = *model.findAction("probe(box)");
  for (const std::size_t state : statesAt(task, "elsewhere"))
  {
    if (model.stateName(state).find("warm(box)=false") == std::string::npos)
    {
      continue;
    }
    EXPECT_TRUE(task.isExecutable(probe, state));
    double total = 0.0;
    for (const pomdp::SparseEntry& entry : model.transitions(probe, state))
    {
      const std::string& name = model.stateName(entry.index);
      EXPECT_NE(name.find("on(box)=elsewhere"), std::string::npos) << name;
      total += name.find("warm(box)=true") == std::string::npos ? 0.0 : entry.probability;
    }
    return total;
  }
  return -1.0;
}

// Four shelves lie outside: far_c0, far_c1, high_c0, high_c1.
TEST(Elsewhere, HasTheEffectsOfEachValueOutside)
{
  const auto warms = [](const std::string& body) {
    return warmed("probe(X) causes warm(X) if " + body + ".");
  };
  EXPECT_NEAR(warms("on(X) = near_c0"), 0.0, 1e-12);
  EXPECT_NEAR(warms("on(X) != near_c0"), 1.0, 1e-12);
  EXPECT_NEAR(warms("on(X) = far_c0"), 0.25, 1e-12);
  EXPECT_NEAR(warms("on(X) != far_c0"), 0.75, 1e-12);
  EXPECT_NEAR(warms("on(X) = S, of_rack(S) = far"), 0.5, 1e-12);
  EXPECT_NEAR(warms("on(X) = S, of_rack(S) != near"), 1.0, 1e-12);
  EXPECT_NEAR(warms("on(X) = S, dark(S), of_rack(S) = high"), 0.25, 1e-12);
  EXPECT_NEAR(warmed("shaded(X) if on(X) = S, dark(S).\nprobe(X) causes warm(X) if shaded(X)."),
              0.5, 1e-12);
}

/// There are states with the warm box at a value.
bool canBeWarm(const std::string& low_axioms, const std::string& value)
{
  const PomdpTask task = pushingWith(low_axioms);
  const std::vector<std::size_t> states = statesAt(task, value);
  return std::any_of(states.begin(), states.end(), [&](std::size_t state) {
    return task.model().stateName(state).find("warm(box)=true") != std::string::npos;
  });
}

// A state stands as long as some value outside allows it.
TEST(Elsewhere, ExcludesWhatEveryValueOutsideExcludes)
{
  EXPECT_TRUE(canBeWarm("-warm(X) if on(X) = far_c0.", "elsewhere"));
  EXPECT_TRUE(canBeWarm("-warm(X) if on(X) != far_c0.", "elsewhere"));
  EXPECT_FALSE(canBeWarm("-warm(X) if on(X) != near_c0.", "elsewhere"));
  EXPECT_FALSE(canBeWarm("-warm(X) if on(X) = S, of_rack(S) != near.", "elsewhere"));
  EXPECT_TRUE(canBeWarm("-warm(X) if on(X) = S, of_rack(S) = far.", "elsewhere"));
  EXPECT_TRUE(canBeWarm("-warm(X) if on(X) != near_c0.", "near_c0"));
}

}  // namespace
}  // namespace kr3::refinement
