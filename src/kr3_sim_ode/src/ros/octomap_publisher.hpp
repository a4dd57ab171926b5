#pragma once

#include <ros/ros.h>

#include "kr3_sim_ode/world.hpp"

namespace kr3::sim
{

/// Publishes the world as an OctoMap, latched: to the first listener, and again after changes while
/// somebody listens. Without listeners it costs nothing.
class OctomapPublisher
{
public:
  OctomapPublisher(ros::NodeHandle& nh, const OctomapOptions& options);

  /// Something solid was put elsewhere.
  void noteChange() { is_current_ = false; }

  /// To call now and then: publishes what is not current, at most once a second of wall time.
  void update(const World& world);

private:
  OctomapOptions options_;
  bool is_current_ = false;
  ros::WallTime last_;
  ros::Publisher publisher_;
};

}  // namespace kr3::sim
