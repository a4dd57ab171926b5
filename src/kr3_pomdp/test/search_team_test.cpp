// Searches in several threads.

#include <cstdint>

#include <gtest/gtest.h>

#include "kr3_pomdp/solver.hpp"
#include "support/models.hpp"

namespace kr3::pomdp
{
namespace
{

SolverLimits limitsOf(int num_threads, std::uint64_t backups, double precision = 0.0)
{
  SolverLimits limits;
  limits.num_threads = num_threads;
  limits.max_backups = backups;
  limits.precision = precision;
  return limits;
}

TEST(SearchTeam, CountedWorkRepeatsExactlyForANumberOfThreads)
{
  const Model model = test::roomSearch(3);
  for (const int threads : {2, 3})
  {
    const SolveResult first = solve(model, limitsOf(threads, 3000));
    const SolveResult second = solve(model, limitsOf(threads, 3000));
    EXPECT_EQ(first.reason, StopReason::kBackupLimit);
    EXPECT_EQ(first.backups, 3000U);
    EXPECT_EQ(second.backups, 3000U);
    EXPECT_EQ(first.lower, second.lower);
    EXPECT_EQ(first.upper, second.upper);
    const std::vector<AlphaVector> vectors = first.policy.alphaVectors();
    const std::vector<AlphaVector> again = second.policy.alphaVectors();
    ASSERT_EQ(vectors.size(), again.size());
    for (std::size_t i = 0; i < vectors.size(); ++i)
    {
      EXPECT_EQ(vectors[i].action, again[i].action);
      EXPECT_EQ(vectors[i].values, again[i].values);
    }
  }
}

TEST(SearchTeam, OneThreadAndManyGiveBoundsOfTheSameQuality)
{
  const Model model = test::roomSearch(2);
  const SolveResult one = solve(model, limitsOf(1, 8000));
  for (const int threads : {2, 4})
  {
    const SolveResult many = solve(model, limitsOf(threads, 8000));
    EXPECT_LE(many.lower, one.upper + 1e-9);
    EXPECT_GE(many.upper, one.lower - 1e-9);
    EXPECT_LT(many.upper - many.lower, 1.5 * (one.upper - one.lower)) << threads << " threads";
    EXPECT_GT(many.cpu_s, 0.0);
  }
}

TEST(SearchTeam, StopsAtThePrecision)
{
  const SolveResult result = solve(test::tiger(), limitsOf(3, 0, 1e-3));
  EXPECT_EQ(result.reason, StopReason::kPrecision);
  EXPECT_LE(result.upper - result.lower, 1e-3);
  EXPECT_NEAR(result.lower, 19.37, 0.01);
}

TEST(SearchTeam, KeepsItsOtherLimits)
{
  SolverLimits limits = limitsOf(2, 0);
  limits.time_s = 0.1;
  EXPECT_EQ(solve(test::roomSearch(3), limits).reason, StopReason::kTimeLimit);
  limits.time_s = 0.0;
  limits.max_memory_bytes = 8U << 20U;
  const SolveResult full =
      solve(test::roomSearch(3), limits, [](const SolverProgress&) { return true; });
  EXPECT_EQ(full.reason, StopReason::kMemoryLimit);
  EXPECT_LT(full.memory_bytes, 10U << 20U);
  limits.max_memory_bytes = 0;
  const SolveResult cancelled =
      solve(test::roomSearch(3), limits,
            [](const SolverProgress& progress) { return progress.backups < 200; });
  EXPECT_EQ(cancelled.reason, StopReason::kCancelled);
  EXPECT_LE(cancelled.lower, cancelled.upper);
}

}  // namespace
}  // namespace kr3::pomdp
