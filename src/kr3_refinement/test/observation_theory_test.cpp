// The theory of observations: laws of the papers, in every state of small zooms.

#include "kr3_refinement/observation_theory.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <kr3_reasoner/transition_system.hpp>

#include "fixtures.hpp"

namespace kr3::refinement
{
namespace
{

/// A transition system whose states are asked by the names of fluents.
class Diagram
{
public:
  Diagram(const reasoner::Description& description, const std::set<std::string>& constants)
    : system_(reasoner::restricted(description, constants))
  {
    for (std::size_t i = 0; i < system_.fluents().size(); ++i)
    {
      index_[system_.fluents()[i].name] = i;
    }
  }

  [[nodiscard]] std::size_t size() const { return system_.states().size(); }
  [[nodiscard]] const std::string& value(std::size_t state, const std::string& fluent) const
  {
    const std::size_t i = index_.at(fluent);
    return system_.fluents()[i].values.at(static_cast<std::size_t>(system_.states()[state][i]));
  }
  [[nodiscard]] bool holds(std::size_t state, const std::string& fluent) const
  {
    return value(state, fluent) == "true";
  }
  [[nodiscard]] const reasoner::TransitionSystem& system() const { return system_; }

private:
  reasoner::TransitionSystem system_;
  std::map<std::string, std::size_t> index_;
};

/// An office with two cells in the kitchen and one in the corridor.
LowLevelDomain office()
{
  ComponentMapData data{{{"k1", "kitchen"}, {"k2", "kitchen"}, {"c1", "corridor"}}, {}, {}, {}};
  for (const char* place : {"office", "main_library", "aux_library", "study_corner"})
  {
    data.components.push_back({std::string(place) + "_c", place});
  }
  return test::composed(test::textOf(test::domainFile("office", "domain.kr3")),
                        test::textOf(test::domainFile("office", "refinement.kr3")),
                        ComponentMap(data));
}

const std::set<std::string> kKitchen{"rob1", "tb1", "kitchen", "corridor", "k1", "k2", "c1"};

TEST(ObservationTheory, DefinesWhatTheOfficeSpellsOut)
{
  const Diagram diagram(withObservationTheory(office()), kKitchen);
  std::size_t compared = 0;
  for (std::size_t s = 0; s < diagram.size(); ++s)
  {
    bool same = true;
    for (const char* cell : {"k1", "k2", "c1"})
    {
      same = same && diagram.value(s, std::string("searched(") + cell + ", tb1)") ==
                         diagram.value(s, std::string("tested_loc(tb1, ") + cell + ")");
    }
    if (!same)
    {
      continue;  // the two are set by the same action
    }
    ++compared;
    for (const char* cell : {"k1", "k2", "c1"})
    {
      EXPECT_EQ(diagram.value(s, std::string("found(tb1, ") + cell + ")"),
                diagram.value(s, std::string("observed_loc(tb1, ") + cell + ")"));
    }
    for (const std::string place : {"kitchen", "corridor"})
    {
      EXPECT_EQ(diagram.value(s, "found_in(tb1, " + place + ")"),
                diagram.value(s, "found_loc(tb1, " + place + ")"));
      EXPECT_EQ(diagram.value(s, "continue_search(" + place + ", tb1)"),
                diagram.value(s, "may_discover_loc(tb1, " + place + ")"));
      const bool there = (diagram.value(s, "loc(rob1)") == "c1") == (place == "corridor");
      EXPECT_EQ(diagram.holds(s, "failure(tb1, " + place + ")"),
                there && diagram.holds(s, "failure_loc(tb1, " + place + ")"));
    }
  }
  EXPECT_GT(compared, 50U);
}

TEST(ObservationTheory, FailsExactlyWhereAllPartsWereTestedAndNoneHasIt)
{
  const Diagram diagram(withObservationTheory(office()), kKitchen);
  std::size_t failures = 0;
  for (std::size_t s = 0; s < diagram.size(); ++s)
  {
    const bool all =
        diagram.holds(s, "tested_loc(tb1, k1)") && diagram.holds(s, "tested_loc(tb1, k2)");
    const bool here = diagram.value(s, "loc(tb1)") != "c1";
    const bool seen =
        here && diagram.holds(s, "tested_loc(tb1, " + diagram.value(s, "loc(tb1)") + ")");
    EXPECT_EQ(diagram.holds(s, "found_loc(tb1, kitchen)"), seen);
    EXPECT_EQ(diagram.holds(s, "may_discover_loc(tb1, kitchen)"), !seen && !all);
    EXPECT_EQ(diagram.holds(s, "failure_loc(tb1, kitchen)"), all && !here);
    failures += diagram.holds(s, "failure_loc(tb1, kitchen)") ? 1 : 0;
  }
  EXPECT_GT(failures, 0U);
}

TEST(ObservationTheory, StartsAfreshAndLearnsByTests)
{
  const reasoner::Description theory = withObservationTheory(office());
  const Diagram diagram(theory, kKitchen);
  const std::vector<reasoner::Literal> fresh =
      freshKnowledge(reasoner::restricted(theory, kKitchen));
  std::size_t starts = 0;
  for (std::size_t s = 0; s < diagram.size(); ++s)
  {
    const bool is_start = std::all_of(fresh.begin(), fresh.end(), [&](const auto& literal) {
      return !diagram.holds(s, reasoner::toString(literal.atom));
    });
    if (!is_start)
    {
      continue;
    }
    ++starts;
    EXPECT_TRUE(diagram.holds(s, "may_discover_loc(tb1, kitchen)"));
    EXPECT_FALSE(diagram.holds(s, "failure_loc(tb1, kitchen)"));
    for (std::size_t a = 0; a < diagram.system().actions().size(); ++a)
    {
      const std::string& action = diagram.system().actions()[a];
      if (!diagram.system().executable(s, a))
      {
        continue;
      }
      for (const auto& next : diagram.system().successors(s, a))
      {
        for (const std::string cell : {"k1", "k2", "c1"})
        {
          EXPECT_EQ(diagram.holds(next.state, "tested_loc(tb1, " + cell + ")"),
                    action == "search(rob1, " + cell + ", tb1)")
              << action;
        }
        // A drive tells which cell it is, so that every cell is tested, and observed to be so.
        const bool moved = action.rfind("move", 0) == 0;
        EXPECT_EQ(moved,
                  diagram.holds(next.state, "observed_loc(rob1, " +
                                                diagram.value(next.state, "loc(rob1)") + ")"))
            << action;
      }
    }
  }
  EXPECT_GT(starts, 0U);
}

TEST(ObservationTheory, HoldsWhereNothingIsAPlace)
{
  const Diagram diagram(withObservationTheory(test::workbench().low_level),
                        {"tech1", "hum", "tuner", "antenna_stage", "mixer"});
  for (std::size_t s = 0; s < diagram.size(); ++s)
  {
    const bool both = diagram.holds(s, "tested_opened(mixer)") &&
                      diagram.holds(s, "tested_opened(antenna_stage)");
    const bool found =
        (diagram.holds(s, "tested_opened(mixer)") && diagram.holds(s, "opened(mixer)")) ||
        (diagram.holds(s, "tested_opened(antenna_stage)") &&
         diagram.holds(s, "opened(antenna_stage)"));
    EXPECT_EQ(diagram.holds(s, "found_opened(tuner)"), found);
    EXPECT_EQ(diagram.holds(s, "failure_opened(tuner)"), both && !found);
    EXPECT_EQ(diagram.holds(s, "failure_resolved(hum)"),
              diagram.holds(s, "tested_resolved(hum)") && !diagram.holds(s, "resolved(hum)"));
  }
}

TEST(ObservationTheory, TellsValuesOfFluentsWithSeveralArguments)
{
  const LowLevelDomain domain =
      test::composed(test::textOf(test::domainFile("waterworks", "domain.kr3")),
                     test::textOf(test::domainFile("waterworks", "refinement.kr3")),
                     readComponentMap(test::domainFile("waterworks", "map.yaml")));
  const reasoner::Description theory = withObservationTheory(domain);
  EXPECT_EQ(theory.findFluent("tested_origin")->argument_sorts,
            (std::vector<std::string>{"district", "medium", "sign", "joint"}));
  EXPECT_EQ(theory.findFluent("failure_origin")->argument_sorts,
            (std::vector<std::string>{"district", "medium", "sign", "main"}));
  const Diagram diagram(theory, {"old_town", "heating", "hiss", "crew1", "north_main", "ring_main",
                                 "north_valve", "north_bend", "ring_valve"});
  const std::string report = "origin(old_town, heating, hiss";
  std::size_t refuted = 0;
  for (std::size_t s = 0; s < diagram.size(); ++s)
  {
    const bool all = diagram.holds(s, "tested_" + report + ", north_valve)") &&
                     diagram.holds(s, "tested_" + report + ", north_bend)");
    const bool there = diagram.value(s, report + ")") != "ring_valve";
    EXPECT_EQ(diagram.holds(s, "failure_" + report + ", north_main)"), all && !there);
    refuted += all && !there ? 1 : 0;
  }
  EXPECT_GT(refuted, 0U);
}

TEST(ObservationTheory, RefusesNamesThatTheDomainUses)
{
  const LowLevelDomain domain = test::composed(
      "sorts\n  box = {b1}.\nfluents\n  inertial full(box).\nactions\n  fill(box).\naxioms\n"
      "  fill(B) causes full(B).\n",
      "fluents\n  knowledge tested_full(box).\nobservations\n  fill(B) observes full(B).\n",
      ComponentMap({}));
  test::expectError(ErrorCode::kInvalidArgument, "'tested_full' is declared in the domain",
                    [&] { (void)withObservationTheory(domain); });
}

}  // namespace
}  // namespace kr3::refinement
