#pragma once

#include <string>

#include <ros/node_handle.h>

#include "kr3_executive/skills_approach.hpp"
#include "kr3_executive/skills_search.hpp"

namespace kr3::executive::skills
{

/// How the skills move and look. Durations are of simulated time unless said otherwise.
struct SkillRobotConfig
{
  std::string map_frame = "map";
  std::string base_frame = "base_link";
  double turn_speed_rad_s = 1.2;
  double turn_tolerance_rad = 0.04;
  double creep_speed_m_s = 0.12;
  double robot_radius_m = 0.24;
  double stop_clearance_m = 0.04;  ///< kept to what the laser sees while creeping
  double peer_timeout_s = 20.0;    ///< of wall time, for another node's next message or reply
  double furniture_depth_m = 0.8;  ///< see boundedRange()
};

struct SkillNodeConfig
{
  std::string objects;  ///< path of the domain's objects file: the names that may be asked for
  /// Path of the domain's bindings, for the literal that says where an object was seen; empty: what
  /// is seen by the way is not told.
  std::string bindings;
  SkillRobotConfig robot;
  SearchOptions search;
  ApproachOptions approach;
  double view_overlap_rad = 0.3;  ///< of neighbouring views when looking round
  int images_per_heading = 1;
  double cell_margin_m =
      0.35;  ///< by which the robot may stand outside the cell that it is to search
  double return_margin_m =
      1.5;                 ///< up to which it goes back first: a grasp's approach may leave it
  int max_approaches = 4;  ///< poses tried per grasp
  double grasp_distance_m =
      0.68;                  ///< from the robot's centre to the object when the gripper closes
  double back_off_m = 0.25;  ///< after a grasp
  double search_time_limit_s = 90.0;  ///< for goals that state none; also the others
  double grasp_time_limit_s = 180.0;
  double put_down_time_limit_s = 60.0;
  double hand_over_time_limit_s = 120.0;
};

/// @throws InvalidArgument  listing every bad parameter
[[nodiscard]] SkillNodeConfig loadSkillNodeConfig(const ros::NodeHandle& private_nh);

}  // namespace kr3::executive::skills
