#include "logistic.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

namespace kr3::perception
{
namespace
{

TEST(Logistic, RecoversTheShareOfTruthsWhenThereIsNoEvidence)
{
  // Known answer: with the intercept alone the fitted probability is the share of truths, 3 of 4.
  const std::vector<double> weights =
      fitLogistic({{1.0}, {1.0}, {1.0}, {1.0}}, {true, true, true, false}, 1e-6);
  EXPECT_NEAR(logistic(weights, {1.0}), 0.75, 1e-3);
}

TEST(Logistic, RecoversTheWeightsThatMadeTheData)
{
  const std::vector<double> truth_weights{-0.5, 2.0, -1.0};
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<std::vector<double>> evidence;
  std::vector<bool> truth;
  for (int i = 0; i < 20000; ++i)
  {
    evidence.push_back({1.0, uniform(random), uniform(random)});
    truth.push_back(0.5 * (uniform(random) + 1.0) < logistic(truth_weights, evidence.back()));
  }
  const std::vector<double> weights = fitLogistic(evidence, truth, 1e-3);
  for (std::size_t i = 0; i < weights.size(); ++i)
    EXPECT_NEAR(weights[i], truth_weights[i], 0.12) << i;
}

TEST(Logistic, StaysFiniteOnSeparableData)
{
  const std::vector<double> weights = fitLogistic({{1.0, -1.0}, {1.0, 1.0}}, {false, true}, 1e-2);
  EXPECT_TRUE(std::isfinite(weights[1]));
  EXPECT_GT(logistic(weights, {1.0, 1.0}), 0.9);
}

TEST(Logistic, RejectsShapesThatDiffer)
{
  EXPECT_THROW((void)logistic({1.0}, {1.0, 2.0}), InvalidArgument);
  EXPECT_THROW((void)fitLogistic({{1.0}}, {true, false}, 1e-2), InvalidArgument);
  EXPECT_THROW((void)fitLogistic({{1.0}, {1.0, 2.0}}, {true, false}, 1e-2), InvalidArgument);
}

}  // namespace
}  // namespace kr3::perception
