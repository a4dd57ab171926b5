#include "kr3_navigation/room_segmentation.hpp"

#include <string>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_navigation/cells.hpp"
#include "kr3_navigation/live_map.hpp"
#include "synthetic_world.hpp"

namespace kr3::navigation
{
namespace
{

// Node centres lie inside the walls.
constexpr Rectangle kArea{-0.15, -0.15, 8.15, 4.15};
const std::vector<Place> kPlaces{{"left", {0.0, 0.0, 4.0, 4.0}}, {"right", {4.0, 0.0, 8.0, 4.0}}};

TEST(RoomSegmentation, FindsTheRoomsOnBothSidesOfADoor)
{
  const OccupancyGrid grid = SyntheticWorld::twoRooms().grid(kArea);
  const Segmentation segmentation = segmentRooms(grid, {});
  EXPECT_EQ(segmentation.num_rooms, 2);
  const SegmentationAgreement agreement = compareRooms(segmentation, kPlaces);
  EXPECT_GT(agreement.mean_iou, 0.95);
  EXPECT_EQ(agreement.over_segmented, 0);
  EXPECT_EQ(agreement.under_segmented, 0);
  EXPECT_NE(agreement.places[0].room, agreement.places[1].room);
}

TEST(RoomSegmentation, ATableMakesNoRoom)
{
  SyntheticWorld world = SyntheticWorld::twoRooms();
  world.boxes.push_back({5.4, 1.2, 6.6, 2.6});
  const Segmentation segmentation = segmentRooms(world.grid(kArea), {});
  EXPECT_EQ(segmentation.num_rooms, 2);
}

TEST(RoomSegmentation, WithoutAWallThereIsOneRoom)
{
  SyntheticWorld world = SyntheticWorld::twoRooms();
  world.boxes.erase(world.boxes.begin() + 4, world.boxes.begin() + 6);
  const Segmentation segmentation = segmentRooms(world.grid(kArea), {});
  EXPECT_EQ(segmentation.num_rooms, 1);
  const SegmentationAgreement agreement = compareRooms(segmentation, kPlaces);
  EXPECT_EQ(agreement.under_segmented, 1);
  EXPECT_NEAR(agreement.mean_iou, 0.5, 0.05);
}

TEST(RoomSegmentation, EveryFreeNodeBelongsToARoomAndNoOther)
{
  const OccupancyGrid grid = SyntheticWorld::twoRooms().grid(kArea);
  const Segmentation segmentation = segmentRooms(grid, {});
  double area = 0.0;
  for (int room = 0; room < segmentation.num_rooms; ++room)
    area += segmentation.area(room);
  EXPECT_NEAR(area, 31.5, 1.5);  // two rooms of 16 m^2 less the wall between them
  for (std::size_t node = 0; node < grid.nodes.size(); ++node)
  {
    if (grid.nodes[node] == Occupancy::kFree)
    {
      EXPECT_GE(segmentation.room[node], 0) << node;
    }
  }
}

TEST(RoomSegmentation, GivesPlacesInsideTheirRooms)
{
  const Segmentation segmentation = segmentRooms(SyntheticWorld::twoRooms().grid(kArea), {});
  const std::vector<Place> places = placesOf(segmentation);
  ASSERT_EQ(places.size(), 2U);
  for (const Place& place : places)
  {
    EXPECT_GT(place.rectangle.width() * place.rectangle.height(), 9.0) << place.name;
    EXPECT_TRUE(place.rectangle.x_max < 4.2 || place.rectangle.x_min > 3.8) << place.name;
  }
}

TEST(RoomSegmentation, GivesRoomsAndCellsOfAMapWithoutLabels)
{
  const OccupancyMap map =
      OccupancyMap::load(std::string(KR3_TEST_DIR) + "/data/two_rooms.bt", OccupancyMapOptions{});
  const LiveMapOptions band;
  const std::vector<Place> places = placesOfMap(map, band.z_min_m, band.z_max_m, {});
  ASSERT_EQ(places.size(), 2U);
  EXPECT_EQ(places[0].name, "room_0");
  for (std::size_t i = 0; i < 2; ++i)
  {
    // The same rooms as the labels', one of them without the side where the table stands.
    EXPECT_TRUE(kPlaces[i].rectangle.shrunk(-0.15).contains(
        {places[i].rectangle.x_min, places[i].rectangle.y_min}));
    EXPECT_TRUE(kPlaces[i].rectangle.shrunk(-0.15).contains(
        {places[i].rectangle.x_max, places[i].rectangle.y_max}));
    EXPECT_GT(places[i].rectangle.width() * places[i].rectangle.height(), 9.5);
  }
  const LiveMap live(map.copy(), true, areaOf(places, 0.2), band);
  const CellMap cells(places, CellOptions{}, live.planner());
  ASSERT_EQ(cells.cells().size(), 8U);
  bool through_the_door = false;
  for (const Cell& cell : cells.cells())
  {
    EXPECT_TRUE(cell.reachable) << cell.name;
    for (const std::size_t neighbor : cell.neighbors)
      through_the_door = through_the_door || cells.cells()[neighbor].place != cell.place;
  }
  EXPECT_TRUE(through_the_door);
  EXPECT_THROW((void)placesOfMap(OccupancyMap(OccupancyMapOptions{}), 0.05, 0.6, {}),
               InvalidArgument);
  EXPECT_THROW((void)placesOfMap(map, 5.0, 6.0, {}), InvalidArgument);
}

TEST(RoomSegmentation, AnEmptyOrUnknownMapHasNoRooms)
{
  EXPECT_EQ(segmentRooms({}, {}).num_rooms, 0);
  OccupancyGrid unknown;
  unknown.geometry = {0.1, {0.0, 0.0}, 20, 30};
  unknown.nodes.assign(600, Occupancy::kUnknown);
  const Segmentation none = segmentRooms(unknown, {});
  EXPECT_EQ(none.num_rooms, 0);
  const SegmentationAgreement agreement = compareRooms(none, kPlaces);
  EXPECT_EQ(agreement.mean_iou, 0.0);
  EXPECT_EQ(agreement.places[0].room, -1);
  EXPECT_TRUE(placesOf(none).empty());
}

}  // namespace
}  // namespace kr3::navigation
