#include "kr3_pomdp/factored_model.hpp"

#include <string>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_pomdp/solver.hpp"
#include "support/models.hpp"

namespace kr3::pomdp
{
namespace
{

constexpr VariableRole kBefore = VariableRole::kPrevious;
constexpr VariableRole kAfter = VariableRole::kCurrent;
constexpr VariableRole kAct = VariableRole::kAction;
constexpr VariableRole kSee = VariableRole::kObservation;

/// Two lamps; each switch toggles its lamp with probability 0.9. The robot sees the first lamp and
/// a sensor that tells the second with probability 0.8; it is paid for each lamp that shines.
FactoredModel lamps()
{
  FactoredModel model;
  model.discount = 0.9;
  StateVariable left{{"left", {"off", "on"}}, true};
  StateVariable right{{"right", {"off", "on"}}, false};
  model.state = {left, right};
  model.actions = {{"switch", {"none", "left", "right"}}};
  model.observations = {{"sensor", {"dark", "light"}}};
  model.initial = {{{}, {{kBefore, 0}}, {0.25, 0.75}},
                   {{{kBefore, 0}}, {{kBefore, 1}}, {0.5, 0.5, 1.0, 0.0}}};
  for (std::size_t lamp = 0; lamp < 2; ++lamp)
  {
    Factor factor{{{kAct, 0}, {kBefore, lamp}}, {{kAfter, lamp}}, {}};
    for (std::size_t action = 0; action < 3; ++action)
    {
      const double stays = action == lamp + 1 ? 0.1 : 1.0;
      factor.values.insert(factor.values.end(), {stays, 1.0 - stays, 1.0 - stays, stays});
    }
    model.transitions.push_back(factor);
    model.rewards.push_back({{{kBefore, lamp}}, {}, {0.0, 1.0}});
  }
  model.observing = {{{{kAfter, 1}}, {{kSee, 0}}, {0.8, 0.2, 0.2, 0.8}}};
  return model;
}

double entry(const SparseRow& row, std::size_t index)
{
  for (const SparseEntry& e : row)
  {
    if (e.index == index)
    {
      return e.probability;
    }
  }
  return 0.0;
}

std::string errorOf(const FactoredModel& model)
{
  try
  {
    (void)model.flattened();
  }
  catch (const Error& e)
  {
    return e.what();
  }
  return "no error";
}

TEST(FactoredModel, FlattensToTheProductOfItsFactors)
{
  const Model model = lamps().flattened();
  ASSERT_EQ(model.numStates(), 4U);
  EXPECT_EQ(model.stateName(1), "off,on");
  EXPECT_EQ(model.observationName(1), "dark,on");  // the sensor, then the lamp that is seen
  EXPECT_DOUBLE_EQ(model.initialBelief()[0], 0.125);
  EXPECT_DOUBLE_EQ(model.initialBelief()[2], 0.75);
  const std::size_t right = *model.findAction("right");
  EXPECT_DOUBLE_EQ(entry(model.transitions(right, 2), 3), 0.9);
  EXPECT_DOUBLE_EQ(entry(model.transitions(right, 2), 2), 0.1);
  EXPECT_DOUBLE_EQ(entry(model.observations(right, 3), *model.findObservation("light,on")), 0.8);
  EXPECT_DOUBLE_EQ(entry(model.observations(right, 3), *model.findObservation("light,off")), 0.0);
  EXPECT_DOUBLE_EQ(model.reward(0, 3), 2.0);
}

TEST(FactoredModel, TellsWhatIsSeenBeforeTheFirstAction)
{
  const std::vector<InitialOutcome> outcomes = lamps().flattened().initialOutcomes();
  ASSERT_EQ(outcomes.size(), 2U);
  EXPECT_DOUBLE_EQ(outcomes[0].probability, 0.25);
  EXPECT_DOUBLE_EQ(outcomes[0].belief[1], 0.5);
  EXPECT_DOUBLE_EQ(outcomes[1].probability, 0.75);
  EXPECT_DOUBLE_EQ(outcomes[1].belief[2], 1.0);
}

TEST(FactoredModel, SeeingFirstIsWorthTheExpectationOverWhatIsSeen)
{
  SolverLimits limits;
  limits.precision = 1e-6;
  limits.max_backups = 200000;
  const Model model = lamps().flattened();
  double expected = 0.0;
  for (const InitialOutcome& outcome : model.initialOutcomes())
  {
    expected += outcome.probability * solve(model.withInitialBelief(outcome.belief), limits).lower;
  }
  const SolveResult result = solve(model, limits);
  EXPECT_NEAR(result.lower, expected, 3e-6);
  EXPECT_LE(result.upper - result.lower, 1e-6);
  // Who sees nothing first cannot earn more.
  EXPECT_LE(solve(model.withInitialBelief(model.initialBelief()), limits).lower,
            result.upper + 1e-9);
}

TEST(FactoredModel, RewardsOfWhatFollowsAreExpected)
{
  FactoredModel model = lamps();
  model.rewards = {{{{kAfter, 1}, {kSee, 0}}, {}, {0.0, 0.0, 0.0, 10.0}}};
  const Model flat = model.flattened();
  // The right lamp shines afterwards with 0.9, and the sensor says so with 0.8.
  EXPECT_NEAR(flat.reward(*flat.findAction("right"), 0), 7.2, 1e-12);
}

TEST(FactoredModel, SaysWhichFactorIsWrong)
{
  FactoredModel model = lamps();
  model.transitions[1].values[5] = 0.5;
  EXPECT_EQ(errorOf(model),
            "P(right | ...) given switch = left, right = off sums to 1.500000, expected 1");
  model = lamps();
  model.transitions.pop_back();
  EXPECT_EQ(errorOf(model), "no probabilities are given for 'right'");
  model = lamps();
  model.transitions.push_back(model.transitions[0]);
  EXPECT_EQ(errorOf(model),
            "P(left | ...): 'left' has another factor already, or none of this kind");
  model = lamps();
  model.observing[0].values.pop_back();
  EXPECT_EQ(errorOf(model), "P(sensor | ...) has 3 entries, expected 4");
  model = lamps();
  model.transitions[0].parents.push_back({kAfter, 1});
  model.transitions[1].parents.push_back({kAfter, 0});
  for (Factor& factor : model.transitions)
  {
    factor.values.assign(model.sizeOf(factor), 0.5);
  }
  EXPECT_EQ(errorOf(model), "P(left | ...) depends on itself");
}

TEST(FactoredModel, RefusesMoreStatesThanFit)
{
  FactoredModel model = lamps();
  StateVariable wide{{"wide", std::vector<std::string>(1U << 23U, "v")}, false};
  model.state.push_back(wide);
  EXPECT_EQ(errorOf(model), "more than 16777216 states");
}

}  // namespace
}  // namespace kr3::pomdp
