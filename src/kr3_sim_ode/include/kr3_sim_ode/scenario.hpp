#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "kr3_sim_ode/building.hpp"
#include "kr3_sim_ode/object_model.hpp"
#include "kr3_sim_ode/world.hpp"

namespace kr3::sim
{

/// All that determines a simulated world: the same scenario gives the same world.
struct Scenario
{
  Building building;
  std::vector<ObjectModel> models;
  std::vector<std::string> placements;  ///< "object=place", in place of the building's defaults
  std::string robot_start;              ///< a place; empty: robot_pose
  std::optional<Pose2> robot_pose;      ///< m, rad, world frame; none: as the building file says
  WorldConfig world;
};

/// Draws where objects and robot are, from the seed, and builds the world.
///
/// @throws NotFound            unknown object or place; the message lists those that exist
/// @throws InvalidArgument     a placement is malformed
/// @throws FailedPrecondition  no free surface or floor
[[nodiscard]] std::unique_ptr<World> makeWorld(const Scenario& scenario);

}  // namespace kr3::sim
