#include "kr3_navigation/movable_nodes.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "synthetic_world.hpp"

namespace kr3::navigation
{
namespace
{

const std::vector<Place> kRooms{{"left", {-0.05, -0.05, 4.0, 4.05}},
                                {"right", {4.0, -0.05, 8.05, 4.05}}};

TEST(MovableNodes, TellsATableFromTheWallsAroundIt)
{
  const DistanceField field = distanceField(SyntheticWorld::twoRooms().grid(kTwoRoomsArea));
  const std::vector<char> movable = movableNodes(field, kRooms);
  const auto at = [&](Point p) {
    return static_cast<int>(movable[static_cast<std::size_t>(field.geometry.index(p))]);
  };
  EXPECT_EQ(at({1.25, 0.85}), 1);  // on the table
  EXPECT_EQ(at({1.25, 1.35}), 1);  // beside it
  EXPECT_EQ(at({0.05, 2.0}), 0);   // at the outer wall
  EXPECT_EQ(at({4.0, 1.0}), 0);    // on the wall between the rooms
  EXPECT_EQ(at({6.0, 3.0}), 0);    // in the empty room
}

TEST(MovableNodes, KnowsNothingWithoutPlaces)
{
  const DistanceField field = distanceField(SyntheticWorld::twoRooms().grid(kTwoRoomsArea));
  const std::vector<char> movable = movableNodes(field, {});
  EXPECT_EQ(movable.size(), field.distance_m.size());
  EXPECT_EQ(std::count(movable.begin(), movable.end(), 1), 0);
}

}  // namespace
}  // namespace kr3::navigation
