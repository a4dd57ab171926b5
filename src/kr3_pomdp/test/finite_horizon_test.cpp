#include "kr3_pomdp/finite_horizon.hpp"

#include <cmath>
#include <random>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "support/cases.hpp"
#include "support/oracles.hpp"

namespace kr3::pomdp
{
namespace
{

double greatestReward(const Model& model)
{
  return test::scaleOf(model) * (1.0 - model.discount());
}

TEST(FiniteHorizon, BoundsHoldTheBestValueWithAnyDiscount)
{
  test::forEachModel(40, [](const Model& discounted, std::uint64_t seed) {
    const Model model = seed % 3 == 0 ? discounted : test::withDiscount(discounted, 1.0);
    const int steps = model.numObservations() * model.numActions() > 12 ? 2 : 3;
    double best = 0.0;
    for (const InitialOutcome& outcome : model.initialOutcomes())
    {
      best += outcome.probability * test::bestValueOver(model, outcome.belief, steps);
    }
    const double slack = 1e-9 * (1.0 + greatestReward(discounted));
    for (const std::uint64_t count : {1U, 5U, 2000U})
    {
      const SolveResult result =
          solveOver(model, static_cast<std::size_t>(steps), test::backups(count, slack)).result;
      EXPECT_LE(result.lower, best + slack) << count << " backups";
      EXPECT_GE(result.upper, best - slack) << count << " backups";
      if (result.reason == StopReason::kPrecision)
      {
        EXPECT_NEAR(result.lower, best, 2.0 * slack);
      }
    }
  });
}

TEST(FiniteHorizon, AgreesWithTheExactSolver)
{
  for (const std::size_t steps : {1U, 2U, 7U, 15U})
  {
    for (const double discount : {0.75, 1.0})
    {
      const Model model = test::tiger(discount);
      ExactLimits limits;
      limits.horizon = steps;
      const double exact = startValue(model, solveExactly(model, limits));
      const HorizonResult found = solveOver(model, steps, test::backups(20000, 1e-6));
      EXPECT_LE(found.result.lower, exact + 1e-9) << steps << " steps";
      EXPECT_GE(found.result.upper, exact - 1e-9) << steps << " steps";
      EXPECT_NEAR(found.result.lower, exact, 1e-5) << steps << " steps";
    }
  }
}

TEST(FiniteHorizon, ThePolicyEarnsItsValueOverItsSteps)
{
  for (const Model& model : {test::tiger(1.0), test::roomSearch(2)})
  {
    const HorizonResult found = solveOver(model, 6, test::backups(2000));
    EvaluationLimits limits;
    limits.trials = 20000;
    const Evaluation value = evaluate(model, found.policy, limits, 3);
    EXPECT_LE(value.mean_steps, 6.0);
    EXPECT_GE(value.mean + 4.0 * value.standard_error, found.result.lower);
    EXPECT_LE(value.mean - 4.0 * value.standard_error, found.result.upper);
    // The exact solution of the tiger is executed alike.
    if (model.numStates() == 2)
    {
      ExactLimits exact;
      exact.horizon = 6;
      const ExactSolution solution = solveExactly(model, exact);
      const Evaluation of_exact = evaluate(model, HorizonPolicy(solution), limits, 3);
      EXPECT_NEAR(of_exact.mean, startValue(model, solution), 4.0 * of_exact.standard_error);
    }
  }
}

TEST(FiniteHorizon, TheLastStepIsGreedy)
{
  const HorizonPolicy policy = solveOver(test::tiger(1.0), 4, test::backups(500)).policy;
  EXPECT_EQ(policy.horizon(), 4U);
  EXPECT_EQ(policy.numStates(), 2U);
  EXPECT_EQ(policy.bestAt(Belief({0.5, 0.5}), 3).action, 0U);    // nothing is gained by a guess
  EXPECT_EQ(policy.bestAt(Belief({0.98, 0.02}), 3).action, 2U);  // 10 * 0.98 - 100 * 0.02 > -1
  EXPECT_NEAR(policy.bestAt(Belief({0.98, 0.02}), 3).value, 7.8, 1e-9);
  EXPECT_THROW((void)policy.bestAt(Belief({0.5, 0.5}), 4), InvalidArgument);
}

TEST(FiniteHorizon, PoliciesAreReadBack)
{
  const HorizonPolicy policy = solveOver(test::roomSearch(2), 3, test::backups(200)).policy;
  std::stringstream text;
  policy.write(text);
  const HorizonPolicy again = HorizonPolicy::read(text, "text");
  ASSERT_EQ(again.horizon(), 3U);
  std::mt19937_64 random(1);
  for (std::size_t step = 0; step < 3; ++step)
  {
    for (int i = 0; i < 20; ++i)
    {
      const Belief belief = test::randomBelief(policy.numStates(), random);
      EXPECT_EQ(again.bestAt(belief, step).value, policy.bestAt(belief, step).value);
      EXPECT_EQ(again.bestAt(belief, step).action, policy.bestAt(belief, step).action);
    }
  }
  std::istringstream wrong(
      "kr3_horizon_policy 1\nhorizon 2\nkr3_policy 1\nstates 4\nvectors 1\n0 0 1 2 3 4\n");
  EXPECT_THROW((void)HorizonPolicy::read(wrong, "text"), InvalidArgument);
  std::istringstream other("kr3_policy 1\n");
  EXPECT_THROW((void)HorizonPolicy::read(other, "text"), InvalidArgument);
}

TEST(FiniteHorizon, RefusesWhatIsNoHorizon)
{
  EXPECT_THROW((void)overHorizon(test::tiger(), 0), InvalidArgument);
  EXPECT_THROW((void)overHorizon(test::roomSearch(2), 1U << 23), ResourceExhausted);
  EXPECT_THROW((void)evaluate(test::tiger(),
                              solveOver(test::roomSearch(2), 2, test::backups(5)).policy, {}, 1),
               InvalidArgument);
}

}  // namespace
}  // namespace kr3::pomdp
