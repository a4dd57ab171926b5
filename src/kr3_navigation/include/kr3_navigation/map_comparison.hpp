#pragma once

#include "kr3_navigation/occupancy_map.hpp"

namespace kr3::navigation
{

/// How often a map is right about the nodes of a true one. Only nodes that are known in truth
/// count; of the occupied ones only surfaces (with a free neighbour in their layer) can be missed,
/// for nobody sees the inside of a wall.
struct MapAgreement
{
  long occupied_right = 0;   ///< occupied in the map and in truth
  long occupied_wrong = 0;   ///< occupied in the map, free in truth
  long occupied_missed = 0;  ///< surface in truth, not occupied in the map
  long surfaces_found = 0;   ///< surface in truth, occupied in the map
  long free_right = 0;       ///< free in both
  long free_wrong = 0;       ///< free in the map, occupied in truth
  long free_missed = 0;      ///< free in truth, not free in the map

  /// Share of the map's occupied nodes that are right; 1 when there are none. So below.
  [[nodiscard]] double occupiedPrecision() const;
  /// Share of the true surfaces that are occupied in the map.
  [[nodiscard]] double occupiedRecall() const;
  [[nodiscard]] double freePrecision() const;
  [[nodiscard]] double freeRecall() const;
};

struct MapComparisonOptions
{
  double z_min_m = 0.0;  ///< nodes whose layers lie between these heights are compared
  double z_max_m = 2.0;
  /// How many nodes a surface may be off: with 1, noise that moves a hit over a node's border is
  /// no error.
  int tolerance_nodes = 0;
};

/// Compares layer by layer at the coarser of the two resolutions. Layers of which the map knows
/// nothing are left out: a laser that scans in a plane sees one layer.
/// @throws InvalidArgument  the resolutions differ by another factor than a power of two
[[nodiscard]] MapAgreement compareMaps(const OccupancyMap& map, const OccupancyMap& truth,
                                       const MapComparisonOptions& options);

}  // namespace kr3::navigation
