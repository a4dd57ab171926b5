#include "observed_model.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "kr3_pomdp/model_builder.hpp"
#include "kr3_pomdp/simulation.hpp"
#include "kr3_pomdp/solver.hpp"
#include "support/models.hpp"

namespace kr3::pomdp
{
namespace
{

/// A row of cells with a thing in one of them. The robot sees its cell after each move and finds
/// out whether the thing is there; `take` earns 10 where it is, and starts anew.
/// @param knows_cell  whether it knows its cell at the start
Model row(std::size_t cells, bool knows_cell)
{
  std::vector<std::string> states;
  std::vector<std::string> observations;
  for (std::size_t r = 0; r < cells; ++r)
  {
    for (std::size_t o = 0; o < cells; ++o)
    {
      states.push_back("r" + std::to_string(r) + "o" + std::to_string(o));
    }
    observations.push_back("at" + std::to_string(r));
    observations.push_back("found" + std::to_string(r));
  }
  ModelBuilder builder(states, {"left", "right", "take"}, observations);
  builder.setDiscount(0.9);
  std::vector<double> start(states.size(), 0.0);
  const std::size_t known = knows_cell ? 1 : cells;
  for (std::size_t i = 0; i < known * cells; ++i)
  {
    start[i] = 1.0 / static_cast<double>(known * cells);
  }
  builder.setInitialBelief(start);
  for (std::size_t r = 0; r < cells; ++r)
  {
    for (std::size_t o = 0; o < cells; ++o)
    {
      const std::size_t s = r * cells + o;
      for (std::size_t a = 0; a < 3; ++a)
      {
        builder.setObservation(a, s, 2 * r + (r == o ? 1 : 0), 1.0);
      }
      builder.setTransition(0, s, (r == 0 ? r : r - 1) * cells + o, 1.0);
      builder.setTransition(1, s, (r + 1 == cells ? r : r + 1) * cells + o, 1.0);
      for (std::size_t next = 0; next < cells; ++next)
      {
        builder.setTransition(2, s, r * cells + next, 1.0 / static_cast<double>(cells));
      }
      builder.setReward(2, s, r == o ? 10.0 : -5.0);
    }
  }
  return builder.build();
}

std::vector<std::size_t> sizes(const ObservedModel& model)
{
  std::vector<std::size_t> result;
  for (const StateClass& state_class : model.classes())
  {
    result.push_back(state_class.states.size());
  }
  std::sort(result.begin(), result.end());
  return result;
}

TEST(ObservedModel, FindsWhatTheRobotAlwaysKnows)
{
  const Model model = test::roomSearch(2);
  EXPECT_EQ(sizes(ObservedModel(model)), (std::vector<std::size_t>{1, 5, 5, 5, 5}));
}

TEST(ObservedModel, LosesNothingToAnUnknownStart)
{
  const Model model = row(3, false);
  const ObservedModel observed(model);
  // Its cell is seen from the first action on: only the start mixes them.
  EXPECT_EQ(observed.starts().size(), 1U);
  const StateClass& start = observed.classes()[observed.starts()[0].state_class];
  EXPECT_TRUE(start.start_only);
  EXPECT_EQ(start.states.size(), 9U);
  for (const StateClass& state_class : observed.classes())
  {
    EXPECT_TRUE(state_class.start_only || state_class.states.size() <= 3U);
    for (const ClassAction& action : state_class.actions)
    {
      for (const Branch& branch : action.branches)
      {
        EXPECT_FALSE(observed.classes()[branch.target_class].start_only);
      }
    }
  }
}

TEST(ObservedModel, KeepsAStartThatIsOneClass)
{
  const Model model = test::roomSearch(2);
  const ObservedModel observed(model);
  EXPECT_FALSE(observed.classes()[observed.starts()[0].state_class].start_only);
}

TEST(ObservedModel, PolicyFromAnUnknownStartEarnsItsBound)
{
  const Model model = row(3, false);
  SolverLimits limits;
  limits.precision = 1e-3;
  limits.max_backups = 20000;
  const SolveResult result = solve(model, limits);
  EXPECT_EQ(result.reason, StopReason::kPrecision);
  EXPECT_NEAR(result.policy.valueAt(model.initialBelief()), result.lower, 1e-9);
  EvaluationLimits trials;
  trials.trials = 4000;
  const Evaluation value = evaluate(model, result.policy, trials, 3);
  EXPECT_NEAR(value.mean, result.lower, 3.0 * value.standard_error + 0.05);
}

TEST(ObservedModel, UnknownStartIsWorthNoMoreThanAKnownOne)
{
  SolverLimits limits;
  limits.precision = 1e-3;
  limits.max_backups = 20000;
  const SolveResult unknown = solve(row(3, false), limits);
  // In the middle or at an end: the mean over the cells, each of which the robot would know.
  const Model known = row(3, true);
  double mean = 0.0;
  for (std::size_t r = 0; r < 3; ++r)
  {
    std::vector<double> belief(9, 0.0);
    std::fill_n(belief.begin() + static_cast<std::ptrdiff_t>(3 * r), 3, 1.0 / 3.0);
    mean += solve(known.withInitialBelief(Belief(belief)), limits).upper / 3.0;
  }
  EXPECT_LE(unknown.lower, mean + 1e-6);
}

}  // namespace
}  // namespace kr3::pomdp
