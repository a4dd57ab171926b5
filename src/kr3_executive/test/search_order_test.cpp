// In which order hypotheses are tested: against all orders where they are few.

#include "search_order.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace kr3::executive
{
namespace
{

/// Points of a plane; testing one takes the way there and a second, the way back is the rest.
struct Points
{
  std::vector<double> x, y, probability;
  double detection = 0.8;

  explicit Points(std::size_t count, std::uint64_t seed)
  {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> draw(0.1, 10.0);
    for (std::size_t i = 0; i < count; ++i)
    {
      x.push_back(draw(random));
      y.push_back(draw(random));
      probability.push_back(3.0 + draw(random));
    }
    const double total = std::accumulate(probability.begin(), probability.end(), 0.0);
    for (double& share : probability)
      share /= total;
  }

  [[nodiscard]] double distance(std::size_t a, std::size_t b) const
  {
    return std::hypot(x[a] - x[b], y[a] - y[b]);
  }

  [[nodiscard]] ProspectOf prospects() const
  {
    return [this](std::size_t from, std::size_t hypothesis) -> std::optional<Prospect> {
      return Prospect{distance(from, hypothesis) + 1.0, distance(hypothesis, 0), detection,
                      hypothesis};
    };
  }

  /// By its definition: what is missed in a round takes further rounds as long.
  [[nodiscard]] double expectedCost(const std::vector<std::size_t>& order) const
  {
    double unseen = 1.0;
    double cost_s = 0.0;
    double round_s = 0.0;
    std::size_t at = 0;
    for (const std::size_t next : order)
    {
      const double test_s = distance(at, next) + 1.0;
      const double found = probability[next] * detection;
      cost_s += unseen * test_s + found * distance(next, 0);
      round_s += test_s;
      unseen -= found;
      at = next;
    }
    return cost_s + unseen / (1.0 - unseen) * round_s;
  }

  [[nodiscard]] double leastCost() const
  {
    std::vector<std::size_t> order(x.size());
    std::iota(order.begin(), order.end(), 0);
    double least = expectedCost(order);
    while (std::next_permutation(order.begin(), order.end()))
      least = std::min(least, expectedCost(order));
    return least;
  }
};

TEST(SearchOrder, TellsWhatItsOrderCosts)
{
  for (std::uint64_t seed = 1; seed <= 20; ++seed)
  {
    const Points points(12, seed);
    const auto found = orderOfTests(points.probability, 0, points.prospects(), {});
    ASSERT_TRUE(found);
    EXPECT_EQ(found->order.size(), 12U);
    EXPECT_NEAR(found->expected_s, points.expectedCost(found->order), 1e-9);
  }
}

TEST(SearchOrder, IsNearTheBestOfAllOrders)
{
  double greedy_more = 0.0;
  double more = 0.0;
  constexpr int kCases = 20;
  for (std::uint64_t seed = 1; seed <= kCases; ++seed)
  {
    const Points points(7, seed);
    const double least_s = points.leastCost();
    const auto greedy = orderOfTests(points.probability, 0, points.prospects(), {1, 1});
    const auto found = orderOfTests(points.probability, 0, points.prospects(), {8, 100000});
    EXPECT_GE(found->expected_s, least_s - 1e-9);
    EXPECT_LE(found->expected_s, greedy->expected_s + 1e-9);
    greedy_more += greedy->expected_s / least_s - 1.0;
    more += found->expected_s / least_s - 1.0;
  }
  EXPECT_LT(more / kCases, 0.03);
  EXPECT_LT(more, greedy_more / 2.0);
}

TEST(SearchOrder, StaysWithinItsWork)
{
  const Points points(60, 3);
  const auto greedy = orderOfTests(points.probability, 0, points.prospects(), {1, 1});
  for (const std::uint64_t limit : {5000U, 20000U, 100000U})
  {
    const auto found = orderOfTests(points.probability, 0, points.prospects(), {8, limit});
    // One change under way is finished.
    EXPECT_LE(found->prospects, std::max<std::uint64_t>(limit, greedy->prospects) + 60 * 60);
    EXPECT_LE(found->expected_s, greedy->expected_s + 1e-9);
  }
}

// An order of before is taken up where it is better than what little work finds.
TEST(SearchOrder, ContinuesAnOrderFoundBefore)
{
  Points points(40, 5);
  std::fill(points.probability.begin(), points.probability.end(), 1.0 / 40.0);
  const auto good = orderOfTests(points.probability, 0, points.prospects(), {8, 1000000});
  const auto again = orderOfTests(points.probability, 0, points.prospects(), {1, 1}, good->order);
  EXPECT_NEAR(again->expected_s, good->expected_s, 1e-9);
  std::vector<std::size_t> odd = good->order;
  odd.erase(odd.begin() + 3);
  odd.push_back(99);  // no longer a hypothesis
  EXPECT_TRUE(orderOfTests(points.probability, 0, points.prospects(), {1, 1}, odd));
}

TEST(SearchOrder, IsEmptyHandedWhereNothingCanBeTested)
{
  const ProspectOf none = [](std::size_t, std::size_t) { return std::nullopt; };
  EXPECT_FALSE(orderOfTests({0.5, 0.5}, 0, none, {}));
  // One that cannot be tested is left out.
  const ProspectOf second = [](std::size_t, std::size_t hypothesis) {
    return hypothesis == 1 ? std::optional(Prospect{1.0, 1.0, 0.9, 1}) : std::nullopt;
  };
  EXPECT_EQ(orderOfTests({0.5, 0.5}, 0, second, {})->order, std::vector<std::size_t>{1});
}

}  // namespace
}  // namespace kr3::executive
