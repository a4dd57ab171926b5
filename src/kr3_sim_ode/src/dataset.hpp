#pragma once

#include <random>
#include <vector>

#include "kr3_sim_ode/building.hpp"
#include "kr3_sim_ode/object_model.hpp"
#include "kr3_sim_ode/placement.hpp"
#include "kr3_sim_ode/robot.hpp"

namespace kr3::sim
{

/// A scene for a labelled picture: all objects somewhere on the furniture, the robot in front of
/// one of them.
struct LabelledView
{
  std::vector<ObjectState> objects;
  Pose2 T_world_base;
};

/// How objects stand around and from where one of them is looked at.
struct SceneOptions
{
  double min_distance_m = 0.7;  ///< from the camera to the object looked at, on the floor
  double max_distance_m = 2.5;
  /// 0: all objects, scattered over the building's furniture. Else so many of them, drawn anew for
  /// every view and crowded onto one piece of furniture, where they hide parts of each other.
  int crowd = 0;
  /// Objects are turned about the vertical by up to this much to either side, in addition to how
  /// they are put down, rad.
  double max_turn_rad = 0.0;
};

/// Draws a scene. The robot stands on free floor of the object's place and sees it inside the
/// middle two thirds of the picture; every `background_every`-th view (0: none) looks anywhere
/// instead.
/// @throws FailedPrecondition  the building has no room for the objects or no such viewpoint
[[nodiscard]] LabelledView drawView(const Building& building,
                                    const std::vector<ObjectModel>& models, const RobotModel& robot,
                                    const SceneOptions& scene, bool background,
                                    std::mt19937_64& generator);

}  // namespace kr3::sim
