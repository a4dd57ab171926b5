// Bounds against the exact optimum on random models; KR3_POMDP_CASES in the environment is how
// many, KR3_POMDP_SEED the first.

#include <optional>
#include <random>

#include <gtest/gtest.h>

#include "kr3_pomdp/exact_solver.hpp"
#include "kr3_pomdp/solver.hpp"
#include "support/cases.hpp"
#include "support/oracles.hpp"

namespace kr3::pomdp
{
namespace
{

TEST(BoundLaws, BoundsHoldTheOptimum)
{
  int compared = 0;
  int cases = 0;
  test::forEachModel(60, [&](const Model& model, std::uint64_t seed) {
    ++cases;
    const std::optional<ExactSolution> exact = test::exactSolutionOf(model);
    if (!exact)
    {
      return;
    }
    ++compared;
    const double slack = 1e-8 * test::scaleOf(model);
    const double least = startValue(model, *exact);
    const double greatest = least + exact->error;
    std::mt19937_64 random(seed);
    for (const std::uint64_t count : {1U, 4U, 20U, 100U, 3000U})
    {
      const double precision = 1e-4 * test::scaleOf(model);
      SolverLimits limits = test::backups(count, precision);
      limits.num_threads = count == 100 ? 2 : 1;
      const SolveResult result = solve(model, limits);
      EXPECT_LE(result.lower, greatest + slack) << count << " backups";
      EXPECT_GE(result.upper, least - slack) << count << " backups";
      EXPECT_LE(result.lower, result.upper) << count << " backups";
      for (int i = 0; i < 10; ++i)
      {
        const Belief belief = test::randomBelief(model.numStates(), random);
        EXPECT_LE(result.policy.valueAt(belief), exact->valueAt(belief) + exact->error + slack)
            << count << " backups";
      }
      if (result.reason == StopReason::kPrecision)
      {
        EXPECT_GE(result.lower, least - precision - slack);
        EXPECT_LE(result.upper, greatest + precision + slack);
      }
    }
  });
  EXPECT_GE(compared, cases / 2) << "the oracle gives up too often";
}

TEST(BoundLaws, BoundsHoldTheOptimumOfKnownProblems)
{
  struct Problem
  {
    const char* name;
    Model model;
    double precision;
  };
  for (const Problem& problem :
       {Problem{"tiger", test::tiger(), 1e-6}, Problem{"cheese", test::cheese(), 1e-5},
        Problem{"shuttle", test::shuttle(), 0.1}})
  {
    SCOPED_TRACE(problem.name);
    ExactLimits limits;
    limits.precision = problem.precision;
    const ExactSolution exact = solveExactly(problem.model, limits);
    const double least = startValue(problem.model, exact);
    for (const std::uint64_t count : {10U, 100U, 2000U})
    {
      const SolveResult result = solve(problem.model, test::backups(count, 1e-4));
      EXPECT_LE(result.lower, least + exact.error + 1e-8) << count << " backups";
      EXPECT_GE(result.upper, least - 1e-8) << count << " backups";
    }
  }
}

}  // namespace
}  // namespace kr3::pomdp
