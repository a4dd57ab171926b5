#include "domination.hpp"

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "support/models.hpp"

namespace kr3::pomdp
{
namespace
{

using Vectors = std::vector<std::vector<double>>;

std::vector<const double*> pointers(const Vectors& vectors)
{
  std::vector<const double*> result;
  for (const std::vector<double>& vector : vectors)
  {
    result.push_back(vector.data());
  }
  return result;
}

double marginAt(const std::vector<double>& vector, const Vectors& set,
                const std::vector<double>& belief)
{
  double least = std::numeric_limits<double>::infinity();
  for (const std::vector<double>& other : set)
  {
    double sum = 0.0;
    for (std::size_t s = 0; s < belief.size(); ++s)
    {
      sum += belief[s] * (vector[s] - other[s]);
    }
    least = std::min(least, sum);
  }
  return least;
}

TEST(Domination, TwoStatesAgreeWithAllCrossings)
{
  // Over one number the least of some lines is greatest at an end or where two of them cross.
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int round = 0; round < 300; ++round)
  {
    const std::vector<double> vector{uniform(random), uniform(random)};
    Vectors set(1 + random() % 6);
    for (std::vector<double>& other : set)
    {
      other = {uniform(random), uniform(random)};
    }
    double greatest =
        std::max(marginAt(vector, set, {1.0, 0.0}), marginAt(vector, set, {0.0, 1.0}));
    for (const std::vector<double>& left : set)
    {
      for (const std::vector<double>& right : set)
      {
        const double slope = (left[0] - left[1]) - (right[0] - right[1]);
        const double p = (right[1] - left[1]) / slope;
        if (slope != 0.0 && p >= 0.0 && p <= 1.0)
        {
          greatest = std::max(greatest, marginAt(vector, set, {p, 1.0 - p}));
        }
      }
    }
    const Margin margin = marginOver(vector, pointers(set));
    EXPECT_NEAR(margin.lower, greatest, 1e-10) << "round " << round;
    EXPECT_NEAR(margin.upper, greatest, 1e-10) << "round " << round;
  }
}

TEST(Domination, BothSidesMeetAndHoldAtBeliefs)
{
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int round = 0; round < 200; ++round)
  {
    const std::size_t size = 2 + random() % 10;
    const double scale = round % 3 == 0 ? 1e-3 : round % 3 == 1 ? 1.0 : 1e4;
    Vectors set(1 + random() % 40, std::vector<double>(size));
    std::vector<double> vector(size);
    std::generate(vector.begin(), vector.end(), [&] { return scale * uniform(random); });
    for (std::vector<double>& other : set)
    {
      // Few different values, so that there are many ties.
      std::generate(other.begin(), other.end(),
                    [&] { return scale * static_cast<double>(random() % 4) / 4.0; });
    }
    const Margin margin = marginOver(vector, pointers(set));
    EXPECT_LE(margin.lower, margin.upper + 1e-13 * scale);
    EXPECT_NEAR(margin.lower, margin.upper, 1e-9 * scale) << "round " << round;
    EXPECT_NEAR(marginAt(vector, set, margin.belief), margin.lower, 1e-12 * scale);
    for (int i = 0; i < 50; ++i)
    {
      const Belief belief = test::randomBelief(size, random);
      EXPECT_LE(marginAt(vector, set, belief.probabilities()), margin.upper + 1e-12 * scale);
    }
  }
}

TEST(Domination, AThresholdDecidesAlike)
{
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int round = 0; round < 300; ++round)
  {
    const std::size_t size = 2 + random() % 6;
    Vectors set(1 + random() % 10, std::vector<double>(size));
    std::vector<double> vector(size);
    std::generate(vector.begin(), vector.end(), [&] { return uniform(random); });
    for (std::vector<double>& other : set)
    {
      std::generate(other.begin(), other.end(), [&] { return uniform(random); });
    }
    const bool above = marginOver(vector, pointers(set)).lower > 0.01;
    const Margin margin = marginOver(vector, pointers(set), 0.01);
    EXPECT_EQ(margin.lower > 0.01, above);
    EXPECT_EQ(margin.upper <= 0.01, !above);
  }
}

TEST(Domination, NothingToBeatIsBeatenAnywhere)
{
  const Margin margin = marginOver({1.0, 2.0}, {});
  EXPECT_EQ(margin.lower, std::numeric_limits<double>::infinity());
  EXPECT_EQ(margin.belief.size(), 2U);
}

}  // namespace
}  // namespace kr3::pomdp
