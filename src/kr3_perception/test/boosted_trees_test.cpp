#include "kr3_perception/boosted_trees.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

namespace kr3::perception
{
namespace
{

struct Samples
{
  std::vector<std::vector<double>> evidence;
  std::vector<bool> truth;
  std::vector<int> group;
};

/// Samples of which the probability of "right" is known.
template <typename Probability>
Samples draw(int count, std::uint64_t seed, Probability probability)
{
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Samples samples;
  for (int i = 0; i < count; ++i)
  {
    samples.evidence.push_back({uniform(random), uniform(random), uniform(random)});
    samples.truth.push_back(0.5 * (uniform(random) + 1.0) < probability(samples.evidence.back()));
    samples.group.push_back(i / 4);
  }
  return samples;
}

TEST(BoostedTrees, LearnsProbabilitiesThatNoLinearModelCan)
{
  const auto truth = [](const std::vector<double>& x) { return x[0] * x[1] > 0.0 ? 0.9 : 0.2; };
  const Samples samples = draw(6000, 1, truth);
  const BoostedTrees trees = fitBoostedTrees(samples.evidence, samples.truth, samples.group);
  double error = 0.0;
  const Samples fresh = draw(1000, 2, truth);
  for (const std::vector<double>& x : fresh.evidence)
    error += std::abs(trees.probability(x) - truth(x)) / 1000.0;
  EXPECT_LT(error, 0.06);
}

TEST(BoostedTrees, SaysTheShareWhereNothingCanBeLearned)
{
  const Samples samples = draw(4000, 3, [](const std::vector<double>&) { return 0.3; });
  const BoostedTrees trees = fitBoostedTrees(samples.evidence, samples.truth, samples.group);
  for (const std::vector<double>& x : draw(200, 4, [](const auto&) { return 0.5; }).evidence)
    EXPECT_NEAR(trees.probability(x), 0.3, 0.1);
}

TEST(BoostedTrees, SurvivesSamplesOfOneKind)
{
  const Samples samples = draw(50, 5, [](const std::vector<double>&) { return 2.0; });
  const BoostedTrees trees = fitBoostedTrees(samples.evidence, samples.truth, samples.group);
  const double p = trees.probability({0.0, 0.0, 0.0});
  EXPECT_GT(p, 0.9);
  EXPECT_LT(p, 1.0);
}

TEST(BoostedTrees, FitsTheSameTwice)
{
  const Samples samples =
      draw(500, 6, [](const std::vector<double>& x) { return x[2] > 0 ? 0.8 : 0.1; });
  const BoostedTrees a = fitBoostedTrees(samples.evidence, samples.truth, samples.group);
  const BoostedTrees b = fitBoostedTrees(samples.evidence, samples.truth, samples.group);
  for (const std::vector<double>& x : samples.evidence)
    EXPECT_EQ(a.probability(x), b.probability(x));
}

TEST(BoostedTrees, RejectsBadSamplesAndTrees)
{
  EXPECT_THROW((void)fitBoostedTrees({}, {}, {}), InvalidArgument);
  EXPECT_THROW((void)fitBoostedTrees({{1.0}}, {true, false}, {0}), InvalidArgument);
  EXPECT_THROW((void)fitBoostedTrees({{1.0}, {1.0, 2.0}}, {true, false}, {0, 1}), InvalidArgument);
  EXPECT_THROW((void)fitBoostedTrees({{NAN}, {1.0}}, {true, false}, {0, 1}), InvalidArgument);
  EXPECT_THROW(BoostedTrees(1, 0.0, {{}}), InvalidArgument);
  EXPECT_THROW(BoostedTrees(1, NAN, {}), InvalidArgument);
  EXPECT_THROW(BoostedTrees(1, 0.0, {{{0, 0.5, 0, 0, 0.0}}}), InvalidArgument);  // a loop
  EXPECT_THROW(BoostedTrees(1, 0.0, {{{3, 0.5, 1, 2, 0.0}, {}, {}}}), InvalidArgument);
  EXPECT_THROW((void)BoostedTrees(2, 0.0, {}).probability({1.0}), InvalidArgument);
}

}  // namespace
}  // namespace kr3::perception
