#include "solver_parts.hpp"

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "support/models.hpp"

namespace kr3::pomdp
{
namespace
{

SolverLimits backups(std::uint64_t count)
{
  SolverLimits limits;
  limits.precision = 0.0;
  limits.max_backups = count;
  return limits;
}

class EachPartLeftOut : public testing::TestWithParam<bool SolverParts::*>
{
};

TEST_P(EachPartLeftOut, KeepsTheBoundsSound)
{
  SolverParts parts;
  parts.*GetParam() = false;
  const Model room = test::roomSearch(2);
  const SolveResult full = solve(room, backups(4000));
  ASSERT_LT(full.upper - full.lower, 4.0);
  const SolveResult partial = solveWith(room, backups(1000), parts);
  EXPECT_LE(partial.lower, full.upper + 1e-9);
  EXPECT_GE(partial.upper, full.lower - 1e-9);
  EXPECT_LE(partial.lower, partial.upper);
}

TEST_P(EachPartLeftOut, StillSolvesTheTiger)
{
  SolverParts parts;
  parts.*GetParam() = false;
  SolverLimits limits = backups(100000);
  limits.precision = 1e-3;
  const SolveResult result = solveWith(test::tiger(), limits, parts);
  EXPECT_EQ(result.reason, StopReason::kPrecision);
  // Source: value of the Tiger problem, Cassandra's page of examples.
  EXPECT_NEAR(result.lower, 19.371, 2e-3);
}

INSTANTIATE_TEST_SUITE_P(All, EachPartLeftOut,
                         testing::Values(&SolverParts::classes, &SolverParts::informed_vectors,
                                         &SolverParts::noise_free_bound, &SolverParts::belief_grid,
                                         &SolverParts::sampled_trials, &SolverParts::upper_trials));

TEST(SolverParts, SearchOfARoomNeedsTheNoiseFreeBound)
{
  SolverParts parts;
  parts.noise_free_bound = false;
  const Model room = test::roomSearch(3);
  const SolveResult with = solve(room, backups(2000));
  const SolveResult without = solveWith(room, backups(2000), parts);
  EXPECT_LT(with.upper, without.upper - 5.0);
}

TEST(SolverParts, NoTrialsAtAllAreRefused)
{
  SolverParts parts;
  parts.sampled_trials = false;
  parts.upper_trials = false;
  EXPECT_THROW((void)solveWith(test::tiger(), backups(10), parts), InvalidArgument);
}

}  // namespace
}  // namespace kr3::pomdp
