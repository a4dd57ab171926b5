#include "kr3_navigation/movable_nodes.hpp"

#include <algorithm>

namespace kr3::navigation
{
namespace
{

constexpr double kWallDepth = 0.13;  // m: half a wall, and half a node of the map
constexpr float kRounding = 1e-6F;

bool isOnBorder(const std::vector<Place>& places, Point p)
{
  return std::any_of(places.begin(), places.end(), [&](const Place& place) {
    return place.rectangle.shrunk(-kWallDepth).contains(p) &&
           !place.rectangle.shrunk(kWallDepth).contains(p);
  });
}

}  // namespace

std::vector<char> movableNodes(const DistanceField& field, const std::vector<Place>& places)
{
  std::vector<char> movable(field.distance_m.size(), 0);
  if (places.empty())
    return movable;
  OccupancyGrid walls;
  walls.geometry = field.geometry;
  walls.nodes.assign(field.distance_m.size(), Occupancy::kFree);
  for (std::size_t node = 0; node < walls.nodes.size(); ++node)
  {
    if (field.distance_m[node] <= 0.0F &&
        isOnBorder(places, field.geometry.center(static_cast<int>(node))))
      walls.nodes[node] = Occupancy::kOccupied;
  }
  const DistanceField to_walls = distanceField(walls);
  for (std::size_t node = 0; node < movable.size(); ++node)
    movable[node] = to_walls.distance_m[node] > field.distance_m[node] + kRounding ? 1 : 0;
  return movable;
}

}  // namespace kr3::navigation
