#include "kr3_common/nearest_name.hpp"

#include <gtest/gtest.h>

namespace kr3
{
namespace
{

TEST(NearestName, CountsEdits)
{
  EXPECT_EQ(editDistance("", "abc"), 3U);
  EXPECT_EQ(editDistance("kitchen", "kitchen"), 0U);
  EXPECT_EQ(editDistance("kitten", "sitting"), 3U);  // the usual textbook pair
  EXPECT_EQ(editDistance("sitting", "kitten"), 3U);
}

TEST(NearestName, IsExactUpToTheLimitAndAboveItBeyond)
{
  for (std::size_t limit = 0; limit < 6; ++limit)
  {
    const std::size_t distance = editDistance("kitten", "sitting", limit);
    if (limit < 3)
    {
      EXPECT_GT(distance, limit);
    }
    else
    {
      EXPECT_EQ(distance, 3U);
    }
  }
}

TEST(NearestName, TakesTheFirstOfTheNearest)
{
  const std::vector<std::string> names = {"office", "offices", "kitchen", "offic"};
  ASSERT_NE(nearestName("ofice", names), nullptr);
  EXPECT_EQ(*nearestName("ofice", names), "office");
  EXPECT_EQ(nearestName("kitchen", names), &names[2]);
  EXPECT_EQ(nearestName("printer", names, 2), nullptr);
  EXPECT_NE(nearestName("printer", names), nullptr);  // without a limit the least bad one
  EXPECT_EQ(nearestName("office", {}), nullptr);
}

}  // namespace
}  // namespace kr3
