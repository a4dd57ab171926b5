#include "kr3_navigation/live_map.hpp"

#include <gtest/gtest.h>

#include "synthetic_world.hpp"

namespace kr3::navigation
{
namespace
{

class LiveMapTest : public ::testing::Test
{
protected:
  LiveMap build()
  {
    LiveMap map(OccupancyMap(OccupancyMapOptions{}), false, kTwoRoomsArea, LiveMapOptions{});
    for (double x = 0.5; x < 7.5; x += 0.2)
      map.insertScan(world_.scan({x, 2.0, 0.3 * x}, random_), {x, 2.0, 0.3 * x}, 0.3);
    EXPECT_TRUE(map.revise());
    return map;
  }

  SyntheticWorld world_ = SyntheticWorld::twoRooms();
  std::mt19937_64 random_{1};
};

TEST_F(LiveMapTest, AnObstacleBlocksTheWayAndLeavesIt)
{
  const Pose pose{3.0, 2.0, 0.0};
  LiveMap map(build().map().copy(), true, kTwoRoomsArea, LiveMapOptions{});
  ASSERT_TRUE(map.planner().plan(pose.position(), {6.0, 2.0}).found());
  const std::vector<Rectangle> open = world_.boxes;
  world_.boxes.push_back({3.95, 1.5, 4.05, 2.5});  // the door shuts
  for (int i = 0; i < 3; ++i)
    map.insertScan(world_.scan(pose, random_), pose, 0.3);
  EXPECT_TRUE(map.revise());
  EXPECT_FALSE(map.planner().plan(pose.position(), {6.0, 2.0}).found());

  world_.boxes = open;
  for (int i = 0; i < 25; ++i)
    map.insertScan(world_.scan(pose, random_), pose, 0.3);
  EXPECT_TRUE(map.revise());
  EXPECT_TRUE(map.planner().plan(pose.position(), {6.0, 2.0}).found());
  EXPECT_FALSE(map.revise());
}

TEST_F(LiveMapTest, ForgetsRevisionsOfAGivenMapOnly)
{
  const Pose pose{3.0, 2.0, 0.0};
  LiveMap built = build();
  LiveMap map(built.map().copy(), true, kTwoRoomsArea, LiveMapOptions{});
  world_.boxes.push_back({3.95, 1.5, 4.05, 2.5});
  for (LiveMap* each : {&map, &built})
  {
    for (int i = 0; i < 20; ++i)
      each->insertScan(world_.scan(pose, random_), pose, 0.3);
    (void)each->revise();
    each->forgetRevisions();
  }
  EXPECT_TRUE(map.planner().plan(pose.position(), {6.0, 2.0}).found());
  EXPECT_FALSE(built.planner().isFree(Point{4.0, 2.0}));
}

TEST_F(LiveMapTest, AContactStaysThoughBeamsPassOverItUntilItIsOld)
{
  const Pose pose{3.0, 2.0, 0.0};
  const Point touched{6.0, 2.05};
  LiveMap map(build().map().copy(), true, kTwoRoomsArea, LiveMapOptions{});
  ASSERT_TRUE(map.planner().isFree(touched));
  map.addContact(touched, 10.0);
  map.addContact({1e6, 1e300}, 10.0);
  EXPECT_TRUE(map.revise());
  EXPECT_FALSE(map.revise());
  EXPECT_FALSE(map.planner().isFree(touched));
  EXPECT_TRUE(map.planner().plan(pose.position(), {7.2, 2.0}).found());
  EXPECT_FALSE(map.planner().isSegmentFree({5.0, 2.0}, {7.0, 2.0}));
  for (int i = 0; i < 50; ++i)
    map.insertScan(world_.scan(pose, random_), pose, 0.3);
  map.forgetOldContacts(60.0);
  (void)map.revise();
  EXPECT_FALSE(map.planner().isFree(touched));
  map.forgetOldContacts(10.0 + 1.1 * LiveMapOptions{}.contact_memory_s);
  EXPECT_TRUE(map.revise());
  EXPECT_TRUE(map.planner().isFree(touched));

  map.addContact(touched, 1000.0);
  map.forgetOldContacts(2.0);  // the clock started again
  (void)map.revise();
  EXPECT_TRUE(map.planner().isFree(touched));
  map.addContact(touched, 10.0);
  map.forgetRevisions();
  EXPECT_TRUE(map.planner().isFree(touched));
}

}  // namespace
}  // namespace kr3::navigation
