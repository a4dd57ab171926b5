#include "kr3_pomdp/simulation.hpp"

#include <random>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_pomdp/model_builder.hpp"
#include "kr3_pomdp/solver.hpp"
#include "support/factored_models.hpp"
#include "support/models.hpp"

namespace kr3::pomdp
{
namespace
{

Policy alwaysListen()
{
  return Policy(2, {{0, {}, {0.0, 0.0}}});
}

TEST(Simulation, SamplesFollowTheModel)
{
  const Model model = test::tiger();
  std::mt19937_64 random(1);
  int right = 0;
  constexpr int kSamples = 20000;
  for (int i = 0; i < kSamples; ++i)
  {
    const SampledStep step = sampleStep(model, 0, 0, random);
    EXPECT_EQ(step.next_state, 0U);
    right += step.observation == 1 ? 1 : 0;
  }
  // 0.15 with a standard error of 0.0025.
  EXPECT_NEAR(static_cast<double>(right) / kSamples, 0.15, 0.0125);
  EXPECT_THROW((void)sampleStep(model, 2, 0, random), InvalidArgument);
}

TEST(Simulation, AConstantRewardGivesTheGeometricSum)
{
  EvaluationLimits limits;
  limits.trials = 10;
  limits.truncation = 1e-9;
  const Evaluation value = evaluate(test::tiger(), alwaysListen(), limits, 1);
  EXPECT_NEAR(value.mean, -20.0, 1e-6);
  EXPECT_EQ(value.half_width_95, 0.0);
}

TEST(Simulation, TheSameSeedGivesTheSameValue)
{
  const Model model = test::tiger();
  const Policy policy(2, {{0, {}, {0.0, 0.0}}, {1, {}, {-100.0, 10.0}}, {2, {}, {10.0, -100.0}}});
  EvaluationLimits limits;
  limits.trials = 50;
  EXPECT_EQ(evaluate(model, policy, limits, 3).mean, evaluate(model, policy, limits, 3).mean);
  EXPECT_NE(evaluate(model, policy, limits, 3).mean, evaluate(model, policy, limits, 4).mean);
}

TEST(Simulation, TheNumberOfThreadsDoesNotShow)
{
  const Model model = test::roomSearch(2);
  SolverLimits budget;
  budget.max_backups = 500;
  const Policy policy = solve(model, budget).policy;
  EvaluationLimits limits;
  limits.trials = 1000;
  const Evaluation one = evaluate(model, policy, limits, 3);
  for (const int num_threads : {2, 3, 16})
  {
    limits.num_threads = num_threads;
    const Evaluation several = evaluate(model, policy, limits, 3);
    EXPECT_EQ(several.mean, one.mean);
    EXPECT_EQ(several.standard_error, one.standard_error);
    EXPECT_EQ(several.mean_steps, one.mean_steps);
    EXPECT_EQ(several.finished, one.finished);
  }
  EXPECT_EQ(one.finished, 1.0);
  limits.num_threads = 0;
  EXPECT_THROW((void)evaluate(model, policy, limits, 3), InvalidArgument);
}

// The walk remembers beliefs; tracking them step by step must give the same.
TEST(Simulation, AgreesWithExactBeliefsStepByStep)
{
  const Model model = test::randomFactored(4).flattened();
  SolverLimits budget;
  budget.max_backups = 500;
  const Policy policy = solve(model, budget).policy;
  EvaluationLimits limits;
  limits.trials = 20000;
  const Evaluation value = evaluate(model, policy, limits, 7);
  std::mt19937_64 random(9);
  double sum = 0.0;
  constexpr int kTrials = 2000;
  for (int trial = 0; trial < kTrials; ++trial)
  {
    std::size_t state = sampleState(model.initialBelief(), random);
    Belief belief = model.initialBelief();
    for (const InitialOutcome& outcome : model.initialOutcomes())
    {
      belief = outcome.belief[state] > 0.0 ? outcome.belief : belief;
    }
    for (double weight = 1.0; weight > limits.truncation; weight *= model.discount())
    {
      const std::size_t action = policy.actionAt(belief);
      sum += weight * model.reward(action, state);
      const SampledStep step = sampleStep(model, state, action, random);
      belief = updated(model, belief, action, step.observation).posterior;
      state = step.next_state;
    }
  }
  // Ten times fewer trials: the error is about three times as large.
  EXPECT_NEAR(sum / kTrials, value.mean, 4.0 * 3.3 * value.standard_error);
}

TEST(Simulation, RejectsAPolicyOfAnotherModel)
{
  EXPECT_THROW((void)evaluate(test::roomSearch(2), alwaysListen(), {}, 1), InvalidArgument);
  EXPECT_THROW((void)evaluate(test::tiger(), Policy(2, {{3, {}, {0.0, 0.0}}}), {}, 1),
               InvalidArgument);
  EvaluationLimits none;
  none.trials = 0;
  EXPECT_THROW((void)evaluate(test::tiger(), alwaysListen(), none, 1), InvalidArgument);
}

}  // namespace
}  // namespace kr3::pomdp
