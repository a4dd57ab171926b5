#include "kr3_pomdp/belief_planner.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_pomdp/simulation.hpp"
#include "kr3_pomdp/solver.hpp"
#include "support/models.hpp"

namespace kr3::pomdp
{
namespace
{

BeliefPlannerOptions counted(std::uint64_t expansions)
{
  BeliefPlannerOptions options;
  options.time_s = 0.0;
  options.max_expansions = expansions;
  return options;
}

SolveResult solved(const Model& model, std::uint64_t backups)
{
  SolverLimits limits;
  limits.max_backups = backups;
  return solve(model, limits);
}

TEST(BeliefPlanner, BracketsTheOptimumAndImprovesOnThePolicy)
{
  for (std::uint64_t seed = 0; seed < 6; ++seed)
  {
    const Model model = test::randomModel({4, 3, 2, 0.8}, seed);
    const SolveResult best = solved(model, 100000);
    const Policy poor = solved(model, 1).policy;
    double lower = poor.valueAt(model.initialBelief()) - 1e-9;
    double upper = std::numeric_limits<double>::infinity();
    for (const std::uint64_t expansions : {1, 10, 100, 1000})
    {
      BeliefPlanner planner(model, poor, counted(expansions));
      const BeliefDecision decision = planner.plan();
      EXPECT_GE(decision.lower, lower - 1e-12) << seed;
      EXPECT_LE(decision.upper, upper + 1e-12) << seed;
      EXPECT_LE(decision.lower, best.upper + 1e-9) << seed;
      EXPECT_GE(decision.upper, best.lower - 1e-9) << seed;
      lower = decision.lower;
      upper = decision.upper;
    }
    EXPECT_LE(upper - lower, 0.2 * std::abs(best.upper) + 0.2) << seed;
  }
}

TEST(BeliefPlanner, KeepsWhatItSearchedAndTheExactBelief)
{
  const Model room = test::roomSearch(2);
  const Policy policy = solved(room, 50).policy;
  BeliefPlanner planner(room, policy, counted(300));
  std::mt19937_64 random(5);
  Belief belief = room.initialOutcomes().front().belief;
  planner.restart(belief);
  std::size_t state = sampleState(belief, random);
  for (int step = 0; step < 6; ++step)
  {
    const BeliefDecision decision = planner.plan();
    const SampledStep sampled = sampleStep(room, state, decision.action, random);
    const BeliefUpdate update = updated(room, belief, decision.action, sampled.observation);
    EXPECT_DOUBLE_EQ(planner.advance(decision.action, sampled.observation), update.probability);
    belief = update.posterior;
    EXPECT_EQ(planner.belief().probabilities(), belief.probabilities());
    // What was found below this belief is still there, so one more step cannot know less.
    BeliefPlanner fresh(room, policy, counted(1));
    fresh.restart(belief);
    BeliefPlanner kept = std::move(planner);
    const BeliefDecision again = kept.plan();
    EXPECT_GE(again.lower, fresh.plan().lower - 1e-9);
    planner = std::move(kept);
    state = sampled.next_state;
  }
}

TEST(BeliefPlanner, CountedWorkRepeatsExactly)
{
  const Model room = test::roomSearch(2);
  const Policy policy = solved(room, 50).policy;
  BeliefPlanner first(room, policy, counted(40));
  BeliefPlanner second(room, policy, counted(40));
  const BeliefDecision a = first.plan();
  const BeliefDecision b = second.plan();
  EXPECT_EQ(a.action, b.action);
  EXPECT_EQ(a.lower, b.lower);
  EXPECT_EQ(a.upper, b.upper);
}

TEST(BeliefPlanner, RefusesWhatDoesNotFit)
{
  const Model tiger = test::tiger();
  const Policy policy = solved(tiger, 100).policy;
  EXPECT_THROW(BeliefPlanner(tiger, policy, counted(0)), InvalidArgument);
  EXPECT_THROW(BeliefPlanner(test::roomSearch(2), policy, counted(1)), InvalidArgument);
  BeliefPlanner planner(tiger, policy, counted(10));
  EXPECT_THROW(planner.restart(Belief({0.2, 0.3, 0.5})), InvalidArgument);
  EXPECT_THROW(static_cast<void>(planner.advance(7, 0)), InvalidArgument);
  EXPECT_EQ(planner.belief().probabilities(), tiger.initialBelief().probabilities());
}

}  // namespace
}  // namespace kr3::pomdp
