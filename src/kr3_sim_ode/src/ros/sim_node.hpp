#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <diagnostic_updater/diagnostic_updater.h>
#include <geometry_msgs/Twist.h>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>
#include <tf2_ros/static_transform_broadcaster.h>
#include <tf2_ros/transform_broadcaster.h>

#include <kr3_msgs/CloseGripper.h>
#include <kr3_msgs/DeleteModel.h>
#include <kr3_msgs/OpenGripper.h>
#include <kr3_msgs/SetModelPose.h>
#include <kr3_msgs/SpawnModel.h>
#include <kr3_msgs/StepSimulation.h>

#include "ground_truth.hpp"
#include "lockstep_servers.hpp"
#include "sim_node_config.hpp"

namespace kr3::sim
{

/// The simulated robot and building on ROS. One thread: callbacks run between steps.
class SimNode
{
public:
  /// @throws NotFound, InvalidArgument, FailedPrecondition  the scenario cannot be set up
  /// @throws Unavailable                                    no headless rendering
  SimNode(ros::NodeHandle nh, const SimNodeConfig& config);

  /// Simulates until ROS shuts down.
  void run();

private:
  /// Simulated time never runs backwards, so it counts steps over all resets.
  [[nodiscard]] ros::Time now() const;
  [[nodiscard]] bool isDue(double period_s) const;

  /// Steps between two messages of the clock.
  [[nodiscard]] std::uint64_t tickSteps() const;

  void advance(std::uint64_t steps);
  void publishDue();
  void publishCamera();
  void publishChanges();
  void publishWallClockState();
  void reset();

  void onCommand(const ros::MessageEvent<const geometry_msgs::Twist>& event);
  bool onClose(kr3_msgs::CloseGripper::Request& request,
               kr3_msgs::CloseGripper::Response& response);
  bool onOpen(kr3_msgs::OpenGripper::Request& request, kr3_msgs::OpenGripper::Response& response);
  bool onPause(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);
  bool onResume(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);
  bool onDrop(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);
  bool onReset(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);
  bool onStep(kr3_msgs::StepSimulation::Request& request,
              kr3_msgs::StepSimulation::Response& response);
  bool onSpawn(kr3_msgs::SpawnModel::Request& request, kr3_msgs::SpawnModel::Response& response);
  bool onDelete(kr3_msgs::DeleteModel::Request& request, kr3_msgs::DeleteModel::Response& response);
  bool onSetPose(kr3_msgs::SetModelPose::Request& request,
                 kr3_msgs::SetModelPose::Response& response);
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status);

  SimNodeConfig config_;
  std::unique_ptr<World> world_;
  Renderer renderer_;
  ImageNoise image_noise_;
  std::uint64_t total_steps_ = 0;
  bool paused_ = false;
  std::optional<ros::Time> last_command_;
  std::optional<bool> published_holding_;

  ros::WallTime window_start_;  // of the figures in simulation/state
  std::uint64_t window_steps_ = 0;
  double achieved_factor_ = 0.0;

  ros::NodeHandle nh_;
  tf2_ros::TransformBroadcaster transforms_;
  tf2_ros::StaticTransformBroadcaster static_transforms_;
  diagnostic_updater::Updater diagnostics_;
  ros::Publisher clock_;
  ros::Publisher odometry_;
  ros::Publisher scan_;
  ros::Publisher image_;
  ros::Publisher camera_info_;
  ros::Publisher holding_;
  ros::Publisher state_;
  GroundTruth ground_truth_;
  LockstepServers lockstep_;
  ros::Subscriber command_;
  ros::ServiceServer close_;
  ros::ServiceServer open_;
  ros::ServiceServer pause_;
  ros::ServiceServer resume_;
  ros::ServiceServer drop_;
  ros::ServiceServer reset_;
  ros::ServiceServer step_;
  ros::ServiceServer spawn_;
  ros::ServiceServer delete_;
  ros::ServiceServer set_pose_;
};

}  // namespace kr3::sim
