#pragma once

#include <vector>

#include "kr3_navigation/occupancy_map.hpp"
#include "kr3_navigation/places.hpp"

namespace kr3::navigation
{

struct SegmentationOptions
{
  double door_width_m = 1.3;   ///< what is narrower joins rooms, what is wider belongs to one
  double least_area_m2 = 2.0;  ///< of a room; smaller pieces join the neighbour they touch most
  /// The longest side of an obstacle that is furniture when it touches no wall: it is taken out of
  /// the map before that is divided, so that a table does not make two rooms.
  double furniture_size_m = 2.5;
};

/// A map divided into rooms.
struct Segmentation
{
  GridGeometry geometry;
  std::vector<int> room;  ///< of every node, -1 = none (wall, unknown); shape [height, width]
  int num_rooms = 0;

  [[nodiscard]] double area(int wanted) const;  ///< m^2
};

/// Divides the free space of a map into rooms, from the map alone.
///
/// Furniture is removed (islands of occupied nodes), the centres of rooms are where the distance to
/// walls exceeds half a door's width, and a watershed from there on the distance gives every free
/// node to the room it leads into. Corridors are rooms as well.
/// Source: Bormann et al., "Room Segmentation: Survey, Implementation, and Analysis" (ICRA 2016),
/// Sec. III-B (distance transform based); the removal of furniture and the merging are ours.
[[nodiscard]] Segmentation segmentRooms(const OccupancyGrid& grid,
                                        const SegmentationOptions& options);

/// How a segmentation agrees with a place of the building file.
struct PlaceAgreement
{
  std::string place;
  int room = -1;      ///< the one that covers most of it; -1 = none
  double iou = 0.0;   ///< intersection over union of the two, counted in free nodes
  int num_parts = 0;  ///< rooms that cover at least a tenth of it: more than 1 = over-segmented
};

struct SegmentationAgreement
{
  std::vector<PlaceAgreement> places;  ///< in the order of the building file
  double mean_iou = 0.0;
  int over_segmented = 0;   ///< places with several parts
  int under_segmented = 0;  ///< rooms that are the best for several places
};

[[nodiscard]] SegmentationAgreement compareRooms(const Segmentation& segmentation,
                                                 const std::vector<Place>& places);

/// The rooms of a map alone, for a building without labels: see segmentRooms() and placesOf(). The
/// rectangles leave out what lies between rooms, such as walls and doorways.
/// @param z_min_m, z_max_m  the band of heights in which something is an obstacle
/// @throws InvalidArgument  no room is found
[[nodiscard]] std::vector<Place> placesOfMap(const OccupancyMap& map, double z_min_m,
                                             double z_max_m, const SegmentationOptions& options);

/// The rooms as places named room_0, room_1, ... from the lower left: the largest rectangles of
/// free nodes in each. For a building without labels.
[[nodiscard]] std::vector<Place> placesOf(const Segmentation& segmentation);

}  // namespace kr3::navigation
