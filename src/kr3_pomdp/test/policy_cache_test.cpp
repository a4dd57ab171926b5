#include "kr3_pomdp/policy_cache.hpp"

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "support/models.hpp"

namespace kr3::pomdp
{
namespace
{

SolvedModel solved()
{
  SolverLimits limits;
  limits.max_backups = 1;
  const Model model = test::tiger();
  return {"key", model, solve(model, limits)};
}

std::size_t sizeOfOne()
{
  PolicyCache cache(1 << 20);
  cache.put("a", solved());
  return cache.sizeInBytes();
}

TEST(PolicyCache, TheOneUsedLongestAgoGoesFirst)
{
  PolicyCache cache(2 * sizeOfOne() + sizeOfOne() / 2);
  cache.put("a", solved());
  cache.put("b", solved());
  EXPECT_TRUE(cache.find("a"));
  cache.put("c", solved());
  EXPECT_TRUE(cache.find("a"));
  EXPECT_FALSE(cache.find("b"));
  EXPECT_TRUE(cache.find("c"));
  EXPECT_EQ(cache.size(), 2U);
  EXPECT_LE(cache.sizeInBytes(), cache.maxBytes());
}

TEST(PolicyCache, AnEntryInUseOutlivesItsEviction)
{
  PolicyCache cache(sizeOfOne() + sizeOfOne() / 2);
  cache.put("a", solved());
  const auto held = cache.find("a");
  cache.put("b", solved());
  EXPECT_FALSE(cache.find("a"));
  EXPECT_EQ(held->model.numStates(), 2U);
}

TEST(PolicyCache, PuttingTwiceReplaces)
{
  PolicyCache cache(1 << 20);
  cache.put("a", solved());
  const std::size_t bytes = cache.sizeInBytes();
  cache.put("a", solved());
  EXPECT_EQ(cache.size(), 1U);
  EXPECT_EQ(cache.sizeInBytes(), bytes);
}

TEST(PolicyCache, RefusesWhatIsTooLarge)
{
  PolicyCache cache(10);
  EXPECT_THROW(cache.put("a", solved()), ResourceExhausted);
  EXPECT_EQ(cache.size(), 0U);
  EXPECT_THROW(PolicyCache(0), InvalidArgument);
}

TEST(ContentHash, DiffersWhereTextsDo)
{
  EXPECT_EQ(contentHash("a").size(), 32U);
  EXPECT_EQ(contentHash("a"), contentHash("a"));
  EXPECT_NE(contentHash("a"), contentHash("b"));
  EXPECT_NE(contentHash(""), contentHash("a"));
}

}  // namespace
}  // namespace kr3::pomdp
