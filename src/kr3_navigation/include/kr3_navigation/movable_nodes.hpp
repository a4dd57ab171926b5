#pragma once

#include <vector>

#include "kr3_navigation/occupancy_grid.hpp"
#include "kr3_navigation/places.hpp"

namespace kr3::navigation
{

/// Tells walls from what may be moved: walls stand on the borders of places, furniture inside them.
///
/// @param field   distances to the obstacles of a map
/// @param places  whose borders are the middle of walls; from the building file, or from the map
/// @return 1 for the nodes whose nearest obstacle is no wall, else 0; shape [height, width],
///         row-major. Without places nothing is known, and nothing counts as movable.
[[nodiscard]] std::vector<char> movableNodes(const DistanceField& field,
                                             const std::vector<Place>& places);

}  // namespace kr3::navigation
