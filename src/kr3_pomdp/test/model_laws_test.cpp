// Laws on random models; KR3_POMDP_CASES in the environment is how many, KR3_POMDP_SEED the first.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "kr3_pomdp/pomdp_format.hpp"
#include "kr3_pomdp/pomdpx_format.hpp"
#include "kr3_pomdp/simulation.hpp"
#include "kr3_pomdp/solver.hpp"
#include "support/cases.hpp"
#include "support/factored_models.hpp"
#include "support/oracles.hpp"

namespace kr3::pomdp
{
namespace
{

std::string textOf(const Policy& policy)
{
  std::ostringstream out;
  policy.write(out);
  return out.str();
}

/// What a policy earns over some steps, without sampling.
double valueOver(const Model& model, const Policy& policy, const Belief& belief, int steps)
{
  if (steps == 0)
  {
    return 0.0;
  }
  return test::valueAhead(model, belief, policy.actionAt(belief), [&](const Belief& next) {
    return valueOver(model, policy, next, steps - 1);
  });
}

TEST(ModelLaws, BeliefsAreWhatBayesSays)
{
  test::forEachModel(40, [](const Model& model, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    for (int round = 0; round < 5; ++round)
    {
      std::vector<test::ActionAndObservation> steps;
      Belief belief = model.initialBelief();
      std::size_t state = sampleState(belief, random);
      double probability = 1.0;
      for (int i = 0; i < 3; ++i)
      {
        const std::size_t action = random() % model.numActions();
        const SampledStep step = sampleStep(model, state, action, random);
        const std::vector<double> chances = observationProbabilities(model, belief, action);
        EXPECT_NEAR(std::accumulate(chances.begin(), chances.end(), 0.0), 1.0, 1e-12);
        const BeliefUpdate update = updated(model, belief, action, step.observation);
        EXPECT_NEAR(update.probability, chances[step.observation], 1e-12);
        probability *= update.probability;
        belief = update.posterior;
        state = step.next_state;
        steps.push_back({action, step.observation});
        const std::vector<double> joint = test::jointOver(model, steps);
        const double total = std::accumulate(joint.begin(), joint.end(), 0.0);
        EXPECT_NEAR(probability, total, 1e-12);
        EXPECT_NEAR(
            std::accumulate(belief.probabilities().begin(), belief.probabilities().end(), 0.0), 1.0,
            1e-12);
        for (std::size_t s = 0; s < model.numStates(); ++s)
        {
          EXPECT_NEAR(belief[s], joint[s] / total, 1e-10);
        }
      }
    }
  });
}

TEST(ModelLaws, FilesKeepTheModelToTheLastBit)
{
  test::forEachModel(20, [](const Model& model, std::uint64_t /*seed*/) {
    std::vector<Model> again;
    if (model.initialLabels().empty())
    {
      std::stringstream text;
      writePomdp(text, model);
      again.push_back(readPomdp(text, "text"));
    }
    std::stringstream text;
    writePomdpx(text, model);
    again.push_back(readPomdpx(text, "text").flattened());
    const SolveResult result = solve(model, test::backups(60));
    for (const Model& copy : again)
    {
      const SolveResult of_copy = solve(copy, test::backups(60));
      if (model.initialLabels().empty())
      {
        EXPECT_EQ(of_copy.lower, result.lower);
        EXPECT_EQ(of_copy.upper, result.upper);
      }
      // What is seen first is a variable of its own in the file, which numbers states anew.
      const double slack = 1e-9 * test::scaleOf(model);
      EXPECT_LE(of_copy.lower, result.upper + slack);
      EXPECT_GE(of_copy.upper, result.lower - slack);
    }
  });
}

TEST(ModelLaws, FactorsAndTheFlatModelHaveTheSameValue)
{
  for (std::uint64_t seed = 1; seed <= 6; ++seed)
  {
    const FactoredModel factored = test::randomFactored(seed);
    const Model flat = factored.flattened();
    std::stringstream in_factors;
    writePomdpx(in_factors, factored);
    std::stringstream in_one;
    writePomdpx(in_one, flat);
    const SolveResult result = solve(flat, test::backups(200));
    const SolveResult of_factors =
        solve(readPomdpx(in_factors, "factors").flattened(), test::backups(200));
    const SolveResult of_one = solve(readPomdpx(in_one, "one").flattened(), test::backups(200));
    EXPECT_EQ(of_factors.lower, result.lower) << "seed " << seed;
    EXPECT_EQ(of_factors.upper, result.upper) << "seed " << seed;
    // As one variable the same model may be worked on in another order.
    EXPECT_LE(of_one.lower, result.upper + 1e-9) << "seed " << seed;
    EXPECT_GE(of_one.upper, result.lower - 1e-9) << "seed " << seed;
  }
}

TEST(ModelLaws, CountedWorkGivesTheSamePolicyToTheLastByte)
{
  test::forEachModel(30, [](const Model& model, std::uint64_t /*seed*/) {
    for (const std::uint64_t count : {1U, 30U, 400U})
    {
      const SolveResult first = solve(model, test::backups(count, 1e-6));
      const SolveResult second = solve(model, test::backups(count, 1e-6));
      EXPECT_EQ(textOf(first.policy), textOf(second.policy));
      EXPECT_EQ(first.upper, second.upper);
      EXPECT_EQ(first.backups, second.backups);
    }
  });
}

TEST(ModelLaws, BoundsOnlyComeNearer)
{
  test::forEachModel(30, [](const Model& model, std::uint64_t /*seed*/) {
    double lower = -std::numeric_limits<double>::infinity();
    double upper = std::numeric_limits<double>::infinity();
    const SolveResult result =
        solve(model, test::backups(300), [&](const SolverProgress& progress) {
          EXPECT_GE(progress.lower, lower);
          EXPECT_LE(progress.upper, upper);
          EXPECT_LE(progress.lower, progress.upper);
          lower = progress.lower;
          upper = progress.upper;
          return true;
        });
    EXPECT_GE(result.lower, lower - 1e-9 * test::scaleOf(model));
    EXPECT_LE(result.upper, upper + 1e-9 * test::scaleOf(model));
  });
}

TEST(ModelLaws, PoliciesEarnWhatTheirVectorsPromise)
{
  test::forEachModel(30, [](const Model& model, std::uint64_t seed) {
    // The initial outcomes are apart from each other, so one is looked at.
    const Belief start = model.initialOutcomes().front().belief;
    const double slack = 1e-9 * test::scaleOf(model);
    for (const std::uint64_t count : {2U, 20U, 500U})
    {
      const SolveResult result = solve(model, test::backups(count));
      // What is earned later is at least the discounted least.
      constexpr int kSteps = 4;
      const double rest = std::pow(model.discount(), kSteps) * test::scaleOf(model);
      EXPECT_GE(valueOver(model, result.policy, start, kSteps) + rest + slack,
                result.policy.valueAt(start))
          << count << " backups";
    }
    const SolveResult result = solve(model, test::backups(200));
    EvaluationLimits limits;
    limits.trials = 1000;
    limits.truncation = 1e-5;
    const Evaluation value = evaluate(model, result.policy, limits, seed);
    const double wide = 5.0 * value.standard_error + 1e-4 * test::scaleOf(model);
    EXPECT_GE(value.mean + wide, result.lower);
    EXPECT_LE(value.mean - wide, result.upper);
  });
}

TEST(ModelLaws, NoStepOfAPolicyFallsShortOfItsPromise)
{
  test::forEachModel(30, [](const Model& model, std::uint64_t seed) {
    const Policy policy = solve(model, test::backups(100)).policy;
    std::mt19937_64 random(seed);
    for (int trial = 0; trial < 10; ++trial)
    {
      const std::vector<InitialOutcome> starts = model.initialOutcomes();
      Belief belief = starts[random() % starts.size()].belief;
      std::size_t state = sampleState(belief, random);
      for (int step = 0; step < 8; ++step)
      {
        const Policy::Choice choice = policy.bestAt(belief);
        const double ahead =
            test::valueAhead(model, belief, choice.action,
                             [&policy](const Belief& next) { return policy.valueAt(next); });
        EXPECT_GE(ahead, choice.value - 1e-8 * test::scaleOf(model));
        const std::size_t action = step % 3 == 0 ? random() % model.numActions() : choice.action;
        const SampledStep sampled = sampleStep(model, state, action, random);
        belief = updated(model, belief, action, sampled.observation).posterior;
        state = sampled.next_state;
      }
    }
  });
}

TEST(ModelLaws, OneThreadAndTwoAgree)
{
  test::forEachModel(20, [](const Model& model, std::uint64_t /*seed*/) {
    const double precision = 1e-3 * test::scaleOf(model);
    SolverLimits limits = test::backups(2000, precision);
    const SolveResult one = solve(model, limits);
    limits.num_threads = 2;
    const SolveResult two = solve(model, limits);
    const double slack = 1e-9 * test::scaleOf(model);
    EXPECT_LE(two.lower, one.upper + slack);
    EXPECT_GE(two.upper, one.lower - slack);
    if (one.reason == StopReason::kPrecision)
    {
      EXPECT_LE(two.upper - two.lower, 2.0 * precision + slack);
    }
  });
}

}  // namespace
}  // namespace kr3::pomdp
