#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kr3_navigation/path_planner.hpp"
#include "kr3_navigation/places.hpp"

namespace kr3::navigation
{

/// Where a way that the given map shows is blocked today.
struct BlockedPassage
{
  Point where;              ///< in the middle of what is not free now, map frame
  std::string description;  ///< for a person: the door, or the places on either side
};

/// Says what keeps the robot from a goal that the given map lets it reach: plans in the given map
/// and looks where that way is not free now. A door is the answer before anything else, for what
/// stands in a room can be passed; else what comes first.
///
/// @param given    the planner of the map as it was given
/// @param present  the planner of the map as it is now
/// @return nothing when the given map has no way either, or the way it has is free now
[[nodiscard]] std::optional<BlockedPassage> findBlockedPassage(const PathPlanner& given,
                                                               const PathPlanner& present,
                                                               Point start, Point goal,
                                                               const std::vector<Place>& places,
                                                               const std::vector<Door>& doors);

/// Says which doors would have to be open for a goal to be reached that the map shows no way to:
/// "every door of ... is shut in the map: ...". Empty when the goal is in no place, or the place
/// has no door.
[[nodiscard]] std::string describeShutDoors(const PathPlanner& planner, Point goal,
                                            const std::vector<Place>& places,
                                            const std::vector<Door>& doors);

}  // namespace kr3::navigation
