// Priors of fluents that only the low level has.

#include <string>
#include <tuple>

#include "fixtures.hpp"
#include "kr3_refinement/domain_task.hpp"

namespace kr3::refinement
{
namespace
{

using test::expectError;

const char* const kHighLevel = R"(
sorts
  rack = {near, far}.
  box = {a, b}.
  grade = {fine, coarse, rough}.
fluents
  inertial at(box) : rack.
  inertial packed(box).
actions
  pack(box, rack).
axioms
  pack(X, R) causes packed(X).
  impossible pack(X, R) if at(X) = R2, R != R2.
  impossible A1, A2 if A1 != A2.
)";

const char* const kRefinement = R"(
magnify rack into slot by slot_of.
fluents
  inertial jammed(slot).
  inertial surface(box) : grade.
  inertial label(box) : slot.
actions
  clear(slot).
axioms
  clear(S) causes -jammed(S).
  impossible pack(X, S) if jammed(S).
)";

std::string modelsWith(const std::string& priors)
{
  return priors + R"(
actions:
  pack(X, S): {cost: {base_s: 1.0, impossible_s: 2.0}}
  clear(S): {cost: {base_s: 1.0, impossible_s: 2.0}}
)";
}

const LowLevelDomain& domain()
{
  static const LowLevelDomain composed =
      test::composed(kHighLevel, kRefinement, gridMap({"near", "far"}, 2, 1.0));
  return composed;
}

PomdpTask task(const std::string& priors, InitialKnowledge knowledge = {})
{
  const Models models = parseModels(modelsWith(priors), "models.yaml", domain());
  const Zoom zoomed =
      zoom(domain(), {reasoner::parseGroundLiteral("at(a) = near", domain().highLevel())},
           reasoner::parseGroundAction("pack(a, near)", domain().highLevel()));
  knowledge.fine["at(a)"] = {{"near_c0", 1.0}};
  return generatePomdp(domain(), models, zoomed, knowledge);
}

double start(const PomdpTask& task, const std::string& fluent, const std::string& value)
{
  const Distribution marginal = task.fineMarginal(task.model().initialBelief(), fluent);
  const auto entry = marginal.find(value);
  return entry == marginal.end() ? 0.0 : entry->second;
}

TEST(FluentPrior, WithoutOneABooleanIsFalseAndAValueAnyOfItsSort)
{
  const PomdpTask plain = task("");
  EXPECT_DOUBLE_EQ(start(plain, "jammed(near_c0)", "false"), 1.0);
  EXPECT_NEAR(start(plain, "surface(a)", "rough"), 1.0 / 3.0, 1e-12);
  EXPECT_NEAR(start(plain, "label(a)", "near_c1"), 0.25, 1e-12);
  EXPECT_NEAR(start(plain, "label(a)", kElsewhere), 0.5,
              1e-12);  // two of four slots are zoomed away
}

TEST(FluentPrior, IsTheStartOfEachGroundFluent)
{
  const PomdpTask given = task(
      "priors: {jammed(S): 0.2, surface(X): {fine: 0.7, rough: 0.3}, label(X): {near_c0: 0.1, "
      "far_c1: 0.9}}");
  EXPECT_NEAR(start(given, "jammed(near_c0)", "true"), 0.2, 1e-12);
  EXPECT_NEAR(start(given, "jammed(near_c1)", "true"), 0.2, 1e-12);
  EXPECT_NEAR(start(given, "surface(a)", "fine"), 0.7, 1e-12);
  EXPECT_NEAR(start(given, "surface(a)", "coarse"), 0.0, 1e-12);
  EXPECT_NEAR(start(given, "label(a)", kElsewhere), 0.9, 1e-12);
  EXPECT_NEAR(start(task("priors: {jammed(S): uniform}"), "jammed(near_c0)", "true"), 0.5, 1e-12);
}

// The slots are independent of each other: what is known of one says nothing of the others.
TEST(FluentPrior, GivesWayToWhatIsKnown)
{
  const PomdpTask known =
      task("priors: {jammed(S): 0.2}", {{{"jammed(near_c0)", {{"true", 1.0}}}}, {}});
  EXPECT_DOUBLE_EQ(start(known, "jammed(near_c0)", "true"), 1.0);
  EXPECT_NEAR(start(known, "jammed(near_c1)", "true"), 0.2, 1e-12);
}

TEST(FluentPrior, IsThatOfTheWholeDomainToo)
{
  const Models models =
      parseModels(modelsWith("priors: {jammed(S): 0.2, surface(X): {fine: 0.7, rough: 0.3}}"),
                  "models.yaml", domain());
  DomainTask whole(domain(), models,
                   {"a", "near", "near_c0", "near_c1", "fine", "coarse", "rough"});
  InitialKnowledge knowledge;
  knowledge.coarse["at(a)"] = {{"near", 1.0}};
  const SparseBelief belief = whole.initialBelief(knowledge, 1000);
  for (const auto& [fluent, value, probability] :
       {std::make_tuple("jammed(near_c1)", "true", 0.2), std::make_tuple("surface(a)", "fine", 0.7),
        std::make_tuple("packed(a)", "true", 0.0), std::make_tuple("at(a)", "near_c1", 0.5)})
  {
    const Distribution marginal = whole.fineMarginal(belief, *whole.space().findFluent(fluent));
    const auto entry = marginal.find(value);
    EXPECT_NEAR(entry == marginal.end() ? 0.0 : entry->second, probability, 1e-12) << fluent;
  }
}

// A way that begins outside the zoom is as long as those from there on average.
TEST(FluentPrior, AWayFromElsewhereIsTheMeanOne)
{
  const Models models = parseModels(
      "actions:\n  pack(X, S):\n    cost: {base_s: 1.0, per_metre_s: 2.0, distance: {from: "
      "label(X), to: S}, impossible_s: 50.0}\n"
      "  clear(S): {cost: {base_s: 1.0, impossible_s: 2.0}}\n",
      "models.yaml", domain());
  const Zoom zoomed =
      zoom(domain(), {reasoner::parseGroundLiteral("at(a) = near", domain().highLevel())},
           reasoner::parseGroundAction("pack(a, near)", domain().highLevel()));
  const PomdpTask task =
      generatePomdp(domain(), models, zoomed, {{{"at(a)", {{"near_c0", 1.0}}}}, {}});
  const ComponentMap& map = domain().map();
  const auto metres = [&](const std::string& from) {
    return map.distance(*map.find(from), *map.find("near_c0"));
  };
  const std::size_t pack = *task.model().findAction("pack(a,near_c0)");
  const auto seconds = [&](const std::string& label) {
    const std::string name =
        "at(a)=near_c0,packed(a)=false,jammed(near_c0)=false,"
        "jammed(near_c1)=false,surface(a)=fine,label(a)=" +
        label;
    const auto state = task.model().findState(name);
    EXPECT_TRUE(state) << name << ", the first is " << task.model().stateName(0);
    return state ? -task.model().reward(pack, *state) : 0.0;
  };
  EXPECT_GT(metres("far_c0") + metres("far_c1"), 0.0);
  EXPECT_NEAR(seconds("near_c1"), 1.0 + 2.0 * metres("near_c1"), 1e-9);
  EXPECT_NEAR(seconds(kElsewhere), 1.0 + metres("far_c0") + metres("far_c1"), 1e-9);
}

// What the high level does not know of cannot be found irrelevant by it.
TEST(LowLevelSorts, AreNotZoomedAway)
{
  const LowLevelDomain tools = test::composed(kHighLevel, R"(
sorts
  tool = {hook, fork}.
magnify rack into slot by slot_of.
fluents
  inertial fitted(tool).
  inertial surface(box) : grade.
actions
  fit(tool).
axioms
  fit(T) causes fitted(T).
  impossible pack(X, S) if -fitted(hook), surface(X) = rough.
)",
                                              gridMap({"near", "far"}, 1, 1.0));
  const Zoom zoomed = zoom(tools, {reasoner::parseGroundLiteral("at(a) = near", tools.highLevel())},
                           reasoner::parseGroundAction("pack(a, near)", tools.highLevel()));
  for (const std::string constant : {"hook", "fork", "rough", "fine"})
  {
    EXPECT_EQ(zoomed.constants.count(constant), 1U) << constant;
  }
  EXPECT_EQ(zoomed.constants.count("b"), 0U);
  const Models models = parseModels(
      "actions:\n  pack(X, S): {cost: {base_s: 1.0, impossible_s: 2.0}}\n"
      "  fit(T): {cost: {base_s: 1.0, impossible_s: 2.0}}\n",
      "models.yaml", tools);
  const PomdpTask made =
      generatePomdp(tools, models, zoomed, {{{"at(a)", {{"near_c0", 1.0}}}}, {}});
  const std::size_t pack = *made.model().findAction("pack(a,near_c0)");
  std::size_t impossible = 0;
  for (std::size_t state = 0; state < made.boundaryState(); ++state)
  {
    const bool rough = made.model().stateName(state).find("surface(a)=rough") != std::string::npos;
    const bool hook = made.model().stateName(state).find("fitted(hook)=true") != std::string::npos;
    EXPECT_EQ(made.isExecutable(pack, state), hook || !rough) << made.model().stateName(state);
    impossible += made.isExecutable(pack, state) ? 0U : 1U;
  }
  EXPECT_GT(impossible, 0U);
}

TEST(FluentPrior, IsRefusedWithPlaceAndMend)
{
  struct Bad
  {
    std::string text;
    std::string told;
  };
  for (const Bad& bad :
       {Bad{"priors: 0.3", "models.yaml:1: priors: found '0.3', expected a map"},
        Bad{"priors: {at(X): uniform}",
            "models.yaml:1: priors: 'at(X)' is no inertial fluent of the low level alone"},
        Bad{"priors: {jamed(S): 0.3}", "did you mean 'jammed'?"},
        Bad{"priors:\n  jammed(S, T): 0.3",
            "priors: 'jammed(S, T)' has 2 arguments, expected 1, of the sorts 'slot'"},
        Bad{"priors: {jammed(S): 1.3}",
            "priors, jammed: found '1.3', expected a number from 0 to 1"},
        Bad{"priors: {jammed(S): often}", "priors, jammed: found 'often', expected a number"},
        Bad{"priors: {surface(X): 0.3}",
            "priors, surface: found '0.3', expected 'uniform' or probabilities by value"},
        Bad{"priors: {surface(X): {fine: 0.3}}",
            "priors, surface: the probabilities sum to 0.300000, expected 1"},
        Bad{"priors: {surface(X): {smooth: 1.0}}", "priors, surface: unknown key 'smooth'"},
        Bad{"priors:\n  surface(X): uniform\n  surface(Y): uniform",
            "models.yaml:3: priors: 'surface' a second time"}})
  {
    expectError(ErrorCode::kInvalidArgument, bad.told,
                [&] { (void)parseModels(modelsWith(bad.text), "models.yaml", domain()); });
  }
}

}  // namespace
}  // namespace kr3::refinement
