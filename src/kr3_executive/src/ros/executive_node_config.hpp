#pragma once

#include <string>

#include <ros/node_handle.h>

#include "kr3_executive/method.hpp"

namespace kr3::executive
{

/// Parameters of the executive node; config/executive_node.yaml says what they mean.
struct ExecutiveNodeConfig
{
  std::string domain;
  std::string refinement;
  std::string models;
  std::string bindings;
  std::string scenario;    ///< may be empty
  std::string state_file;  ///< may be empty
  double peer_deadline_s = 60.0;
  bool lockstep = false;  ///< a simulation waits for what the mission thinks
  Method method = Method::kPa;
  BaselineOptions baseline;
  DriverConfig driver;
  reasoner::PlanOptions plan;
};

/// @throws InvalidArgument  listing everything wrong with the parameters
[[nodiscard]] ExecutiveNodeConfig loadExecutiveNodeConfig(const ros::NodeHandle& private_nh);

}  // namespace kr3::executive
