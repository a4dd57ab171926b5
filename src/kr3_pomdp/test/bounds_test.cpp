#include <algorithm>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "packed_belief.hpp"
#include "sawtooth_set.hpp"
#include "vector_set.hpp"

namespace kr3::pomdp
{
namespace
{

using Numbers = std::vector<double>;

double uniform(std::mt19937_64& random)
{
  return static_cast<double>(random() >> 11U) * 0x1.0p-53;
}

/// Some zeros.
Numbers randomBelief(std::size_t size, std::mt19937_64& random)
{
  Numbers belief(size, 0.0);
  double sum = 0.0;
  for (double& p : belief)
  {
    p = uniform(random) < 0.6 ? uniform(random) : 0.0;
    sum += p;
  }
  if (sum == 0.0)
  {
    belief.front() = sum = 1.0;
  }
  for (double& p : belief)
  {
    p /= sum;
  }
  return belief;
}

UnpackedBelief unpacked(const Numbers& belief)
{
  UnpackedBelief result;
  result.reset(belief.size());
  for (std::size_t s = 0; s < belief.size(); ++s)
  {
    if (belief[s] > 0.0)
    {
      result.add(s, belief[s]);
    }
  }
  result.finish(1.0);
  return result;
}

double dotOf(const Numbers& a, const Numbers& b)
{
  double sum = 0.0;
  for (std::size_t s = 0; s < a.size(); ++s)
  {
    sum += a[s] * b[s];
  }
  return sum;
}

TEST(PackedBelief, KeepsTheBlocksThatAreNotZero)
{
  Numbers belief(40, 0.0);
  belief[3] = 0.25;
  belief[33] = 0.75;
  const UnpackedBelief long_one = unpacked(belief);
  ASSERT_EQ(long_one.packed().num_blocks, 2U);
  EXPECT_EQ(long_one.packed().blocks[0], 0U);
  EXPECT_EQ(long_one.packed().blocks[1], 4U);
  Numbers values(40);
  for (std::size_t s = 0; s < values.size(); ++s)
  {
    values[s] = static_cast<double>(s);
  }
  EXPECT_DOUBLE_EQ(dot(long_one.packed(), values.data()), 0.25 * 3.0 + 0.75 * 33.0);
  std::mt19937_64 random(1);
  UnpackedBelief used = unpacked(randomBelief(9, random));
  used.assign(40, long_one.packed());
  EXPECT_TRUE(std::equal(belief.begin(), belief.end(), used.values()));
}

TEST(VectorSet, GivesTheGreatestOfAllThatWereAdded)
{
  std::mt19937_64 random(4);
  for (const std::size_t size : {1U, 3U, 16U, 37U})
  {
    VectorSet set(size);
    std::vector<Numbers> all;
    std::vector<std::uint32_t> numbers;
    for (int i = 0; i < 300; ++i)
    {
      Numbers vector(size);
      const double level = uniform(random);  // some dominate others everywhere
      for (double& value : vector)
      {
        value = level + 0.5 * uniform(random);
      }
      numbers.push_back(set.add(static_cast<std::uint32_t>(i), vector));
      all.push_back(vector);
    }
    EXPECT_LT(set.numAlive(), all.size());
    for (std::size_t i = 0; i < all.size(); ++i)
    {
      const double* stands_for = set.values(set.living(numbers[i]));
      for (std::size_t s = 0; s < size; ++s)
      {
        EXPECT_GE(stands_for[s], all[i][s]);
      }
    }
    for (int i = 0; i < 50; ++i)
    {
      const Numbers belief = randomBelief(size, random);
      double greatest = -std::numeric_limits<double>::infinity();
      for (const Numbers& vector : all)
      {
        greatest = std::max(greatest, dotOf(belief, vector));
      }
      const VectorSet::Best best =
          set.best(unpacked(belief).packed(), 0, {-std::numeric_limits<double>::infinity(), 0});
      EXPECT_NEAR(best.value, greatest, 1e-12);
      EXPECT_TRUE(set.isAlive(best.vector));
    }
  }
}

TEST(VectorSet, FreesWhatIsDead)
{
  VectorSet set(100);
  for (int i = 0; i < 1000; ++i)
  {
    (void)set.add(0, Numbers(100, static_cast<double>(i)));
  }
  EXPECT_EQ(set.numAlive(), 1U);
  EXPECT_LT(set.sizeInBytes(), 100U * 104U * sizeof(double));
}

TEST(SawtoothSet, InterpolatesAsDefined)
{
  std::mt19937_64 random(5);
  for (const std::size_t size : {2U, 9U, 30U, 100U})
  {
    Numbers corners(size);
    std::generate(corners.begin(), corners.end(), [&random] { return 1.0 + uniform(random); });
    SawtoothSet set(corners);
    std::vector<Numbers> beliefs;
    std::vector<double> gains;
    std::vector<UnpackedBelief> kept(250);
    std::vector<std::uint32_t> numbers;
    for (UnpackedBelief& place : kept)
    {
      beliefs.push_back(randomBelief(size, random));
      place = unpacked(beliefs.back());
      const double value = dotOf(beliefs.back(), corners) - uniform(random) + 0.2;
      gains.push_back(std::min(0.0, value - dotOf(beliefs.back(), corners)));
      numbers.push_back(set.add(place, place.packed(), value));
      if (numbers.size() % 3 == 0)
      {
        set.remove(numbers[numbers.size() / 2]);
        gains[numbers.size() / 2] = 0.0;
      }
    }
    for (int i = 0; i < 100; ++i)
    {
      const Numbers belief = randomBelief(size, random);
      double least = 0.0;
      for (std::size_t p = 0; p < beliefs.size(); ++p)
      {
        double ratio = 1.0;
        for (std::size_t s = 0; s < size; ++s)
        {
          ratio = beliefs[p][s] > 0.0 ? std::min(ratio, belief[s] / beliefs[p][s]) : ratio;
        }
        least = std::min(least, ratio * gains[p]);
      }
      EXPECT_NEAR(set.value(unpacked(belief), 0, 100.0), dotOf(belief, corners) + least, 1e-5);
      EXPECT_GE(set.value(unpacked(belief), 0, 100.0), dotOf(belief, corners) + least - 1e-12);
      EXPECT_NEAR(set.value(unpacked(belief), 0, -1.0), -1.0, 1e-12);
    }
  }
}

}  // namespace
}  // namespace kr3::pomdp
