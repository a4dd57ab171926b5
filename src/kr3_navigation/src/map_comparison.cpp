#include "kr3_navigation/map_comparison.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <kr3_common/error.hpp>

namespace kr3::navigation
{
namespace
{

double share(long part, long other)
{
  return part + other == 0 ? 1.0 : static_cast<double>(part) / static_cast<double>(part + other);
}

Occupancy at(const OccupancyGrid& grid, Point p)
{
  return grid.geometry.contains(p) ? grid.nodes[static_cast<std::size_t>(grid.geometry.index(p))]
                                   : Occupancy::kUnknown;
}

/// Whether a node within `reach` nodes of p has that occupancy.
bool anyNear(const OccupancyGrid& grid, Point p, int reach, Occupancy wanted)
{
  for (int dx = -reach; dx <= reach; ++dx)
  {
    for (int dy = -reach; dy <= reach; ++dy)
    {
      if (at(grid, {p.x + dx * grid.geometry.resolution_m,
                    p.y + dy * grid.geometry.resolution_m}) == wanted)
        return true;
    }
  }
  return false;
}

bool isSurface(const OccupancyGrid& truth, Point p)
{
  const double step = truth.geometry.resolution_m;
  const auto is_free = [&](double dx, double dy) {
    return at(truth, {p.x + dx, p.y + dy}) == Occupancy::kFree;
  };
  return is_free(step, 0.0) || is_free(-step, 0.0) || is_free(0.0, step) || is_free(0.0, -step);
}

void addLayer(const OccupancyGrid& map, const OccupancyGrid& truth, int tolerance,
              MapAgreement& agreement)
{
  for (std::size_t node = 0; node < truth.nodes.size(); ++node)
  {
    const Point p = truth.geometry.center(static_cast<int>(node));
    const Occupancy is = truth.nodes[node];
    const Occupancy said = at(map, p);
    if (is == Occupancy::kUnknown)
      continue;
    if (said == Occupancy::kOccupied)
      ++(anyNear(truth, p, tolerance, Occupancy::kOccupied) ? agreement.occupied_right
                                                            : agreement.occupied_wrong);
    if (said == Occupancy::kFree)
      ++(anyNear(truth, p, tolerance, Occupancy::kFree) ? agreement.free_right
                                                        : agreement.free_wrong);
    if (is == Occupancy::kFree && !anyNear(map, p, tolerance, Occupancy::kFree))
      ++agreement.free_missed;
    if (is == Occupancy::kOccupied && isSurface(truth, p))
      ++(anyNear(map, p, tolerance, Occupancy::kOccupied) ? agreement.surfaces_found
                                                          : agreement.occupied_missed);
  }
}

}  // namespace

double MapAgreement::occupiedPrecision() const
{
  return share(occupied_right, occupied_wrong);
}
double MapAgreement::occupiedRecall() const
{
  return share(surfaces_found, occupied_missed);
}
double MapAgreement::freePrecision() const
{
  return share(free_right, free_wrong);
}
double MapAgreement::freeRecall() const
{
  return share(free_right, free_missed);
}

MapAgreement compareMaps(const OccupancyMap& map, const OccupancyMap& truth,
                         const MapComparisonOptions& options)
{
  const double resolution = std::max(map.resolution(), truth.resolution());
  const OccupancyMap coarse_map = map.coarsened(resolution);
  const OccupancyMap coarse_truth = truth.coarsened(resolution);
  if (std::abs(coarse_map.resolution() - coarse_truth.resolution()) > 1e-6)
    throw InvalidArgument("the maps have nodes of " + std::to_string(map.resolution()) + " m and " +
                          std::to_string(truth.resolution()) +
                          " m, expected a ratio that is a power of two");
  MapAgreement agreement;
  const auto first = static_cast<int>(std::floor(options.z_min_m / resolution + 1e-6));
  const auto last = static_cast<int>(std::ceil(options.z_max_m / resolution - 1e-6));
  for (int layer = first; layer < last; ++layer)
  {
    constexpr double kInside = 0.25;  // of a node: the layer and not its neighbours
    const double z_min = (layer + kInside) * resolution;
    const double z_max = (layer + 1.0 - kInside) * resolution;
    const OccupancyGrid said = coarse_map.project(z_min, z_max, {0.0, 0.0, resolution, resolution});
    if (std::all_of(said.nodes.begin(), said.nodes.end(),
                    [](Occupancy node) { return node == Occupancy::kUnknown; }))
      continue;
    addLayer(said, coarse_truth.project(z_min, z_max, {0.0, 0.0, resolution, resolution}),
             options.tolerance_nodes, agreement);
  }
  return agreement;
}

}  // namespace kr3::navigation
