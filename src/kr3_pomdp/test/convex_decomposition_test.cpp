#include "convex_decomposition.hpp"

#include <algorithm>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace kr3::pomdp
{
namespace
{

const auto always = [] { return true; };

std::vector<double> randomBelief(std::size_t size, std::mt19937_64& random)
{
  std::exponential_distribution<double> part;
  std::vector<double> belief(size);
  double sum = 0.0;
  for (double& p : belief)
  {
    p = random() % 3 == 0 ? 0.0 : part(random);
    sum += p;
  }
  if (!(sum > 0.0))
  {
    belief[0] = sum = 1.0;
  }
  for (double& p : belief)
  {
    p /= sum;
  }
  return belief;
}

std::vector<std::vector<double>> randomCorners(std::size_t actions, std::size_t states,
                                               std::mt19937_64& random)
{
  std::uniform_real_distribution<double> value(-10.0, 10.0);
  std::vector<std::vector<double>> corners(actions, std::vector<double>(states));
  for (std::vector<double>& of_action : corners)
  {
    for (double& v : of_action)
    {
      v = value(random);
    }
  }
  return corners;
}

/// Points whose bounds are below what corners give, by a random part.
GridPoints randomPoints(const std::vector<std::vector<double>>& corners, std::size_t count,
                        std::mt19937_64& random)
{
  std::uniform_real_distribution<double> drop(0.0, 5.0);
  GridPoints points(corners.front().size(), corners);
  for (std::size_t i = 0; i < count; ++i)
  {
    const std::vector<double> belief = randomBelief(points.numStates(), random);
    std::vector<double> values;
    for (const std::vector<double>& of_action : corners)
    {
      double value = -drop(random);
      for (std::size_t s = 0; s < belief.size(); ++s)
      {
        value += belief[s] * of_action[s];
      }
      values.push_back(value);
    }
    points.add(belief, values);
  }
  return points;
}

std::vector<double> sumOf(const GridPoints& points, const std::vector<Share>& shares)
{
  std::vector<double> sum(points.numStates(), 0.0);
  for (const Share& share : shares)
  {
    if (points.isCorner(share.point))
    {
      sum[share.point] += share.weight;
      continue;
    }
    for (const SparseEntry& entry : points.belief(share.point))
    {
      sum[entry.index] += share.weight * entry.probability;
    }
  }
  return sum;
}

std::vector<Share> cornersOf(const std::vector<double>& belief)
{
  std::vector<Share> shares;
  for (std::uint32_t s = 0; s < belief.size(); ++s)
  {
    shares.push_back({s, belief[s]});
  }
  return shares;
}

TEST(Decomposer, MakesUpTheBeliefAndIsOptimal)
{
  std::mt19937_64 random(7);
  Decomposer decomposer;
  for (int trial = 0; trial < 300; ++trial)
  {
    const std::size_t states = 2 + random() % 20;
    const std::size_t actions = 1 + random() % 5;
    const GridPoints points =
        randomPoints(randomCorners(actions, states, random), random() % 60, random);
    const std::vector<double> belief = randomBelief(states, random);
    std::vector<Share> shares;
    std::vector<float> duals;
    decomposer.decompose(points, belief, 1e-3, shares, duals, always);

    const std::vector<double> sum = sumOf(points, shares);
    for (std::size_t s = 0; s < states; ++s)
    {
      ASSERT_NEAR(sum[s], belief[s], 1e-14) << "trial " << trial;
    }
    for (const Share& share : shares)
    {
      ASSERT_GT(share.weight, 0.0);
    }
    const double value = points.best(shares).value;
    ASSERT_LE(value, points.best(cornersOf(belief)).value + 1e-12);
    // Weak duality: no decomposition is better than what duals that no point undercuts say.
    double dual_value = 0.0;
    for (std::size_t s = 0; s < states; ++s)
    {
      dual_value += belief[s] == 0.0 ? 0.0 : belief[s] * static_cast<double>(duals[s]);
    }
    ASSERT_GE(points.leastCost(duals, 0), -1e-3);
    ASSERT_NEAR(value, dual_value, 0.05) << "trial " << trial;
  }
}

TEST(Decomposer, FindsTheLowerHullOfTwoStates)
{
  std::mt19937_64 random(3);
  Decomposer decomposer;
  for (int trial = 0; trial < 100; ++trial)
  {
    const std::vector<std::vector<double>> corners = randomCorners(1, 2, random);
    const GridPoints points = randomPoints(corners, 8, random);
    std::vector<std::pair<double, double>> all = {{0.0, corners[0][0]}, {1.0, corners[0][1]}};
    for (std::uint32_t i = 2; i < points.size(); ++i)
    {
      double x = 0.0;
      for (const SparseEntry& entry : points.belief(i))
      {
        x += entry.index == 1 ? entry.probability : 0.0;
      }
      all.emplace_back(x, points.values(i)[0]);
    }
    const std::vector<double> belief = {0.4, 0.6};
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [x, v] : all)
    {
      for (const auto& [y, w] : all)
      {
        if (x <= belief[1] && belief[1] <= y && x < y)
        {
          least = std::min(least, v + (w - v) * (belief[1] - x) / (y - x));
        }
      }
    }
    std::vector<Share> shares;
    std::vector<float> duals;
    decomposer.decompose(points, belief, 1e-6, shares, duals, always);
    ASSERT_NEAR(points.best(shares).value, least, 1e-4) << "trial " << trial;
  }
}

TEST(Decomposer, OneActionHasToServeAllShares)
{
  const GridPoints points(2, {{1.0, 0.0}, {0.0, 1.0}});
  std::vector<Share> shares;
  std::vector<float> duals;
  Decomposer().decompose(points, {0.5, 0.5}, 1e-6, shares, duals, always);
  EXPECT_DOUBLE_EQ(points.best(shares).value, 0.5);
}

TEST(Decomposer, BeginsNearAnEarlierDecomposition)
{
  std::mt19937_64 random(11);
  GridPoints points = randomPoints(randomCorners(3, 30, random), 200, random);
  const std::vector<double> belief(30, 1.0 / 30.0);
  Decomposer decomposer;
  std::vector<Share> shares;
  std::vector<float> duals;
  decomposer.decompose(points, belief, 1e-3, shares, duals, always);
  const std::uint64_t cold = decomposer.work();
  const double before = points.best(shares).value;
  const std::uint32_t seen = points.size();
  points.add(belief, {before - 1.0, before - 1.0, before - 1.0});
  EXPECT_LT(points.leastCost(duals, seen), -0.5);
  decomposer.decompose(points, belief, 1e-3, shares, duals, always);
  EXPECT_LE(points.best(shares).value, before - 1.0 + 1e-3);
  EXPECT_LT(decomposer.work() - cold, cold);
}

TEST(Decomposer, MakesUpTheBeliefWhereverItIsStopped)
{
  std::mt19937_64 random(12);
  const GridPoints points = randomPoints(randomCorners(3, 20, random), 100, random);
  const std::vector<double> belief(20, 1.0 / 20.0);
  double first = 0.0;
  double last = 0.0;
  for (int stop_at = 0; stop_at < 30; ++stop_at)
  {
    std::vector<Share> shares;
    std::vector<float> duals;
    int pivots = 0;
    Decomposer().decompose(points, belief, 1e-6, shares, duals, [&] { return pivots++ < stop_at; });
    std::vector<double> sum(20, 0.0);
    for (const Share& share : shares)
    {
      if (points.isCorner(share.point))
      {
        sum[share.point] += share.weight;
        continue;
      }
      for (const SparseEntry& entry : points.belief(share.point))
      {
        sum[entry.index] += share.weight * entry.probability;
      }
    }
    for (std::size_t s = 0; s < sum.size(); ++s)
    {
      ASSERT_NEAR(sum[s], belief[s], 1e-9) << "stopped at " << stop_at;
    }
    last = points.best(shares).value;
    first = stop_at == 0 ? last : first;
  }
  EXPECT_LT(last, first - 0.1);
}

TEST(Decomposer, LeavesBeliefsOverVeryManyStatesToTheCorners)
{
  constexpr std::size_t kStates = 5000;
  GridPoints points(kStates, {std::vector<double>(kStates, 2.0)});
  const std::vector<double> belief(kStates, 1.0 / kStates);
  points.add(belief, {1.0});
  std::vector<Share> shares;
  std::vector<float> duals;
  Decomposer().decompose(points, belief, 1e-6, shares, duals, always);
  EXPECT_EQ(shares.size(), kStates);
  EXPECT_DOUBLE_EQ(points.leastCost(duals, 0), 0.0);
}

}  // namespace
}  // namespace kr3::pomdp
