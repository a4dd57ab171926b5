#pragma once

#include <vector>

#include "kr3_executive/skills_geometry.hpp"

namespace kr3::executive::skills
{

struct ApproachOptions
{
  double min_distance_m = 0.45;  ///< from the robot's centre to the object
  double max_distance_m =
      0.66;  ///< less than the gripper's reach, by what driving and seeing may err
  double best_distance_m = 0.54;  ///< in between
  double robot_radius_m = 0.24;
  double clearance_m = 0.05;  ///< kept to obstacles beyond the radius
  int num_directions = 24;    ///< round the object
  /// Farther off than max_distance_m, by what the cells of a map and the robot's pose may err about
  /// where furniture ends: the rest of the way goes by what the laser sees.
  double creep_m = 0.12;
};

/// Free poses from which the robot faces an object within its gripper's reach, cheapest first: near
/// to where the robot is, and at a comfortable distance; after them those from which it has to
/// creep. Empty when the object cannot be reached.
/// @throws InvalidArgument  distances that are not ordered, or no directions
[[nodiscard]] std::vector<Pose> approachPoses(const Point& object_map, const Pose& robot,
                                              const Grid& grid, const ApproachOptions& options);

}  // namespace kr3::executive::skills
