#pragma once

#include <ros/ros.h>

#include "kr3_sim_ode/world.hpp"
#include "octomap_publisher.hpp"

namespace kr3::sim
{

/// Publishes what is true in the world, for checks and training: poses, velocities, contacts and
/// the world as an OctoMap.
class GroundTruth
{
public:
  GroundTruth(ros::NodeHandle& nh, const OctomapOptions& octomap);

  /// The robot's pose, velocities, and what touched since the last call.
  void publishMotion(const ros::Time& stamp, World& world);

  /// Where every object is, and which one is held.
  void publishModels(const ros::Time& stamp, const World& world);

  /// Something was put elsewhere.
  void noteChange() { octomap_.noteChange(); }

  /// To call now and then: OctomapPublisher::update().
  void update(const World& world) { octomap_.update(world); }

private:
  ros::Publisher pose_;
  ros::Publisher models_;
  ros::Publisher twists_;
  ros::Publisher contacts_;
  OctomapPublisher octomap_;
};

}  // namespace kr3::sim
