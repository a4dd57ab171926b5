#pragma once

#include <optional>
#include <vector>

#include <diagnostic_updater/diagnostic_updater.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <nav_msgs/Odometry.h>
#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/subscriber.h>
#include <sensor_msgs/LaserScan.h>
#include <std_srvs/Trigger.h>
#include <tf2/buffer_core.h>
#include <tf2_msgs/TFMessage.h>

#include "drive_servers.hpp"
#include "kr3_navigation/navigator.hpp"
#include "navigation_node_config.hpp"

namespace kr3::navigation
{

/// Maps, localises and drives. Everything happens in the callbacks of one thread; the stamps of
/// odometry are its clock, so that control does not depend on how fast simulated time runs.
class NavigationNode
{
public:
  /// @throws Unavailable, InvalidArgument  a file is missing or malformed
  explicit NavigationNode(const NavigationNodeConfig& config);

  /// Stops the wheels and ends the present goal.
  void stop();

private:
  void onOdometry(const nav_msgs::Odometry& message);
  void onGroundTruth(const nav_msgs::Odometry& message);
  void onScan(const sensor_msgs::LaserScan& message);
  void onInitialPose(const geometry_msgs::PoseWithCovarianceStamped& message);
  void onStaticTransforms(const tf2_msgs::TFMessage& message);
  bool onSaveMap(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) const;

  [[nodiscard]] std::optional<LaserMount> mountOf(const std::string& laser_frame) const;
  void publishEstimates(double start_s);
  void control();
  void makeCells(const PathPlanner& planner);
  void publishMap(double time_s);
  void publishPath();
  void publishCorrection(double time_s);
  [[nodiscard]] std_msgs::Header mapHeader(double time_s) const;

  NavigationNodeConfig config_;
  std::vector<Place> places_;
  std::vector<Door> doors_;
  Navigator navigator_;
  std::optional<CellMap> cells_;
  tf2::BufferCore static_transforms_;
  std::optional<double> publish_time_s_;
  int published_plans_ = 0;
  struct Load
  {
    double scan_ms = 0.0;     ///< wall time of the last scan's processing, smoothed
    double scan_age_s = 0.0;  ///< simulated time between a scan and its processing, smoothed
    long scans = 0;
  } load_;

  diagnostic_updater::Updater diagnostics_;
  ros::Publisher map_publisher_;
  ros::Publisher octomap_publisher_;
  ros::Publisher cells_publisher_;
  ros::Publisher markers_publisher_;
  ros::Publisher path_publisher_;
  ros::Publisher pose_publisher_;
  ros::Publisher cmd_vel_publisher_;
  ros::Publisher tf_publisher_;
  std::optional<DriveServers> servers_;
  ros::ServiceServer save_map_server_;
  ros::WallTimer diagnostics_timer_;
  std::vector<ros::Subscriber> subscribers_;
};

}  // namespace kr3::navigation
