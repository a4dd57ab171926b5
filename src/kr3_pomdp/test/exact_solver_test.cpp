#include "kr3_pomdp/exact_solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "support/cases.hpp"
#include "support/models.hpp"
#include "support/oracles.hpp"

namespace kr3::pomdp
{
namespace
{

ExactLimits horizon(std::size_t steps)
{
  ExactLimits limits;
  limits.horizon = steps;
  return limits;
}

ExactLimits precision(double value)
{
  ExactLimits limits;
  limits.precision = value;
  return limits;
}

double dot(const std::vector<double>& values, const Belief& belief)
{
  double sum = 0.0;
  for (std::size_t s = 0; s < values.size(); ++s)
  {
    sum += values[s] * belief[s];
  }
  return sum;
}

TEST(ExactSolver, IsTheBestOfAllPlans)
{
  test::forEachModel(30, [](const Model& model, std::uint64_t seed) {
    if (model.numObservations() > 3)
    {
      return;  // too many plans
    }
    const int steps = model.numObservations() == 1 ? 4 : 2;
    const ExactSolution solution = solveExactly(model, horizon(static_cast<std::size_t>(steps)));
    const std::vector<std::vector<double>> plans = test::allPlans(model, steps);
    std::mt19937_64 random(seed);
    for (int i = 0; i < 20; ++i)
    {
      const Belief belief = test::randomBelief(model.numStates(), random);
      double best = -std::numeric_limits<double>::infinity();
      for (const std::vector<double>& plan : plans)
      {
        best = std::max(best, dot(plan, belief));
      }
      EXPECT_NEAR(solution.valueAt(belief), best, 1e-10 * (1.0 + std::abs(best)));
    }
  });
}

TEST(ExactSolver, EveryStageIsTheBestValueOverItsSteps)
{
  test::forEachModel(20, [](const Model& model, std::uint64_t seed) {
    const ExactSolution solution = solveExactly(model, horizon(3));
    ASSERT_EQ(solution.stages.size(), 3U);
    EXPECT_EQ(solution.iterations, 3U);
    std::mt19937_64 random(seed);
    const Belief belief = test::randomBelief(model.numStates(), random);
    for (int steps = 1; steps <= 3; ++steps)
    {
      const double best = test::bestValueOver(model, belief, steps);
      EXPECT_NEAR(solution.stages[static_cast<std::size_t>(steps) - 1].valueAt(belief), best,
                  1e-10 * (1.0 + std::abs(best)));
    }
  });
}

TEST(ExactSolver, ForEverIsTheLimitOfHorizons)
{
  test::forEachModel(20, [](const Model& model, std::uint64_t seed) {
    const std::optional<ExactSolution> solution = test::exactSolutionOf(model);
    if (!solution)
    {
      return;
    }
    constexpr std::size_t kSteps = 6;
    const double rest = std::pow(model.discount(), kSteps) * test::scaleOf(model) + solution->error;
    const ExactSolution over_steps = solveExactly(model, horizon(kSteps));
    EXPECT_LE(solution->error, 1e-5 * test::scaleOf(model));
    std::mt19937_64 random(seed);
    for (int i = 0; i < 10; ++i)
    {
      const Belief belief = test::randomBelief(model.numStates(), random);
      EXPECT_NEAR(solution->valueAt(belief), over_steps.valueAt(belief), rest);
    }
  });
}

TEST(ExactSolver, TigerHasThePublishedVectors)
{
  // 47 vectors and this value for 15 steps: pomdp-solve (Cassandra), as the tests of AI-Toolbox
  // quote it.
  const ExactSolution steps = solveExactly(test::tiger(), horizon(15));
  EXPECT_EQ(steps.stages.back().numAlphaVectors(), 47U);
  EXPECT_NEAR(steps.valueAt(Belief({0.5, 0.5})), 9.7284247446776746, 1e-12);
  EXPECT_NEAR(steps.valueAt(Belief({1.0, 0.0})), 18.7039537733727386, 1e-12);
  // Without an end: listen until one side leads by two, then open the other door; the equations of
  // that plan are in solver_test. The value function has nine vectors (pomdp-solve).
  const ExactSolution for_ever = solveExactly(test::tiger(), precision(1e-6));
  EXPECT_NEAR(for_ever.valueAt(Belief({0.5, 0.5})), 19.371368, 2e-6);
  EXPECT_LE(for_ever.error, 1e-6);
  EXPECT_EQ(for_ever.stages.front().numAlphaVectors(), 9U);
}

TEST(ExactSolver, TigerOfTwoStepsWithoutDiscount)
{
  // Acting now and listening then is as good as the other way round where the robot is sure enough:
  // Kaelbling, Littman and Cassandra (1998), Fig. 12; values as the tests of AI-Toolbox quote them.
  const ExactSolution solution = solveExactly(test::tiger(1.0), horizon(2));
  std::vector<std::vector<double>> values;
  for (const AlphaVector& vector : solution.stages.back().alphaVectors())
  {
    values.push_back(vector.values);
  }
  std::sort(values.begin(), values.end());
  const std::vector<std::vector<double>> expected{
      {-101.0, 9.0}, {-16.85, 7.35}, {-2.0, -2.0}, {7.35, -16.85}, {9.0, -101.0}};
  ASSERT_EQ(values.size(), expected.size());
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    EXPECT_NEAR(values[i][0], expected[i][0], 1e-12);
    EXPECT_NEAR(values[i][1], expected[i][1], 1e-12);
  }
}

TEST(ExactSolver, MazesHaveThePublishedVectors)
{
  // Cassandra, Littman and Zhang (1997), Table 1: 436 vectors for eight steps of the 4x3 maze, 14
  // for the cheese maze without an end.
  EXPECT_EQ(solveExactly(test::maze4x3(), horizon(8)).stages.back().numAlphaVectors(), 436U);
  EXPECT_EQ(solveExactly(test::cheese(), precision(1e-4)).stages.back().numAlphaVectors(), 14U);
}

TEST(ExactSolver, CheeseIsFoundOnTheShortestWay)
{
  // A robot that knows its cell: two steps from below the branch, one more for each cell further.
  const Model model = test::cheese();
  const ExactSolution solution = solveExactly(model, precision(1e-5));
  const double anew = solution.valueAt(model.initialBelief());
  const auto certain = [&](std::size_t cell) {
    std::vector<double> belief(model.numStates(), 0.0);
    belief[cell] = 1.0;
    return solution.valueAt(Belief(belief));
  };
  // From cell 6, above the cheese: reach it, then start anew from a draw that is not seen before
  // the next step, so a step is lost.
  const double at_cheese = 0.95 * anew;
  EXPECT_NEAR(certain(6), 1.0 + 0.95 * certain(9), 1e-4);
  EXPECT_NEAR(certain(2), 0.95 * certain(6), 1e-4);
  EXPECT_GE(certain(9), at_cheese - 1e-4);
}

TEST(ExactSolver, RefusesWhatItCannotDo)
{
  EXPECT_THROW((void)solveExactly(test::tiger(1.0), {}), InvalidArgument);
  EXPECT_THROW((void)solveExactly(test::tiger(), precision(0.0)), InvalidArgument);
  ExactLimits limits = horizon(8);
  limits.max_vectors = 100;
  EXPECT_THROW((void)solveExactly(test::maze4x3(), limits), ResourceExhausted);
  limits = horizon(30);
  limits.time_s = 0.05;
  limits.max_vectors = 10000000;
  EXPECT_THROW((void)solveExactly(test::maze4x3(), limits), DeadlineExceeded);
  limits.time_s = -1.0;
  EXPECT_THROW((void)solveExactly(test::maze4x3(), limits), InvalidArgument);
}

}  // namespace
}  // namespace kr3::pomdp
