#include "kr3_navigation/cells.hpp"

#include <limits>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "synthetic_world.hpp"

namespace kr3::navigation
{
namespace
{

const std::vector<Place> kPlaces{{"left", {0.0, 0.0, 4.0, 4.0}}, {"right", {4.0, 0.0, 8.0, 4.0}}};

CellMap twoRoomsCells(const SyntheticWorld& world = SyntheticWorld::twoRooms())
{
  return {kPlaces, CellOptions{}, PathPlanner(world.grid(kTwoRoomsArea), PathPlannerOptions{})};
}

TEST(SplitIntoCells, CoversThePlaceExactlyOnce)
{
  const Rectangle place{1.0, 2.0, 6.0, 5.0};
  for (const int count : {1, 2, 4, 5, 6, 9})
  {
    const std::vector<Rectangle> cells = splitIntoCells(place, count);
    ASSERT_EQ(static_cast<int>(cells.size()), count);
    double area = 0.0;
    for (const Rectangle& cell : cells)
    {
      area += cell.width() * cell.height();
      EXPECT_GE(cell.x_min, place.x_min);
      EXPECT_LE(cell.y_max, place.y_max);
      int holders = 0;
      for (const Rectangle& other : cells)
        holders += other.contains(cell.center()) ? 1 : 0;
      EXPECT_EQ(holders, 1);
    }
    EXPECT_NEAR(area, place.width() * place.height(), 1e-9);
  }
}

TEST(SplitIntoCells, RefusesCountsThatAreNone)
{
  for (const int count : {-1, 0, 2000000000})
    EXPECT_THROW((void)splitIntoCells({0.0, 0.0, 4.0, 4.0}, count), InvalidArgument) << count;
}

TEST(SplitIntoCells, IsRowMajorAndSquarish)
{
  const std::vector<Rectangle> room = splitIntoCells({0.0, 0.0, 4.0, 4.0}, 4);
  EXPECT_DOUBLE_EQ(room[1].x_min, 2.0);  // c1 is right of c0
  EXPECT_DOUBLE_EQ(room[1].y_min, 0.0);
  EXPECT_DOUBLE_EQ(room[2].x_min, 0.0);  // c2 is above c0
  EXPECT_DOUBLE_EQ(room[2].y_min, 2.0);
  const std::vector<Rectangle> corridor = splitIntoCells({0.0, 0.0, 12.0, 2.0}, 4);
  EXPECT_DOUBLE_EQ(corridor[3].x_min, 9.0);
  EXPECT_DOUBLE_EQ(corridor[3].height(), 2.0);
}

TEST(CellMap, StandPointsAreFreeAndInsideTheirCells)
{
  const PathPlanner planner(SyntheticWorld::twoRooms().grid(kTwoRoomsArea), PathPlannerOptions{});
  const CellMap map = twoRoomsCells();
  for (const Cell& cell : map.cells())
  {
    EXPECT_TRUE(cell.reachable) << cell.name;
    EXPECT_TRUE(cell.rectangle.contains(cell.stand)) << cell.name;
    EXPECT_TRUE(planner.isFree(cell.stand)) << cell.name;
  }
}

TEST(CellMap, NeighborsAreSymmetricAndGoThroughTheDoor)
{
  const CellMap map = twoRoomsCells();
  ASSERT_EQ(map.cells().size(), 8U);
  const auto joined = [&](const std::string& a, const std::string& b) {
    const std::vector<std::size_t>& neighbors = map.cells()[*map.find(a)].neighbors;
    return std::find(neighbors.begin(), neighbors.end(), *map.find(b)) != neighbors.end();
  };
  for (const Cell& a : map.cells())
  {
    for (const Cell& b : map.cells())
      EXPECT_EQ(joined(a.name, b.name), joined(b.name, a.name)) << a.name << " " << b.name;
    EXPECT_FALSE(joined(a.name, a.name));
  }
  EXPECT_TRUE(joined("left_c0", "left_c1"));
  EXPECT_TRUE(joined("left_c0", "left_c2"));
  EXPECT_FALSE(joined("left_c0", "left_c3"));  // they touch at a corner only
  EXPECT_TRUE(joined("left_c1", "right_c0"));  // the door is at y 1.5 to 2.5
  EXPECT_TRUE(joined("left_c3", "right_c2"));
  EXPECT_FALSE(joined("left_c0", "right_c0"));
  EXPECT_FALSE(joined("left_c0", "right_c1"));
}

TEST(CellMap, TravelDistancesAreAMetric)
{
  const CellMap map = twoRoomsCells();
  const std::size_t n = map.cells().size();
  for (std::size_t a = 0; a < n; ++a)
  {
    EXPECT_EQ(map.travelDistance(a, a), 0.0);
    for (std::size_t b = 0; b < n; ++b)
    {
      EXPECT_EQ(map.travelDistance(a, b), map.travelDistance(b, a));
      EXPECT_GE(map.travelDistance(a, b),
                distance(map.cells()[a].stand, map.cells()[b].stand) - 1e-9);
      for (std::size_t c = 0; c < n; ++c)
        EXPECT_LE(map.travelDistance(a, c),
                  map.travelDistance(a, b) + map.travelDistance(b, c) + 1e-9);
    }
  }
}

TEST(CellMap, ACellWithoutFreeSpaceIsReportedAndUnreachable)
{
  SyntheticWorld world = SyntheticWorld::twoRooms();
  world.boxes.push_back({6.0, 2.0, 8.0, 4.0});
  const CellMap map = twoRoomsCells(world);
  const std::size_t full = *map.find("right_c3");
  EXPECT_FALSE(map.cells()[full].reachable);
  EXPECT_TRUE(map.cells()[full].neighbors.empty());
  EXPECT_EQ(map.travelDistance(full, 0), std::numeric_limits<double>::infinity());
  EXPECT_TRUE(map.cells()[*map.find("right_c2")].reachable);
}

TEST(CellMap, SaysWhichPlacesAreNotInTheMapOrFull)
{
  SyntheticWorld world = SyntheticWorld::twoRooms();
  world.boxes.push_back({0.0, 0.0, 2.0, 2.0});
  world.boxes.push_back({4.0, 0.0, 8.0, 4.0});
  const OccupancyGrid grid = world.grid(kTwoRoomsArea);
  const PathPlanner planner(grid, PathPlannerOptions{});
  std::vector<Place> places = kPlaces;
  places.push_back({"attic", {20.0, 0.0, 24.0, 4.0}});
  const CellMap map(places, CellOptions{}, planner);
  const std::vector<std::string> lines = describeUnreachable(map, places, grid);
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_EQ(lines[0], "the cell left_c0 has no free point that the robot can reach");
  EXPECT_EQ(lines[1], "the place right has no free point that the robot can reach");
  EXPECT_NE(lines[2].find("the place attic, x 20.0"), std::string::npos) << lines[2];
  EXPECT_NE(lines[2].find("is not in the map"), std::string::npos) << lines[2];

  const std::vector<Place> elsewhere{places.back()};
  const std::vector<std::string> none =
      describeUnreachable(CellMap(elsewhere, CellOptions{}, planner), elsewhere, grid);
  ASSERT_EQ(none.size(), 2U);
  EXPECT_NE(none[1].find("no cell of the building can be reached"), std::string::npos) << none[1];
  EXPECT_TRUE(
      describeUnreachable(twoRoomsCells(), kPlaces, SyntheticWorld::twoRooms().grid(kTwoRoomsArea))
          .empty());
}

TEST(CellMap, FindsTheCellOfAPoint)
{
  const CellMap map = twoRoomsCells();
  EXPECT_EQ(map.cells()[map.cellAt({1.0, 1.0})].name, "left_c0");
  EXPECT_EQ(map.cells()[map.cellAt({7.0, 3.0})].name, "right_c3");
  EXPECT_EQ(map.cells()[map.cellAt({9.0, 3.0})].name, "right_c3");  // outside: the nearest
  EXPECT_FALSE(map.find("left_c9"));
  EXPECT_EQ(map.nearestName("rihgt_c3"), "right_c3");
}

}  // namespace
}  // namespace kr3::navigation
