// Files that nobody should write: every reader either takes a damaged file or refuses it and names
// it, and cells can be made of what it takes, or it says why not. See damaged_files.hpp.
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <kr3_common/testing/damaged_files.hpp>
#include <kr3_common/testing/temporary_folder.hpp>

#include "kr3_navigation/blocked_passage.hpp"
#include "kr3_navigation/cells.hpp"
#include "kr3_navigation/live_map.hpp"
#include "kr3_navigation/movable_nodes.hpp"
#include "synthetic_world.hpp"

namespace kr3::navigation
{
namespace
{

namespace fs = std::filesystem;
using kr3::test_support::damageFile;
using kr3::test_support::takes;
using kr3::test_support::TemporaryFolder;

class Readers : public ::testing::Test
{
protected:
  Readers() { fs::copy(KR3_TEST_DIR "/data", folder_.path()); }

  /// All that the node makes of a map and places when it starts.
  static void start(const OccupancyMap& map, const std::vector<Place>& places,
                    const std::vector<Door>& doors)
  {
    const LiveMap live(map.copy(), true, areaOf(places, 0.2), LiveMapOptions{});
    const CellMap cells(places, CellOptions{}, live.planner());
    (void)movableNodes(live.reference(), places);
    const Point from = cells.cells().front().stand;
    const Point to = cells.cells().back().stand;
    if (!live.planner().plan(from, to).found())
      (void)findBlockedPassage(live.givenPlanner(), live.planner(), from, to, places, doors);
    (void)live.map().toBinary();
  }

  TemporaryFolder folder_;
  fs::path building_ = fs::path(folder_.path()) / "two_rooms.yaml";
  fs::path map_ = fs::path(folder_.path()) / "two_rooms.bt";
};

TEST_F(Readers, OfBuildings)
{
  const OccupancyMap map = OccupancyMap::load(map_, {});
  EXPECT_GT(damageFile(
                building_, 400,
                [&] {
    const std::vector<Place> places = loadPlaces(building_);
    const std::vector<Door> doors = loadDoors(building_, places);
    (void)takes([&] { start(map, places, doors); }, "places that were taken");
                },
                "two_rooms.yaml:"),
            0U);
}

TEST_F(Readers, OfMaps)
{
  const std::vector<Place> places = loadPlaces(building_);
  const std::vector<Door> doors = loadDoors(building_, places);
  EXPECT_GT(damageFile(
                map_, 400,
                [&] {
    const OccupancyMap map = OccupancyMap::load(map_, {});
    (void)takes([&] { start(map, places, doors); }, "a map that was taken");
                },
                "two_rooms.bt"),
            0U);
}

TEST_F(Readers, OfFineMapsThatAreCoarsened)
{
  const std::vector<Place> places = loadPlaces(building_);
  OccupancyMapOptions options;
  options.resolution_m = 0.05;
  OccupancyMap fine(options);
  std::mt19937_64 random(1);
  for (double x = 0.5; x < 7.5; x += 0.5)
    fine.insertScan(SyntheticWorld::twoRooms().scan({x, 2.0, 0.0}, random), {x, 2.0, 0.0}, 0.3,
                    8.0);
  fine.save(map_);
  EXPECT_GT(damageFile(
                map_, 100,
                [&] {
    const OccupancyMap map = OccupancyMap::load(map_, {});
    (void)takes([&] { start(map, places, {}); }, "a map that was taken");
                },
                "two_rooms.bt"),
            0U);
}

}  // namespace
}  // namespace kr3::navigation
