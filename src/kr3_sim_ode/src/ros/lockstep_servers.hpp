#pragma once

#include <functional>
#include <string>
#include <vector>

#include <geometry_msgs/Twist.h>
#include <ros/ros.h>

#include <kr3_msgs/Acknowledgement.h>
#include <kr3_msgs/RegisterConsumer.h>
#include <kr3_msgs/UnregisterConsumer.h>

#include "kr3_sim_ode/lockstep.hpp"

namespace kr3::sim
{

/// Lockstep on ROS: consumers register and acknowledge; those that die are reported and removed.
class LockstepServers
{
public:
  /// @param now  simulated time; at construction the start of it
  /// @throws InvalidArgument  as Lockstep()
  LockstepServers(ros::NodeHandle& nh, const ros::Duration& tick,
                  const std::vector<std::string>& required, double default_timeout_s,
                  std::function<ros::Time()> now);

  /// Whether the simulation may advance by a tick. Removes consumers that are overdue.
  [[nodiscard]] bool mayAdvance();

  /// Simulated time was advanced, or stood still because the simulation is paused.
  void advanced();

  /// A velocity command has arrived from this node.
  void noteCommand(const std::string& node);

  /// Names of those waited for, for people; empty when nobody is.
  [[nodiscard]] std::string waitingFor() const;

private:
  void onAcknowledge(const kr3_msgs::Acknowledgement& acknowledgement);
  bool onRegister(kr3_msgs::RegisterConsumer::Request& request,
                  kr3_msgs::RegisterConsumer::Response& response);
  bool onUnregister(kr3_msgs::UnregisterConsumer::Request& request,
                    kr3_msgs::UnregisterConsumer::Response& response);
  void publishState();

  Lockstep lockstep_;
  double default_timeout_s_;
  std::function<ros::Time()> now_;
  std::vector<std::string> removed_;
  ros::Publisher state_;
  ros::Subscriber acknowledge_;
  ros::ServiceServer register_;
  ros::ServiceServer unregister_;
};

}  // namespace kr3::sim
