#pragma once

#include <string>
#include <vector>

#include <ros/node_handle.h>

#include "kr3_sim_ode/camera.hpp"
#include "kr3_sim_ode/scenario.hpp"

namespace kr3::sim
{

struct SimNodeConfig
{
  Scenario scenario;
  CameraModel camera;
  CameraNoise camera_noise;
  OctomapOptions octomap;
  std::vector<std::string> lockstep_consumers;  ///< time does not begin without these
  double lockstep_timeout_s = 5.0;              ///< wall; for consumers that state none
  double camera_rate_hz = 5.0;
  double real_time_factor = 1.0;   ///< simulated seconds per wall second; 0: as fast as possible
  double command_timeout_s = 0.5;  ///< simulated
};

/// @param private_nh  handle on "~"
/// @throws InvalidArgument, NotFound, Unavailable  a parameter or a file is wrong; the message
/// lists what
[[nodiscard]] SimNodeConfig loadSimNodeConfig(const ros::NodeHandle& private_nh);

}  // namespace kr3::sim
