#include "exclusion_bound.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "kr3_pomdp/model_builder.hpp"
#include "kr3_pomdp/simulation.hpp"
#include "kr3_pomdp/solver.hpp"
#include "noise_free_sensors.hpp"
#include "support/models.hpp"

namespace kr3::pomdp
{
namespace
{

/// The bound of a model, worked out to its end.
class Bound
{
public:
  explicit Bound(const Model& model, std::size_t most_values = 17)
    : observed_(model)
    , informed_(informedBound(observed_, [] { return true; }))
    , bound_(ExclusionBound::make(observed_, informed_, {}, most_values))
  {
    while (bound_ && !bound_->finished())
    {
      bound_->advance();
    }
  }
  [[nodiscard]] bool applies() const { return bound_ != nullptr; }
  /// @param belief  of the model, in one class
  [[nodiscard]] double at(const Belief& belief) const
  {
    for (std::uint32_t c = 0; c < observed_.classes().size(); ++c)
    {
      std::vector<double> local;
      double sum = 0.0;
      for (const std::uint32_t s : observed_.classes()[c].states)
      {
        local.push_back(belief[s]);
        sum += belief[s];
      }
      if (sum > 0.5)
      {
        return bound_->upper(c, local.data());
      }
    }
    return std::numeric_limits<double>::infinity();
  }
  [[nodiscard]] double informedAt(const Belief& belief) const
  {
    double best = -std::numeric_limits<double>::infinity();
    for (std::size_t c = 0; c < informed_.size(); ++c)
    {
      const std::vector<std::uint32_t>& states = observed_.classes()[c].states;
      if (belief[states.front()] == 0.0)
      {
        continue;
      }
      for (const std::vector<double>& vector : informed_[c])
      {
        double sum = 0.0;
        for (std::size_t i = 0; i < states.size(); ++i)
        {
          sum += belief[states[i]] * vector[i];
        }
        best = std::max(best, sum);
      }
    }
    return best;
  }

private:
  ObservedModel observed_;
  InformedVectors informed_;
  std::unique_ptr<ExclusionBound> bound_;
};

/// Optimum of the room search with a camera that never errs, where every cell is as likely as
/// `elsewhere` and the robot is in the first: by cells that are left, in plain words of that
/// problem.
double cleanRoomSearch(std::size_t width)
{
  const std::size_t cells = width * width;
  const double found = (0.9 * 100.0 - 0.1 * 4.0) / (1.0 - 0.98 * 0.1);
  const auto distance = [width](std::size_t i, std::size_t k) {
    const auto step = [](std::size_t a, std::size_t b) { return a > b ? a - b : b - a; };
    return step(i % width, k % width) + step(i / width, k / width);
  };
  std::vector<std::vector<double>> value(std::size_t{1} << cells, std::vector<double>(cells));
  for (std::size_t left = 0; left < value.size(); ++left)
  {
    const double each = 1.0 / (1.0 + static_cast<double>(__builtin_popcountll(left)));
    std::vector<double> here(cells, 20.0 * each - 100.0 * (1.0 - each));  // finish
    for (std::size_t r = 0; r < cells; ++r)
    {
      if ((left >> r & 1U) != 0)
      {
        const double other = value[left ^ (std::size_t{1} << r)][r];
        here[r] = std::max(here[r], -2.0 + 0.98 * (each * found + (1.0 - each) * other));
      }
    }
    std::vector<double>& now = value[left];
    now = here;
    for (int sweep = 0; sweep < 60; ++sweep)
    {
      for (std::size_t r = 0; r < cells; ++r)
      {
        for (std::size_t k = 0; k < cells; ++k)
        {
          double slipped = 0.0;
          double count = 0.0;
          for (std::size_t q = 0; q < cells; ++q)
          {
            slipped += distance(q, k) == 1 ? now[q] : 0.0;
            count += distance(q, k) == 1 ? 1.0 : 0.0;
          }
          now[r] = std::max(now[r], -1.0 - static_cast<double>(distance(r, k)) +
                                        0.98 * (0.95 * now[k] + 0.05 * slipped / count));
        }
      }
    }
  }
  return value.back().front();
}

/// A robot that goes from place to place, with sensors that differ by place and value, and actions
/// that end the search where they succeed.
Model randomSearch(std::size_t num_places, std::size_t num_values, std::uint64_t seed)
{
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<std::string> states;
  std::vector<std::string> actions{"look", "touch", "take"};
  std::vector<std::string> observations{"yes", "no", "over"};
  for (std::size_t r = 0; r < num_places; ++r)
  {
    for (std::size_t h = 0; h < num_values; ++h)
    {
      states.push_back("place" + std::to_string(r) + "value" + std::to_string(h));
    }
    actions.push_back("go" + std::to_string(r));
    observations.push_back("at" + std::to_string(r));
  }
  states.emplace_back("over");
  const std::size_t over = states.size() - 1;
  ModelBuilder builder(states, actions, observations);
  builder.setDiscount(0.9);
  std::vector<double> start(states.size(), 0.0);
  double sum = 0.0;
  for (std::size_t h = 0; h < num_values; ++h)
  {
    sum += start[h] = 0.1 + uniform(random);
  }
  for (double& p : start)
  {
    p /= sum;
  }
  builder.setInitialBelief(start);
  const std::vector<double> likelihoods{0.0, 0.1, 0.5, 0.8, 1.0};
  const auto likelihood = [&] {
    return likelihoods[static_cast<std::size_t>(uniform(random) * 5.0)];
  };
  for (std::size_t a = 0; a < actions.size(); ++a)
  {
    builder.setTransition(a, over, over, 1.0);
    builder.setObservation(a, over, 2, 1.0);
  }
  for (std::size_t r = 0; r < num_places; ++r)
  {
    for (std::size_t h = 0; h < num_values; ++h)
    {
      const std::size_t s = r * num_values + h;
      for (std::size_t sensor = 0; sensor < 2; ++sensor)
      {
        const double yes = likelihood();
        builder.setTransition(sensor, s, s, 1.0);
        builder.setObservation(sensor, s, 0, yes);
        builder.setObservation(sensor, s, 1, 1.0 - yes);
        builder.setReward(sensor, s, -0.2 * uniform(random));
      }
      const double success = likelihood();
      builder.setTransition(2, s, over, success);
      builder.setTransition(2, s, s, 1.0 - success);
      builder.setObservation(2, s, 1, 1.0);
      builder.setReward(2, s, over, kAny, 10.0 * uniform(random) - 2.0);
      builder.setReward(2, s, s, kAny, -3.0 * uniform(random));
      for (std::size_t to = 0; to < num_places; ++to)
      {
        const std::size_t next = to * num_values + h;
        builder.setTransition(3 + to, s, s, next == s ? 1.0 : 0.2);
        builder.setTransition(3 + to, s, next, next == s ? 1.0 : 0.8);
        builder.setObservation(3 + to, s, 3 + r, 1.0);
        builder.setReward(3 + to, s, -0.5);
      }
    }
  }
  return builder.build();
}

SolverLimits backups(std::uint64_t count)
{
  SolverLimits limits;
  limits.precision = 1e-4;
  limits.max_backups = count;
  return limits;
}

TEST(ExclusionBound, IsTheOptimumOfTheSearchWithCleanSensors)
{
  for (const std::size_t width : {2U, 3U})
  {
    const Model model = test::roomSearch(width);
    const Bound bound(model);
    ASSERT_TRUE(bound.applies());
    EXPECT_NEAR(bound.at(model.initialBelief()), cleanRoomSearch(width), 1e-3);
  }
}

TEST(ExclusionBound, IsFarBelowTheInformedBound)
{
  const Model model = test::roomSearch(3);
  const Bound bound(model);
  ASSERT_TRUE(bound.applies());
  EXPECT_LT(bound.at(model.initialBelief()), 59.0);
  EXPECT_GT(bound.informedAt(model.initialBelief()), 80.0);
}

/// Beliefs of a simulated run under random actions, the first included.
std::vector<Belief> beliefsMet(const Model& model, std::uint64_t seed, int steps)
{
  std::mt19937_64 random(seed);
  std::vector<Belief> beliefs{model.initialBelief()};
  std::size_t state = sampleState(beliefs.back(), random);
  for (int i = 0; i < steps; ++i)
  {
    const std::size_t action = random() % model.numActions();
    const SampledStep step = sampleStep(model, state, action, random);
    beliefs.push_back(updated(model, beliefs.back(), action, step.observation).posterior);
    state = step.next_state;
  }
  return beliefs;
}

TEST(ExclusionBound, IsNeverBelowWhatAPolicyEarns)
{
  for (std::uint64_t seed = 1; seed <= 60; ++seed)
  {
    const Model model = randomSearch(1 + seed % 3, 2 + seed % 4, seed);
    const SolveResult solved = solve(model, backups(400));
    for (const std::size_t most_values : {17U, 3U, 2U})
    {
      const Bound bound(model, most_values);
      ASSERT_TRUE(bound.applies()) << "seed " << seed;
      for (const Belief& belief : beliefsMet(model, seed, 30))
      {
        ASSERT_GE(bound.at(belief), solved.policy.valueAt(belief) - 1e-6)
            << "seed " << seed << ", at most " << most_values << " values";
      }
    }
  }
}

TEST(ExclusionBound, IsTheOptimumWhereSensorsAreCleanAlready)
{
  for (std::uint64_t seed = 1; seed <= 20; ++seed)
  {
    const Model model = withNoiseFreeSensors(randomSearch(2, 4, seed));
    const Bound bound(model);
    ASSERT_TRUE(bound.applies());
    const SolveResult solved = solve(model, backups(3000));
    EXPECT_GE(bound.at(model.initialBelief()), solved.lower - 1e-6) << "seed " << seed;
    EXPECT_LE(solved.upper, bound.at(model.initialBelief()) + 2e-4) << "seed " << seed;
  }
}

TEST(ExclusionBound, GroupingValuesNeverLowersIt)
{
  const Model model = test::roomSearch(3);
  const Bound fine(model);
  const Bound grouped(model, 6);
  ASSERT_TRUE(grouped.applies());
  for (const Belief& belief : beliefsMet(model, 3, 40))
  {
    EXPECT_GE(grouped.at(belief), fine.at(belief) - 1e-4);
  }
  EXPECT_LT(grouped.at(model.initialBelief()), 75.0);
}

TEST(ExclusionBound, ManyCellsAreGrouped)
{
  const Model model = test::roomSearch(5);
  const Bound bound(model);
  ASSERT_TRUE(bound.applies());
  const SolveResult solved = solve(model, backups(2000));
  EXPECT_GE(bound.at(model.initialBelief()), solved.lower);
  EXPECT_LT(bound.at(model.initialBelief()), 50.0);
}

TEST(ExclusionBound, DoesNotApplyWhereTheHiddenValueMoves)
{
  EXPECT_FALSE(Bound(test::tiger()).applies());  // the tiger moves when a door is opened
  EXPECT_FALSE(Bound(test::randomModel({4, 2, 2, 0.9}, 1)).applies());
}

TEST(NoiseFreeSensors, TellTheGroupsOfEqualDistributions)
{
  const Model clean = withNoiseFreeSensors(test::tiger());
  EXPECT_NE(clean.observations(0, 0).begin()->index, clean.observations(0, 1).begin()->index);
  EXPECT_EQ(clean.observations(1, 0).begin()->index, clean.observations(1, 1).begin()->index);
  const SolveResult real = solve(test::tiger(), backups(2000));
  const SolveResult ideal = solve(clean, backups(2000));
  EXPECT_GT(ideal.lower, real.upper);
}

}  // namespace
}  // namespace kr3::pomdp
