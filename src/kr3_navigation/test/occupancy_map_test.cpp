#include "kr3_navigation/occupancy_map.hpp"

#include <fstream>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "synthetic_world.hpp"

namespace kr3::navigation
{
namespace
{

constexpr double kHeight = 0.3;
constexpr double kRange = 8.0;

std::filesystem::path temporaryFile(const std::string& name)
{
  return std::filesystem::temp_directory_path() / ("kr3_navigation_" + name);
}

/// A drive through both rooms, with a scan every 10 cm.
OccupancyMap mapTwoRooms()
{
  std::mt19937_64 random(1);
  OccupancyMap map{OccupancyMapOptions{}};
  const SyntheticWorld world = SyntheticWorld::twoRooms();
  for (double x = 0.5; x < 7.5; x += 0.1)
  {
    const Pose pose{x, 2.0, 0.3 * x};
    map.insertScan(world.scan(pose, random), pose, kHeight, kRange);
  }
  return map;
}

OccupancyGrid projected(const OccupancyMap& map)
{
  return map.project(kHeight - 0.1, kHeight + 0.1, kTwoRoomsArea);
}

Occupancy at(const OccupancyGrid& grid, Point p)
{
  return grid.nodes[static_cast<std::size_t>(grid.geometry.index(p))];
}

TEST(OccupancyMap, KeepsWallsWithoutHoles)
{
  const OccupancyGrid grid = projected(mapTwoRooms());
  // A wall has no hole where every line across it meets an occupied node.
  const auto solid = [&](Point first, Point step, Point across, int count) {
    for (int i = 0; i < count; ++i)
    {
      bool hit = false;
      for (int k = -1; k <= 1; ++k)
        hit = hit || at(grid, {first.x + i * step.x + k * across.x,
                               first.y + i * step.y + k * across.y}) == Occupancy::kOccupied;
      EXPECT_TRUE(hit) << "hole near " << first.x + i * step.x << ", " << first.y + i * step.y;
    }
  };
  solid({0.15, 4.05}, {0.1, 0.0}, {0.0, 0.1}, 78);
  solid({2.05, -0.05}, {0.1, 0.0}, {0.0, 0.1}, 58);
  solid({-0.05, 0.15}, {0.0, 0.1}, {0.1, 0.0}, 38);
  solid({8.05, 0.15}, {0.0, 0.1}, {0.1, 0.0}, 38);
  solid({3.95, 2.65}, {0.0, 0.1}, {0.1, 0.0}, 13);
}

TEST(OccupancyMap, SeesFreeSpaceAndLeavesTheRestUnknown)
{
  const OccupancyGrid grid = projected(mapTwoRooms());
  EXPECT_EQ(at(grid, {2.05, 2.05}), Occupancy::kFree);
  EXPECT_EQ(at(grid, {4.0, 2.05}), Occupancy::kFree);      // the door
  EXPECT_EQ(at(grid, {1.25, 0.75}), Occupancy::kUnknown);  // inside the table
}

TEST(OccupancyMap, ADropoutDoesNotSeeThroughWalls)
{
  std::mt19937_64 random(1);
  OccupancyMap map{OccupancyMapOptions{}};
  const Pose pose{2.0, 2.0, 0.0};
  LaserScan scan = SyntheticWorld::twoRooms().scan(pose, random);
  for (std::size_t beam = 3; beam < scan.ranges_m.size(); beam += 20)
    scan.ranges_m[beam] = std::numeric_limits<float>::infinity();
  map.insertScan(scan, pose, kHeight, kRange);
  const OccupancyGrid grid = map.project(0.2, 0.4, {-6.0, -6.0, 14.0, 10.0});
  for (std::size_t node = 0; node < grid.nodes.size(); ++node)
  {
    const Point p = grid.geometry.center(static_cast<int>(node));
    if (kTwoRoomsArea.distanceTo(p) > 0.0)
    {
      EXPECT_EQ(grid.nodes[node], Occupancy::kUnknown) << p.x << ", " << p.y;
    }
  }
}

TEST(OccupancyMap, SeesFarWhereManyBeamsMeetNothing)
{
  std::mt19937_64 random(1);
  OccupancyMap map{OccupancyMapOptions{}};
  map.insertScan(SyntheticWorld{}.scan({0.0, 0.0, 0.0}, random), {0.0, 0.0, 0.0}, kHeight, kRange);
  EXPECT_EQ(at(map.project(0.2, 0.4, {-9.0, -9.0, 9.0, 9.0}), {0.05, 7.0}), Occupancy::kFree);
}

TEST(OccupancyMap, ForgetsAnObstacleThatLeft)
{
  std::mt19937_64 random(1);
  SyntheticWorld world = SyntheticWorld::twoRooms();
  world.boxes.push_back({6.0, 1.8, 6.3, 2.1});
  OccupancyMap map{OccupancyMapOptions{}};
  const Pose pose{5.0, 2.0, 0.0};
  for (int i = 0; i < 50; ++i)
    map.insertScan(world.scan(pose, random), pose, kHeight, kRange);
  EXPECT_EQ(at(projected(map), {6.05, 1.95}), Occupancy::kOccupied);
  world.boxes.pop_back();
  for (int i = 0; i < 25; ++i)
    map.insertScan(world.scan(pose, random), pose, kHeight, kRange);
  EXPECT_EQ(at(projected(map), {6.05, 1.95}), Occupancy::kFree);
}

TEST(OccupancyMap, SmallPoseErrorsDoNotThickenKnownWalls)
{
  std::mt19937_64 random(1);
  const SyntheticWorld world = SyntheticWorld::twoRooms();
  OccupancyMap map = mapTwoRooms();
  const OccupancyGrid before = projected(map);
  const DistanceField known = distanceField(before);
  const Pose truth{2.0, 2.0, 0.0};
  for (int i = 0; i < 50; ++i)
    map.insertScan(world.scan(truth, random), Pose{2.06, 1.94, 0.02}, kHeight, 4.0, &known);
  const OccupancyGrid after = projected(map);
  for (std::size_t node = 0; node < before.nodes.size(); ++node)
  {
    if (after.nodes[node] != Occupancy::kOccupied)
      continue;
    EXPECT_EQ(before.nodes[node], Occupancy::kOccupied)
        << "at " << before.geometry.center(static_cast<int>(node)).x;
  }
}

TEST(OccupancyMap, ReportsChangesOnce)
{
  std::mt19937_64 random(1);
  OccupancyMap map{OccupancyMapOptions{}};
  EXPECT_FALSE(map.hasChanges());
  map.insertScan(SyntheticWorld::twoRooms().scan({2.0, 2.0, 0.0}, random, 0.0), {2.0, 2.0, 0.0},
                 kHeight, kRange);
  EXPECT_TRUE(map.hasChanges());
  map.clearChanges();
  EXPECT_FALSE(map.hasChanges());
}

TEST(OccupancyMap, IsTheSameAfterSaveAndLoad)
{
  const OccupancyMap map = mapTwoRooms();
  const std::filesystem::path path = temporaryFile("round_trip.bt");
  map.save(path);
  const OccupancyMap loaded = OccupancyMap::load(path, OccupancyMapOptions{});
  std::filesystem::remove(path);
  const OccupancyGrid before = projected(map);
  const OccupancyGrid after = projected(loaded);
  ASSERT_EQ(after.geometry.width, before.geometry.width);
  EXPECT_EQ(after.nodes, before.nodes);
  EXPECT_EQ(loaded.toBinary(), map.toBinary());
}

TEST(OccupancyMap, RefusesWhatIsNoMap)
{
  const std::filesystem::path path = temporaryFile("no_map.bt");
  std::ofstream(path) << "some text\n";
  try
  {
    (void)OccupancyMap::load(path, OccupancyMapOptions{});
    FAIL() << "expected InvalidArgument";
  }
  catch (const InvalidArgument& e)
  {
    EXPECT_NE(std::string(e.what()).find("not a binary OctoMap"), std::string::npos) << e.what();
  }
  std::filesystem::remove(path);
  EXPECT_THROW((void)OccupancyMap::load(path, OccupancyMapOptions{}), Unavailable);
  EXPECT_THROW(OccupancyMap({0.1, 0.4, 0.45}), InvalidArgument);
}

TEST(OccupancyMap, RefusesDamagedFiles)
{
  const std::filesystem::path path = temporaryFile("damaged.bt");
  mapTwoRooms().save(path);
  std::ifstream in(path, std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  const auto load = [&](const std::string& bytes) {
    std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
    return OccupancyMap::load(path, OccupancyMapOptions{}).numLeaves();
  };
  EXPECT_GT(load(whole), 100U);
  for (std::size_t length = 0; length < whole.size(); length += 37)
    EXPECT_THROW((void)load(whole.substr(0, length)), InvalidArgument) << length << " bytes";
  EXPECT_THROW((void)load(whole + "x"), InvalidArgument);
  // Every file of flipped bits is either refused, or as good a map as any.
  std::mt19937_64 random(1);
  for (int i = 0; i < 300; ++i)
  {
    std::string flipped = whole;
    flipped[random() % flipped.size()] ^= static_cast<char>(1 + random() % 255);
    try
    {
      EXPECT_GT(load(flipped), 0U);
    }
    catch (const InvalidArgument& e)
    {
      EXPECT_NE(std::string(e.what()).find(path.string()), std::string::npos) << e.what();
    }
  }
  const std::string nested(400, static_cast<char>(-1));
  EXPECT_THROW(
      (void)load("# Octomap OcTree binary file\nid OcTree\nsize 9\nres 0.1\ndata\n" + nested),
      InvalidArgument);
  std::filesystem::remove(path);
}

TEST(OccupancyMap, RefusesToUnfoldMapsOfKilometres)
{
  const std::filesystem::path path = temporaryFile("kilometres.bt");
  // The root and one of its children, a free leaf of half the length of everything.
  std::ofstream(path, std::ios::binary)
      << "# Octomap OcTree binary file\nid OcTree\nsize 2\nres 0.05\ndata\n"
      << std::string{'\x02', '\x00'};
  const OccupancyMap map = OccupancyMap::load(path, OccupancyMapOptions{});
  std::filesystem::remove(path);
  EXPECT_EQ(map.numLeaves(), 1U);
  EXPECT_THROW((void)map.project(0.2, 0.4, kTwoRoomsArea), InvalidArgument);
  EXPECT_THROW((void)map.coarsened(0.1), InvalidArgument);
  const OccupancyMap small{OccupancyMapOptions{}};
  for (const double far : {1e5, 1e300, std::numeric_limits<double>::infinity()})
    EXPECT_THROW((void)small.project(0.2, 0.4, {0.0, 0.0, far, 1e4}), InvalidArgument) << far;
}

TEST(OccupancyMap, ACoarseMapIsOccupiedWhereAPartOfItIs)
{
  std::mt19937_64 random(1);
  OccupancyMapOptions options;
  options.resolution_m = 0.05;
  OccupancyMap fine(options);
  for (double x = 0.5; x < 7.5; x += 0.2)
    fine.insertScan(SyntheticWorld::twoRooms().scan({x, 2.0, 0.0}, random), {x, 2.0, 0.0}, kHeight,
                    kRange);
  const OccupancyMap coarse = fine.coarsened(0.1);
  EXPECT_NEAR(coarse.resolution(), 0.1, 1e-12);
  EXPECT_NEAR(fine.coarsened(0.09).resolution(), 0.05, 1e-12);
  const OccupancyGrid is = fine.project(0.2, 0.4, kTwoRoomsArea);
  const OccupancyGrid coarse_grid = coarse.project(0.2, 0.4, kTwoRoomsArea);
  for (std::size_t node = 0; node < is.nodes.size(); ++node)
  {
    const Point p = is.geometry.center(static_cast<int>(node));
    const Occupancy part = is.nodes[node];
    const Occupancy all =
        coarse_grid.nodes[static_cast<std::size_t>(coarse_grid.geometry.index(p))];
    EXPECT_GE(all, part) << p.x << ", " << p.y;  // unknown < free < occupied
  }
}

TEST(OccupancyMap, SaysWhenItCannotBeWritten)
{
  EXPECT_THROW(mapTwoRooms().save("/nowhere/at/all/map.bt"), Unavailable);
}

}  // namespace
}  // namespace kr3::navigation
