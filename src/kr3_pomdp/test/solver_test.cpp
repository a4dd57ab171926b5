#include "kr3_pomdp/solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_pomdp/model_builder.hpp"
#include "kr3_pomdp/simulation.hpp"
#include "support/models.hpp"
#include "support/oracles.hpp"

namespace kr3::pomdp
{
namespace
{

TEST(Solver, TigerHasItsKnownValue)
{
  // The optimal plan listens until one side leads by two, then opens the other door:
  // V0 = -1 + g V1, V1 = -1 + g (u V2 + (1 - u) V0), V2 = 10 p - 100 (1 - p) + g V0.
  // Its value, 19.37, is that of Cassandra's collection for discount 0.95.
  const double g = 0.95;
  const double u = 0.85 * 0.85 + 0.15 * 0.15;
  const double p = 0.85 * 0.85 / u;
  double v0 = 0.0;
  for (int i = 0; i < 10000; ++i)
  {
    const double v2 = 10.0 * p - 100.0 * (1.0 - p) + g * v0;
    v0 = -1.0 + g * (-1.0 + g * (u * v2 + (1.0 - u) * v0));
  }
  EXPECT_NEAR(v0, 19.37, 0.01);
  const SolveResult result = solve(test::tiger(), test::backups(100000, 1e-3));
  EXPECT_EQ(result.reason, StopReason::kPrecision);
  EXPECT_LE(result.lower, v0 + 1e-9);
  EXPECT_GE(result.upper, v0 - 1e-9);
  EXPECT_LE(result.upper - result.lower, 1e-3);
}

TEST(Solver, BoundsHoldTheExactValueOfRandomModels)
{
  constexpr int kHorizon = 7;
  for (std::uint64_t seed = 1; seed <= 25; ++seed)
  {
    const Model model = test::randomModel({3, 2, 2, 0.5}, seed);
    const double exact = test::bestValueOver(model, model.initialBelief(), kHorizon);
    const double rest = std::pow(model.discount(), kHorizon) / (1.0 - model.discount());
    for (const std::uint64_t count : {1U, 5U, 2000U})
    {
      const SolveResult result = solve(model, test::backups(count, 1e-4));
      EXPECT_LE(result.lower, result.upper) << "seed " << seed;
      EXPECT_LE(result.lower, exact + rest) << "seed " << seed << ", " << count << " backups";
      EXPECT_GE(result.upper, exact - rest) << "seed " << seed << ", " << count << " backups";
    }
  }
}

TEST(Solver, BoundsOnlyComeNearer)
{
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  std::uint64_t reports = 0;
  const SolveResult result =
      solve(test::roomSearch(2), test::backups(2000), [&](const SolverProgress& progress) {
        EXPECT_GE(progress.lower, lower);
        EXPECT_LE(progress.upper, upper);
        EXPECT_LE(progress.lower, progress.upper);
        lower = progress.lower;
        upper = progress.upper;
        ++reports;
        return true;
      });
  EXPECT_GT(reports, 1000U);
  EXPECT_EQ(result.reason, StopReason::kBackupLimit);
  EXPECT_NEAR(result.lower, lower, 1e-9);
}

TEST(Solver, CountedWorkRepeatsExactly)
{
  const Model model = test::roomSearch(3);
  const SolveResult first = solve(model, test::backups(500));
  const SolveResult second = solve(model, test::backups(500));
  EXPECT_EQ(first.lower, second.lower);
  EXPECT_EQ(first.upper, second.upper);
  EXPECT_EQ(first.backups, 500U);
  EXPECT_EQ(first.policy.numAlphaVectors(), second.policy.numAlphaVectors());
}

TEST(Solver, SearchesRoomsBetterThanTheGreedyRule)
{
  // The greedy rule with the best thresholds earns 59.16 +- 0.21 with 4 cells, 45.9 +- 0.21 with 9.
  EXPECT_GT(solve(test::roomSearch(2), test::backups(10000)).lower, 58.9);
  EXPECT_GT(solve(test::roomSearch(3), test::backups(20000)).lower, 44.0);
}

// What is known at first is a lower bound from the start, and is improved on.
TEST(Solver, BeginsWithAPolicyThatIsGiven)
{
  const Model model = test::tiger();
  const SolveResult good = solve(model, test::backups(2000, 1e-3));
  const SolveResult without = solve(model, test::backups(1, 1e-3));
  const SolveResult with = solve(model, test::backups(1, 1e-3), {}, &good.policy);
  ASSERT_LT(without.lower, good.lower - 1.0);
  EXPECT_GE(with.lower, good.lower - 1e-9);
  EXPECT_LE(with.lower, good.upper + 1e-9);
  const Model other = test::randomModel({3, 2, 2, 0.5}, 1);
  EXPECT_THROW(static_cast<void>(solve(other, test::backups(1, 1e-3), {}, &good.policy)),
               InvalidArgument);
}

TEST(Solver, ThePolicyEarnsWhatTheBoundsSay)
{
  for (const Model& model : {test::tiger(), test::roomSearch(2)})
  {
    const SolveResult result = solve(model, test::backups(3000));
    EvaluationLimits limits;
    limits.trials = 4000;
    limits.truncation = 1e-4;
    const Evaluation value = evaluate(model, result.policy, limits, 5);
    EXPECT_GE(value.mean + 4.0 * value.standard_error, result.lower);
    EXPECT_LE(value.mean - 4.0 * value.standard_error, result.upper);
  }
}

TEST(Solver, BoundsHoldAtLaterBeliefsToo)
{
  // One step ahead the policy's value must not fall below its promise:
  // V(b) <= R(b, a) + g sum_o Pr(o) V(b'), with a the policy's action.
  const Model model = test::roomSearch(2);
  const Policy policy = solve(model, test::backups(1500)).policy;
  std::mt19937_64 random(3);
  for (int trial = 0; trial < 40; ++trial)
  {
    Belief belief = model.initialBelief();
    std::size_t state = sampleState(belief, random);
    for (int step = 0; step < 25; ++step)
    {
      const Policy::Choice choice = policy.bestAt(belief);
      const double ahead =
          test::valueAhead(model, belief, choice.action,
                           [&policy](const Belief& next) { return policy.valueAt(next); });
      EXPECT_GE(ahead, choice.value - 1e-6);
      const std::size_t action = step % 3 == 0 ? random() % model.numActions() : choice.action;
      const SampledStep sampled = sampleStep(model, state, action, random);
      belief = updated(model, belief, action, sampled.observation).posterior;
      state = sampled.next_state;
    }
  }
}

TEST(Solver, ACancelledRunGivesThePolicySoFar)
{
  SolverLimits limits;
  limits.precision = 0.0;
  const SolveResult result = solve(test::roomSearch(2), limits, [](const SolverProgress& progress) {
    return progress.backups < 50;
  });
  EXPECT_EQ(result.reason, StopReason::kCancelled);
  EXPECT_EQ(result.backups, 50U);
  EXPECT_LE(result.lower, result.upper);
}

TEST(Solver, IsCancelledBeforeThereAreBounds)
{
  SolverLimits limits;
  limits.precision = 0.0;
  bool unbounded = false;
  const SolveResult result = solve(test::tiger(), limits, [&](const SolverProgress& progress) {
    unbounded = !std::isfinite(progress.lower) && !std::isfinite(progress.upper);
    return false;
  });
  EXPECT_TRUE(unbounded);
  EXPECT_EQ(result.reason, StopReason::kCancelled);
  EXPECT_LE(result.lower, result.upper);
}

TEST(Solver, KeepsItsDeadline)
{
  SolverLimits limits;
  limits.precision = 0.0;
  limits.time_s = 0.05;
  const SolveResult result = solve(test::roomSearch(4), limits);
  EXPECT_EQ(result.reason, StopReason::kTimeLimit);
  EXPECT_LT(result.elapsed_s, 1.0);  // generous: machines that run tests are busy
}

TEST(Solver, KeepsItsMemoryLimit)
{
  SolverLimits limits = test::backups(1000000);
  limits.max_memory_bytes = 4U << 20U;
  std::size_t before = 0;
  const SolveResult result =
      solve(test::roomSearch(3), limits, [&before](const SolverProgress& progress) {
        EXPECT_LT(progress.memory_bytes, 4U << 20U);
        before = progress.memory_bytes;
        return true;
      });
  EXPECT_EQ(result.reason, StopReason::kMemoryLimit);
  EXPECT_GE(result.memory_bytes, 4U << 20U);
  EXPECT_LT(result.memory_bytes, before + (1U << 20U));  // one backup more
  EXPECT_LE(result.lower, result.upper);
}

TEST(Solver, RefusesWhatCannotEnd)
{
  SolverLimits limits;
  limits.precision = 0.0;
  EXPECT_THROW((void)solve(test::tiger(), limits), InvalidArgument);
  limits.precision = -1.0;
  EXPECT_THROW((void)solve(test::tiger(), limits), InvalidArgument);
  EXPECT_THROW((void)solve(test::tiger(1.0), test::backups(10)), InvalidArgument);
  limits = test::backups(10);
  limits.num_threads = 0;
  EXPECT_THROW((void)solve(test::tiger(), limits), InvalidArgument);
}

TEST(Solver, OneStateIsSolvedExactly)
{
  ModelBuilder builder({"s"}, {"a", "b"}, {"o"});
  builder.setDiscount(0.9);
  builder.setTransition(kAny, 0, 0, 1.0);
  builder.setObservation(kAny, 0, 0, 1.0);
  builder.setReward(1, 0, 2.0);
  const SolveResult result = solve(builder.build(), test::backups(1000, 1e-6));
  EXPECT_NEAR(result.lower, 20.0, 1e-4);
  EXPECT_NEAR(result.upper, 20.0, 1e-4);
  EXPECT_EQ(result.policy.actionAt(Belief({1.0})), 1U);
}

TEST(Solver, GivesASoundPolicyHoweverEarlyItIsStopped)
{
  const Model model = test::roomSearch(4);
  for (int looks = 0; looks < 12; ++looks)
  {
    SolverLimits limits;
    int asked = 0;
    const SolveResult result =
        solve(model, limits, [&](const SolverProgress&) { return asked++ < looks; });
    EXPECT_EQ(result.reason, StopReason::kCancelled);
    EXPECT_LE(result.lower, 26.5);  // near the optimum
    EXPECT_GE(result.upper, 26.0);
    EXPECT_NEAR(result.policy.valueAt(model.initialBelief()), result.lower, 1e-9);
    EvaluationLimits trials;
    trials.trials = 200;
    const Evaluation value = evaluate(model, result.policy, trials, 1);
    EXPECT_GE(value.mean + 4.0 * value.standard_error + 1e-6, result.lower);
  }
}

}  // namespace
}  // namespace kr3::pomdp
