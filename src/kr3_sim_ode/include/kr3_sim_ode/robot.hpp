#pragma once

#include "kr3_sim_ode/geometry.hpp"

namespace kr3::sim
{

/// Dimensions, mounts and limits of the robot. Its frame base_link is on the floor between the
/// drive wheels, x forward.
struct RobotModel
{
  Vector3 base_size{0.40, 0.26, 0.20};
  double base_center_z_m = 0.16;
  double base_mass_kg = 12.0;
  double wheel_radius_m = 0.08;
  double track_m = 0.32;  ///< between the wheels' contact points
  double wheel_torque_nm = 5.0;
  double max_speed_m_s = 0.6;
  double max_turn_rate_rad_s = 1.8;
  double max_acceleration_m_s2 = 1.0;
  double max_turn_acceleration_rad_s2 = 4.0;

  Pose T_base_laser{{0.0, 0.0, 0.30}, {}};
  double camera_x_m = 0.15;
  double camera_z_m = 0.65;
  double camera_pitch_rad = 0.2;  ///< positive looks down (REP 103: about y)

  Pose T_base_gripper{{0.45, 0.0, 0.45}, {}};  ///< the grasp point
  double reach_m = 0.75;                    ///< from base_link to an object's centre, on the floor
  double reach_angle_rad = 0.61;            ///< to either side of straight ahead
  Vector3 carry_position{0.12, 0.0, 0.98};  ///< above laser and camera, out of both views

  [[nodiscard]] Pose T_base_camera() const
  {
    return {{camera_x_m, 0.0, camera_z_m}, quaternionFromYawPitch(0.0, camera_pitch_rad)};
  }
};

}  // namespace kr3::sim
