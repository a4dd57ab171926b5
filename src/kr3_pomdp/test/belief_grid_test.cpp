#include "belief_grid.hpp"

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "kr3_pomdp/solver.hpp"
#include "support/models.hpp"
#include "work_split.hpp"

namespace kr3::pomdp
{
namespace
{

/// One round.
void improve(BeliefGrid& grid)
{
  do
  {
    grid.step();
  } while (grid.isInRound());
}

/// A grid without trials.
struct Setting
{
  explicit Setting(const Model& model)
    : observed(model)
    , blind(blindBound(observed, [] { return true; }))
    , graph(observed, informedBound(observed, [] { return true; }), blind)
    , grid(graph, [this] { return ++questions != stop_at; })
  {
  }

  double upper()
  {
    double sum = 0.0;
    for (std::size_t i = 0; i < graph.roots().size(); ++i)
    {
      sum += observed.starts()[i].probability * graph.upper(graph.roots()[i]);
    }
    return sum;
  }

  ObservedModel observed;
  InformedVectors blind;
  BeliefGraph graph;
  BeliefGrid grid;
  int questions = 0;  ///< of the grid
  int stop_at = 0;    ///< the question that is answered no
};

SolveResult solved(const Model& model, std::uint64_t backups)
{
  SolverLimits limits;
  limits.precision = 1e-4;
  limits.max_backups = backups;
  return solve(model, limits);
}

/// The belief of a node over all states.
Belief beliefOf(Setting& setting, NodeId node, std::size_t num_states)
{
  std::vector<double> all(num_states, 0.0);
  const std::vector<double> own = setting.graph.belief(node);
  const StateClass& state_class = setting.observed.classes()[setting.graph.stateClass(node)];
  for (std::size_t s = 0; s < own.size(); ++s)
  {
    all[state_class.states[s]] = own[s];
  }
  return Belief(all);
}

/// Bounds fall from round to round, stay above what a policy earns, at the start and wherever the
/// grid has been.
void expectSound(const Model& model, int rounds, const std::string& what)
{
  const SolveResult reference = solved(model, 1000);
  Setting setting(model);
  double before = setting.upper();
  for (int i = 0; i < rounds; ++i)
  {
    improve(setting.grid);
    const double now = setting.upper();
    ASSERT_LE(now, before) << what << ", round " << i;
    ASSERT_GE(now, reference.lower - 1e-9) << what << ", round " << i;
    before = now;
  }
  for (NodeId node = 0; node < std::min<std::size_t>(setting.graph.numNodes(), 3000); ++node)
  {
    const Belief belief = beliefOf(setting, node, model.numStates());
    ASSERT_GE(setting.graph.upper(node), reference.policy.valueAt(belief) - 1e-9)
        << what << ", node " << node;
  }
}

TEST(BeliefGrid, IsNeverBelowAPolicyOnRandomModels)
{
  for (std::uint64_t seed = 1; seed <= 8; ++seed)
  {
    test::RandomShape shape;
    shape.num_states = 2 + seed % 7;
    shape.num_actions = 2 + seed % 3;
    shape.num_observations = 2 + seed % 4;
    shape.discount = seed % 2 == 0 ? 0.9 : 0.7;
    expectSound(test::randomModel(shape, seed), 12, "seed " + std::to_string(seed));
  }
}

TEST(BeliefGrid, IsNeverBelowAPolicyWhereTheCellIsSeen)
{
  expectSound(test::roomSearch(2), 12, "room of 4 cells");
}

TEST(BeliefGrid, AloneFindsTheValueOfTheTiger)
{
  const Model model = test::tiger();
  const SolveResult reference = solved(model, 1000);
  Setting setting(model);
  const double informed = setting.upper();
  for (int i = 0; i < 60; ++i)
  {
    improve(setting.grid);
  }
  EXPECT_GE(setting.upper(), reference.lower - 1e-9);
  EXPECT_LT(setting.upper(), reference.upper + 0.05);
  EXPECT_GT(informed, reference.upper + 1.0);
}

TEST(BeliefGrid, IsTighterThanTheInformedBoundOnRandomModels)
{
  test::RandomShape shape{12, 3, 4, 0.95};
  for (std::uint64_t seed = 1; seed <= 3; ++seed)
  {
    const Model model = test::randomModel(shape, seed);
    const SolveResult reference = solved(model, 1000);
    Setting setting(model);
    const double informed = setting.upper() - reference.lower;
    for (int i = 0; i < 15; ++i)
    {
      improve(setting.grid);
    }
    EXPECT_LT(setting.upper() - reference.lower, 0.5 * informed) << "seed " << seed;
  }
}

TEST(BeliefGrid, Repeats)
{
  const Model model = test::randomModel({10, 3, 4, 0.9}, 5);
  Setting first(model);
  Setting second(model);
  for (int i = 0; i < 8; ++i)
  {
    improve(first.grid);
    improve(second.grid);
    EXPECT_EQ(first.grid.isExhausted(), second.grid.isExhausted());
    EXPECT_EQ(first.upper(), second.upper());
    EXPECT_EQ(first.grid.work(), second.grid.work());
    EXPECT_EQ(first.grid.numPoints(), second.grid.numPoints());
  }
}

TEST(BeliefGrid, HasTrueBoundsAfterEachStep)
{
  const Model model = test::randomModel({8, 3, 3, 0.9}, 9);
  const SolveResult reference = solved(model, 1000);
  Setting setting(model);
  double before = setting.upper();
  for (int i = 0; i < 500; ++i)
  {
    setting.grid.step();
    ASSERT_LE(setting.upper(), before);
    before = setting.upper();
    ASSERT_GE(before, reference.lower - 1e-9);
  }
}

TEST(BeliefGrid, StopsWithinAStepWithTrueBounds)
{
  const Model model = test::randomModel({60, 4, 8, 0.9}, 9);
  const SolveResult reference = solved(model, 300);
  Setting asked(model);
  for (int i = 0; i < 3; ++i)
  {
    improve(asked.grid);
  }
  ASSERT_GT(asked.questions, 20);
  for (int stop_at = 1; stop_at <= asked.questions; stop_at += 1 + asked.questions / 10)
  {
    Setting setting(model);
    setting.stop_at = stop_at;
    while (setting.questions < stop_at)
    {
      setting.grid.step();
    }
    EXPECT_EQ(setting.questions, stop_at) << "went on after it was told to stop";
    for (int i = 0; i < 2; ++i)  // it may be asked to go on all the same
    {
      improve(setting.grid);
      ASSERT_GE(setting.upper(), reference.lower - 1e-9);
    }
  }
}

TEST(BeliefGrid, CountsItsBackupsAndMemory)
{
  Setting setting(test::randomModel({8, 3, 3, 0.9}, 2));
  const std::size_t bytes = setting.grid.sizeInBytes();
  const std::size_t corners = 8;
  EXPECT_EQ(setting.grid.numPoints(), 0U);
  improve(setting.grid);
  EXPECT_GT(setting.grid.backups(), 0U);
  EXPECT_GE(setting.grid.backups(), setting.grid.numPoints() - corners);
  EXPECT_GT(setting.grid.sizeInBytes(), bytes);
}

TEST(BeliefGrid, LetsASolverRunRepeat)
{
  const Model model = test::randomModel({40, 4, 5, 0.95}, 4);
  SolverLimits limits;
  limits.precision = 0.0;
  limits.max_backups = 1000;
  const SolveResult first = solve(model, limits);
  const SolveResult second = solve(model, limits);
  EXPECT_EQ(first.lower, second.lower);
  EXPECT_EQ(first.upper, second.upper);
  EXPECT_LE(first.lower, first.upper);
}

TEST(WorkSplit, GivesMoreToWhatGainsMore)
{
  const auto share = [](double of_trial, double of_round) {
    WorkSplit split;
    double rounds = 0.0;
    double all = 0.0;
    for (int i = 0; i < 4000; ++i)
    {
      const bool grid = split.gridIsDue();
      if (grid)
      {
        split.addRound(1000000, of_round, true);
      }
      else
      {
        split.addTrial(1000000, of_trial);
      }
      rounds += grid ? 1.0 : 0.0;
      all += 1.0;
    }
    return rounds / all;
  };
  EXPECT_LT(share(1.0, 0.0), 0.08);
  EXPECT_GT(share(1.0, 0.0), 0.02);
  EXPECT_GT(share(0.0, 1.0), 0.5);
  EXPECT_LT(share(0.0, 1.0), 0.7);
  EXPECT_NEAR(share(1.0, 1.0), 0.5, 0.05);
}

TEST(WorkSplit, LeavesEasyModelsAndAFinishedGridAlone)
{
  WorkSplit split;
  EXPECT_FALSE(split.gridIsDue());
  split.addTrial(1000, 1.0);
  EXPECT_FALSE(split.gridIsDue());
  split.addTrial(1000000000, 1.0);
  EXPECT_TRUE(split.gridIsDue());
  split.addRound(10, 0.0, false);
  EXPECT_FALSE(split.gridIsDue());
}

}  // namespace
}  // namespace kr3::pomdp
