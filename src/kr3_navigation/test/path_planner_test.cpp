#include "kr3_navigation/path_planner.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "synthetic_world.hpp"

namespace kr3::navigation
{
namespace
{

PathPlanner twoRoomsPlanner(double clearance_weight = 4.0)
{
  PathPlannerOptions options;
  options.clearance_weight = clearance_weight;
  return {SyntheticWorld::twoRooms().grid(kTwoRoomsArea), options};
}

/// A map of scattered obstacles.
OccupancyGrid scattered(std::mt19937_64& random)
{
  SyntheticWorld world;
  std::uniform_real_distribution<double> position(0.0, 8.0);
  for (int i = 0; i < 25; ++i)
  {
    const Point corner{position(random), position(random)};
    world.boxes.push_back({corner.x, corner.y, corner.x + 0.4, corner.y + 0.4});
  }
  return world.grid({0.0, 0.0, 8.0, 8.0});
}

Point randomFree(const PathPlanner& planner, std::mt19937_64& random)
{
  std::uniform_int_distribution<int> node(0, static_cast<int>(planner.geometry().size()) - 1);
  for (;;)
  {
    const int candidate = node(random);
    if (planner.isFree(candidate))
      return planner.geometry().center(candidate);
  }
}

TEST(PathPlanner, WithoutClearanceCostIsAsShortAsDijkstra)
{
  std::mt19937_64 random(7);
  for (int map = 0; map < 10; ++map)
  {
    PathPlannerOptions options;
    options.clearance_weight = 0.0;
    const PathPlanner planner(scattered(random), options);
    const Point start = randomFree(planner, random);
    const std::vector<double> lengths = planner.distancesFrom(start);
    for (int i = 0; i < 20; ++i)
    {
      const Point goal = randomFree(planner, random);
      const double shortest = lengths[static_cast<std::size_t>(planner.geometry().index(goal))];
      const PlannedPath path = planner.plan(start, goal);
      if (shortest == std::numeric_limits<double>::infinity())
      {
        EXPECT_FALSE(path.found());
        EXPECT_FALSE(path.reason.empty());
        continue;
      }
      ASSERT_TRUE(path.found()) << path.reason;
      EXPECT_NEAR(path.length_m, shortest, 1e-9);
      EXPECT_NEAR(path.cost, shortest, 1e-9);
    }
  }
}

TEST(PathPlanner, NeverPassesThroughInflatedObstacles)
{
  std::mt19937_64 random(8);
  for (int map = 0; map < 10; ++map)
  {
    const OccupancyGrid grid = scattered(random);
    const PathPlanner planner(grid, PathPlannerOptions{});
    for (int i = 0; i < 20; ++i)
    {
      const PlannedPath path =
          planner.plan(randomFree(planner, random), randomFree(planner, random));
      for (const Point& point : path.points)
      {
        // The law itself, checked against every obstacle of the map.
        for (std::size_t node = 0; node < grid.nodes.size(); ++node)
        {
          if (grid.nodes[node] == Occupancy::kOccupied)
          {
            ASSERT_GE(distance(point, grid.geometry.center(static_cast<int>(node))), 0.28 - 1e-6);
          }
        }
      }
    }
  }
}

TEST(PathPlanner, GoesThroughTheMiddleOfTheDoor)
{
  const PlannedPath path = twoRoomsPlanner().plan({2.0, 3.0}, {6.0, 3.0});
  ASSERT_TRUE(path.found());
  EXPECT_DOUBLE_EQ(path.points.front().x, 2.0);
  EXPECT_DOUBLE_EQ(path.points.back().x, 6.0);
  for (const Point& point : path.points)
  {
    if (std::abs(point.x - 4.0) < 0.06)
    {
      EXPECT_NEAR(point.y, 2.0, 0.2);
    }
  }
}

TEST(PathPlanner, SaysWhyThereIsNoPath)
{
  const PathPlanner planner = twoRoomsPlanner();
  EXPECT_NE(planner.plan({2.0, 2.0}, {50.0, 2.0}).reason.find("outside the map"),
            std::string::npos);
  EXPECT_NE(planner.plan({2.0, 2.0}, {1.0, 0.8}).reason.find("from an obstacle"),
            std::string::npos);

  SyntheticWorld closed = SyntheticWorld::twoRooms();
  closed.boxes.push_back({3.95, 1.4, 4.05, 2.6});
  const PathPlanner shut(closed.grid(kTwoRoomsArea), PathPlannerOptions{});
  EXPECT_NE(shut.plan({2.0, 2.0}, {6.0, 2.0}).reason.find("no free path"), std::string::npos);
}

/// What a laser hits of a door of the two rooms that is narrowed to y_low..y_high.
std::vector<Point> jambs(double y_low, double y_high)
{
  std::vector<Point> hits;
  for (double y = 0.0; y < 4.0; y += 0.04)
  {
    if (y > y_low && y < y_high)
      continue;
    hits.push_back({3.95, y});
    hits.push_back({4.05, y});
  }
  for (const double x : {3.95, 4.0, 4.05})
  {
    hits.push_back({x, y_low});
    hits.push_back({x, y_high});
  }
  return hits;
}

TEST(PathPlanner, ACloserLookFindsTheGapThatAThickenedMapHides)
{
  SyntheticWorld thickened = SyntheticWorld::twoRooms();
  thickened.boxes.push_back({3.9, 1.5, 4.1, 1.7});
  thickened.boxes.push_back({3.9, 2.3, 4.1, 2.5});
  const OccupancyGrid grid = thickened.grid(kTwoRoomsArea);
  const PathPlannerOptions options;
  const Point start{3.0, 2.0};
  const Point goal{6.0, 2.0};
  PathPlannerOptions wide = options;
  wide.inflation_radius_m = 0.34;
  EXPECT_FALSE(PathPlanner(grid, wide).plan(start, goal).found());
  EXPECT_FALSE(PathPlanner(grid, wide, {}).plan(start, goal).found());  // nothing was seen there
  const std::vector<Point> hits = jambs(1.6, 2.4);
  const PathPlanner close(grid, wide, hits);
  const PlannedPath path = close.plan(start, goal);
  ASSERT_TRUE(path.found()) << path.reason;
  for (const Point& p : path.points)
  {
    for (const Point& hit : hits)
      EXPECT_GE(distance(p, hit), wide.inflation_radius_m - 1e-6);
  }
}

TEST(PathPlanner, ACloserLookSeesThatAGapIsTooNarrow)
{
  const OccupancyGrid grid = SyntheticWorld::twoRooms().grid(kTwoRoomsArea);
  const PathPlannerOptions options;
  EXPECT_TRUE(PathPlanner(grid, options).plan({3.0, 2.0}, {6.0, 2.0}).found());
  EXPECT_FALSE(PathPlanner(grid, options, jambs(1.75, 2.3)).plan({3.0, 2.0}, {6.0, 2.0}).found());
}

TEST(PathPlanner, LeadsOutOfTheInflation)
{
  const PathPlanner planner = twoRoomsPlanner();
  const Point start{2.0, 0.15};  // 0.2 m from the wall's nodes
  ASSERT_FALSE(planner.isFree(start));
  const PlannedPath path = planner.plan(start, {2.0, 2.0});
  ASSERT_TRUE(path.found()) << path.reason;
  EXPECT_LT(distance(path.points[1], start), 0.3);
  EXPECT_TRUE(planner.isFree(path.points[1]));
}

TEST(PathPlanner, UnknownSpaceIsBlockedUnlessAMapIsBuilt)
{
  OccupancyGrid grid = SyntheticWorld::twoRooms().grid(kTwoRoomsArea);
  for (std::size_t node = 0; node < grid.nodes.size(); ++node)
  {
    if (grid.geometry.center(static_cast<int>(node)).x > 5.0)
      grid.nodes[node] = Occupancy::kUnknown;
  }
  PathPlannerOptions options;
  EXPECT_FALSE(PathPlanner(grid, options).plan({2.0, 2.0}, {6.0, 2.0}).found());
  options.unknown_is_free = true;
  EXPECT_TRUE(PathPlanner(grid, options).plan({2.0, 2.0}, {6.0, 2.0}).found());
}

TEST(PathPlanner, KnowsThatFarPointsAreOutside)
{
  const PathPlanner planner(SyntheticWorld::twoRooms().grid(kTwoRoomsArea), PathPlannerOptions{});
  for (const double far : {1e6, 1e12, 1e300, -1e300, std::numeric_limits<double>::infinity(),
                           std::numeric_limits<double>::quiet_NaN()})
  {
    EXPECT_FALSE(planner.isFree(Point{far, 1.0})) << far;
    EXPECT_EQ(planner.clearance({1.0, far}), 0.0) << far;
    const PlannedPath path = planner.plan({2.0, 2.0}, {far, 2.0});
    EXPECT_FALSE(path.found()) << far;
    EXPECT_NE(path.reason.find("outside the map"), std::string::npos) << path.reason;
  }
}

}  // namespace
}  // namespace kr3::navigation
