// Models with discount 1 that are solved without a horizon, because their runs end.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_pomdp/exact_solver.hpp"
#include "kr3_pomdp/model_builder.hpp"
#include "kr3_pomdp/simulation.hpp"
#include "kr3_pomdp/solver.hpp"
#include "support/cases.hpp"
#include "support/oracles.hpp"

namespace kr3::pomdp
{
namespace
{

/// The tiger with one door to open: after that all is over.
Model tigerOnce()
{
  constexpr std::size_t kOver = 2;
  ModelBuilder builder({"left", "right", "over"}, {"listen", "open_left", "open_right"},
                       {"hear_left", "hear_right"});
  builder.setTransition(kAny, kOver, kOver, 1.0);
  builder.setObservation(kAny, kAny, 0, 0.5);
  builder.setObservation(kAny, kAny, 1, 0.5);
  for (std::size_t s = 0; s < 2; ++s)
  {
    builder.setTransition(0, s, s, 1.0);
    builder.setObservation(0, s, s, 0.85);
    builder.setObservation(0, s, 1 - s, 0.15);
    builder.setReward(0, s, -1.0);
    for (std::size_t open = 1; open < 3; ++open)
    {
      builder.setTransition(open, s, kOver, 1.0);
      builder.setReward(open, s, open == s + 1 ? -100.0 : 10.0);
    }
  }
  builder.setInitialBelief({0.5, 0.5, 0.0});
  return builder.build();
}

/// A message of the refusal, or "".
std::string refusalOf(const Model& model)
{
  try
  {
    (void)solve(model, test::backups(10));
  }
  catch (const InvalidArgument& e)
  {
    return e.what();
  }
  return "";
}

TEST(Undiscounted, TheTigerOnceIsAGamblersWalk)
{
  // The plan listens until one side leads by k and opens the other door: a walk with steps of
  // probability 0.85 and 0.15 between k and -k (Feller 1968, Sec. XIV.3).
  const double p = 0.85;
  const double q = 1.0 - p;
  double best = 0.5 * (10.0 - 100.0);
  for (int k = 1; k < 8; ++k)
  {
    const double right = std::pow(p, k) / (std::pow(p, k) + std::pow(q, k));
    const double steps = k / (p - q) * (2.0 * right - 1.0);
    best = std::max(best, -steps + 10.0 * right - 100.0 * (1.0 - right));
  }
  const SolveResult result = solve(tigerOnce(), test::backups(20000, 1e-6));
  EXPECT_LE(result.lower, best + 1e-9);
  EXPECT_GE(result.upper, best - 1e-9);
  EXPECT_NEAR(result.lower, best, 1e-4);
  EXPECT_NEAR(result.upper, best, 1e-4);
}

TEST(Undiscounted, TryingUntilItWorksHasItsGeometricValue)
{
  ModelBuilder builder({"trying", "done"}, {"try", "wait"}, {"o"});
  builder.setTransition(0, 0, 1, 0.02);
  builder.setTransition(0, 0, 0, 0.98);
  builder.setTransition(1, 0, 0, 1.0);
  builder.setTransition(kAny, 1, 1, 1.0);
  builder.setObservation(kAny, kAny, 0, 1.0);
  builder.setReward(0, 0, -3.0);
  builder.setReward(1, 0, -1.0);
  builder.setInitialBelief({1.0, 0.0});
  const SolveResult result = solve(builder.build(), test::backups(5000, 1e-3));
  EXPECT_LE(result.lower, -150.0 + 1e-6);
  EXPECT_GE(result.upper, -150.0 - 1e-6);
  EXPECT_NEAR(result.lower, -150.0, 0.1);
  EXPECT_NEAR(result.upper, -150.0, 0.1);
}

TEST(Undiscounted, NoSingleActionNeedsToEnd)
{
  // A corridor of which the robot does not know the direction: neither way ends for sure, a random
  // walk does. Left of cell 1 and right of cell 3 is the end; a bump is felt.
  ModelBuilder builder({"a0", "a1", "b0", "b1", "end"}, {"left", "right"}, {"nothing", "bump"});
  for (std::size_t flip = 0; flip < 2; ++flip)
  {
    const std::size_t near = 2 * flip;
    const std::size_t far = near + 1;
    const std::size_t out = flip;
    const std::size_t in = 1 - flip;
    builder.setTransition(out, near, 4, 1.0);
    builder.setTransition(in, near, far, 1.0);
    builder.setTransition(out, far, near, 1.0);
    builder.setTransition(in, far, far, 1.0);
  }
  builder.setTransition(kAny, 4, 4, 1.0);
  builder.setObservation(kAny, kAny, 0, 1.0);
  for (std::size_t s = 0; s < 4; ++s)
  {
    builder.setReward(kAny, s, -1.0);
  }
  builder.setInitialBelief({0.25, 0.25, 0.25, 0.25, 0.0});
  const Model model = builder.build();
  // All steps cost the same, so the best plan goes one way until half of the cases are over, two
  // steps, and then back until the others are, from their far cell: 1, 2, 2 + 2 and 2 + 2 steps.
  const double best = -0.25 * (1.0 + 2.0 + 4.0 + 4.0);
  const SolveResult result = solve(model, test::backups(3000, 1e-6));
  EXPECT_LE(result.lower, result.upper);
  EXPECT_GE(result.upper, best - 1e-9);
  EXPECT_NEAR(result.lower, best, 1e-6);
  EXPECT_NEAR(result.upper, best, 1e-6);
}

TEST(Undiscounted, SearchesHoldTheirBounds)
{
  test::forEachModel(40, [](const Model& discounted, std::uint64_t seed) {
    if (seed % 4 != 0)
    {
      return;  // others need not end
    }
    const Model model = test::withDiscount(discounted, 1.0);
    const SolveResult early = solve(model, test::backups(3));
    const SolveResult result = solve(model, test::backups(1000, 1e-4));
    EXPECT_LE(early.lower, result.upper + 1e-9);
    EXPECT_GE(early.upper, result.lower - 1e-9);
    EvaluationLimits limits;
    limits.trials = 2000;
    const Evaluation value = evaluate(model, result.policy, limits, seed);
    EXPECT_GE(value.mean + 5.0 * value.standard_error + 1e-9, result.lower);
    EXPECT_LE(value.mean - 5.0 * value.standard_error - 1e-9, result.upper);
    EXPECT_GT(value.finished, 0.999);
  });
}

TEST(Undiscounted, IsTheLimitOfDiscountsNearOne)
{
  for (const std::uint64_t seed : {4U, 8U, 12U})
  {
    const Model model = test::randomSearch(seed);
    const SolveResult near = solve(test::withDiscount(model, 0.9999), test::backups(3000, 1e-4));
    const SolveResult result = solve(test::withDiscount(model, 1.0), test::backups(3000, 1e-4));
    EXPECT_LE(result.lower, near.upper + 0.05) << "seed " << seed;
    EXPECT_GE(result.upper, near.lower - 0.05) << "seed " << seed;
  }
}

TEST(Undiscounted, SearchesRoomsWithoutDiscount)
{
  const Model model = test::withDiscount(test::roomSearch(2), 1.0);
  const SolveResult result = solve(model, test::backups(5000));
  EXPECT_LE(result.lower, result.upper);
  EXPECT_GT(result.lower,
            solve(test::roomSearch(2), test::backups(5000)).lower);  // nothing is lost
  EvaluationLimits limits;
  limits.trials = 4000;
  const Evaluation value = evaluate(model, result.policy, limits, 2);
  EXPECT_GE(value.mean + 4.0 * value.standard_error, result.lower);
  EXPECT_LE(value.mean - 4.0 * value.standard_error, result.upper);
}

TEST(Undiscounted, SaysWhyItRefuses)
{
  EXPECT_NE(refusalOf(test::tiger(1.0)).find("the robot can go on for ever"), std::string::npos);

  // Waiting costs nothing: whether the run ends is left open.
  ModelBuilder waiting({"here", "done"}, {"wait", "go"}, {"o"});
  waiting.setTransition(0, 0, 0, 1.0);
  waiting.setTransition(1, 0, 1, 1.0);
  waiting.setTransition(kAny, 1, 1, 1.0);
  waiting.setObservation(kAny, kAny, 0, 1.0);
  waiting.setReward(1, 0, -1.0);
  waiting.setInitialBelief({1.0, 0.0});
  const std::string endless = refusalOf(waiting.build());
  EXPECT_NE(endless.find("from state 'here'"), std::string::npos) << endless;
  EXPECT_NE(endless.find("do 'wait' again and again with reward 0"), std::string::npos) << endless;
  EXPECT_NE(endless.find("give a horizon"), std::string::npos) << endless;

  // A trap that costs something for ever.
  ModelBuilder trap({"here", "trap", "done"}, {"go", "try"}, {"o"});
  trap.setTransition(0, 0, 2, 1.0);
  trap.setTransition(1, 0, 1, 1.0);
  trap.setTransition(kAny, 1, 1, 1.0);
  trap.setTransition(kAny, 2, 2, 1.0);
  trap.setObservation(kAny, kAny, 0, 1.0);
  trap.setReward(kAny, 0, -1.0);
  trap.setReward(kAny, 1, -1.0);
  trap.setInitialBelief({1.0, 0.0, 0.0});
  EXPECT_NE(refusalOf(trap.build()).find("from state 'trap' no run ends"), std::string::npos);
}

}  // namespace
}  // namespace kr3::pomdp
