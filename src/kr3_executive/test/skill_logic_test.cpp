#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_executive/skills_approach.hpp"
#include "kr3_executive/skills_geometry.hpp"
#include "kr3_executive/skills_search.hpp"

namespace kr3::executive::skills
{
namespace
{

/// Two rooms side by side with a wall at x = 4; the west one has two cells.
CellMap twoRooms()
{
  return CellMap({{"west_south", "west", {2.0, 1.0}, 4.0, 2.0},
                  {"west_north", "west", {2.0, 3.0}, 4.0, 2.0},
                  {"east_all", "east", {6.0, 2.0}, 4.0, 4.0}});
}

/// 4 m x 4 m of free floor in cells of 0.1 m, with a table 1 m wide and 0.6 m deep at the east
/// wall.
Grid roomWithTable()
{
  constexpr int kCells = 40;
  std::vector<std::int8_t> values(kCells * kCells, 0);
  for (int row = 15; row < 25; ++row)
    for (int column = 34; column < 40; ++column)
      values[static_cast<std::size_t>(row * kCells + column)] = column == 34 ? 100 : -1;
  return {{0.0, 0.0}, 0.1, kCells, kCells, values};
}

TEST(LookHeadings, CoverTheWholeCircleWithTheOverlap)
{
  for (const double view : {0.5, 1.22, 2.0, 6.0})
    for (const double overlap : {0.0, 0.3})
    {
      const std::vector<double> headings = lookHeadings(2.5, view, overlap);
      EXPECT_DOUBLE_EQ(headings.front(), 2.5);
      for (std::size_t i = 0; i < headings.size(); ++i)
      {
        const double next = headings[(i + 1) % headings.size()];
        const double gap =
            headings.size() == 1 ? 2.0 * M_PI : std::abs(wrapped(next - headings[i]));
        EXPECT_LE(gap, view - overlap + 1e-9) << view << " " << overlap;
      }
    }
}

TEST(LookHeadings, RejectsViewsThatCannotCover)
{
  EXPECT_THROW((void)lookHeadings(0.0, 0.0, 0.0), InvalidArgument);
  EXPECT_THROW((void)lookHeadings(0.0, 0.5, 0.5), InvalidArgument);
}

TEST(Wrapped, IsTheSameAngleInOneTurn)
{
  for (double angle = -20.0; angle < 20.0; angle += 0.37)
  {
    EXPECT_GT(wrapped(angle), -M_PI);
    EXPECT_LE(wrapped(angle), M_PI);
    EXPECT_NEAR(std::sin(wrapped(angle)), std::sin(angle), 1e-9);
  }
}

TEST(BoundedRange, KeepsAnObjectOnTheFurnitureThatCarriesIt)
{
  EXPECT_DOUBLE_EQ(boundedRange(1.5, 1.4, 0.8), 1.5);
  EXPECT_DOUBLE_EQ(boundedRange(1.1, 1.4, 0.8), 1.4);
  EXPECT_DOUBLE_EQ(boundedRange(3.0, 1.4, 0.8), 2.2);
  EXPECT_DOUBLE_EQ(boundedRange(3.0, std::numeric_limits<double>::infinity(), 0.8), 3.0);
}

TEST(FreeDistance, CountsOnlyWhatTheRobotWouldTouch)
{
  EXPECT_NEAR(freeDistance({{1.0, 0.0}}, 0.25, true), 0.75, 1e-12);
  EXPECT_NEAR(freeDistance({{-1.0, 0.0}}, 0.25, false), 0.75, 1e-12);
  EXPECT_TRUE(std::isinf(freeDistance({{1.0, 0.3}, {-1.0, 0.0}}, 0.25, true)));
  EXPECT_DOUBLE_EQ(freeDistance({{0.2, 0.0}}, 0.25, true), 0.0);
}

TEST(Grid, IsFreeWhereEverythingUnderTheDiscIsKnownAndFree)
{
  const Grid grid = roomWithTable();
  EXPECT_TRUE(grid.isFree({2.0, 2.0}, 0.3));
  EXPECT_FALSE(grid.isFree({3.2, 2.0}, 0.3));   // the table's front
  EXPECT_FALSE(grid.isFree({3.7, 2.0}, 0.05));  // unknown inside
  EXPECT_FALSE(grid.isFree({0.1, 2.0}, 0.3));   // leaves the grid
  EXPECT_THROW(Grid({0.0, 0.0}, 0.1, 2, 2, {0, 0, 0}), InvalidArgument);
  EXPECT_THROW(Grid({0.0, 0.0}, 0.0, 1, 1, {0}), InvalidArgument);
}

TEST(CellMap, KnowsItsCells)
{
  const CellMap cells = twoRooms();
  EXPECT_EQ(cells.at("east_all").room, "east");
  EXPECT_THROW((void)cells.at("attic"), InvalidArgument);
  EXPECT_DOUBLE_EQ(cells.distanceTo("west_south", {1.0, 1.0}), 0.0);
  EXPECT_DOUBLE_EQ(cells.distanceTo("west_south", {1.0, 2.5}), 0.5);
  EXPECT_THROW(CellMap({}), InvalidArgument);
  EXPECT_THROW(CellMap({{"a", "r", {0.0, 0.0}, 1.0, 1.0}, {"a", "r", {1.0, 0.0}, 1.0, 1.0}}),
               InvalidArgument);
}

TEST(CellMap, PutsSightingsIntoTheRoomThatIsSeen)
{
  const CellMap cells = twoRooms();
  // Seen from the west room, a little behind the wall: it must be on this side of it.
  EXPECT_EQ(cells.holding({4.2, 0.5}, "west", "west_north", 0.15, 0.4).name, "west_south");
  // Far beyond: through the door.
  EXPECT_EQ(cells.holding({5.0, 0.5}, "west", "west_north", 0.15, 0.4).name, "east_all");
}

TEST(CellMap, GivesSightingsAtTheBoundaryToTheCellThatIsSearched)
{
  const CellMap cells = twoRooms();
  EXPECT_EQ(cells.holding({1.0, 2.1}, "west", "west_south", 0.15, 0.4).name, "west_south");
  EXPECT_EQ(cells.holding({1.0, 2.1}, "west", "west_north", 0.15, 0.4).name, "west_north");
  EXPECT_EQ(cells.holding({1.0, 2.3}, "west", "west_south", 0.15, 0.4).name, "west_north");
}

TEST(SearchLog, FindsInTheCellElsewhereOrNotAtAll)
{
  const CellMap cells = twoRooms();
  const SearchOptions options;
  SearchLog nothing;
  EXPECT_FALSE(nothing.result(cells, "west_south", options).found);
  EXPECT_FALSE(nothing.result(cells, "west_south", options).where);
  EXPECT_DOUBLE_EQ(nothing.result(cells, "west_south", options).confidence,
                   options.miss_confidence);

  SearchLog here;
  here.add({{1.0, 1.0}, 0.7});
  here.add({{1.0, 3.5}, 0.4});  // less likely: does not count
  EXPECT_TRUE(here.result(cells, "west_south", options).found);
  EXPECT_EQ(here.result(cells, "west_south", options).where, "west_south");
  EXPECT_DOUBLE_EQ(here.result(cells, "west_south", options).confidence, 0.7);
  EXPECT_FALSE(here.sure(options));

  SearchLog elsewhere;
  elsewhere.add({{1.0, 3.5}, 0.95});
  EXPECT_TRUE(elsewhere.sure(options));
  EXPECT_FALSE(elsewhere.result(cells, "west_south", options).found);
  EXPECT_EQ(elsewhere.result(cells, "west_south", options).where, "west_north");

  SearchLog doubtful;
  doubtful.add({{1.0, 1.0}, options.accept_probability - 0.1});
  EXPECT_FALSE(doubtful.result(cells, "west_south", options).found);
  EXPECT_FALSE(doubtful.result(cells, "west_south", options).where);
}

TEST(ApproachPoses, AreFreeWithinReachFaceTheObjectAndComeCheapestFirst)
{
  const Grid grid = roomWithTable();
  const ApproachOptions options;
  const Point object{3.55, 2.0};
  const Pose robot{1.0, 1.0, 0.0};
  const std::vector<Pose> poses = approachPoses(object, robot, grid, options);
  ASSERT_FALSE(poses.empty());
  for (const Pose& pose : poses)
  {
    const double d = distance(pose.point(), object);
    EXPECT_GE(d, options.min_distance_m - 1e-9);
    EXPECT_LE(d, options.max_distance_m + options.creep_m + 1e-9);
    EXPECT_NEAR(wrapped(bearing(pose.point(), object) - pose.yaw), 0.0, 1e-9);
    EXPECT_TRUE(grid.isFree(pose.point(), options.robot_radius_m + options.clearance_m));
  }
  EXPECT_LE(distance(poses.front().point(), object), options.max_distance_m + 1e-9);
  EXPECT_GT(distance(poses.back().point(), object), options.max_distance_m - 1e-9);  // creeps
  const auto near_ones = std::count_if(poses.begin(), poses.end(), [&](const Pose& pose) {
    return distance(pose.point(), object) < options.max_distance_m - 1e-9;
  });
  ASSERT_GT(near_ones, 1);
  EXPECT_LT(distance(poses.front().point(), robot.point()),
            distance(poses[static_cast<std::size_t>(near_ones) - 1].point(), robot.point()));
}

// Where a cell more than the table fills is occupied in the map, no pose is left within reach.
TEST(ApproachPoses, AreALittleFartherOffWhereTheMapLeavesNoRoom)
{
  const Grid grid = roomWithTable();
  const ApproachOptions options;
  const Point object{3.85, 2.0};
  const std::vector<Pose> poses = approachPoses(object, {1.0, 1.0, 0.0}, grid, options);
  ASSERT_FALSE(poses.empty());
  for (const Pose& pose : poses)
  {
    EXPECT_GE(distance(pose.point(), object), options.max_distance_m - 1e-9);
    EXPECT_LE(distance(pose.point(), object), options.max_distance_m + options.creep_m + 1e-9);
  }
}

TEST(ApproachPoses, AreNoneWhereTheObjectIsOutOfReach)
{
  // 0.35 m behind a front that the robot may come to within 0.29 m of is 0.64 m; 0.55 m behind is
  // too far.
  EXPECT_TRUE(approachPoses({3.95, 2.0}, {1.0, 1.0, 0.0}, roomWithTable(), {}).empty());
  ApproachOptions bad;
  bad.min_distance_m = 1.0;
  EXPECT_THROW((void)approachPoses({3.0, 2.0}, {}, roomWithTable(), bad), InvalidArgument);
}

}  // namespace
}  // namespace kr3::executive::skills
