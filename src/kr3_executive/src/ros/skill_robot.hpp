#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <actionlib/client/simple_action_client.h>
#include <geometry_msgs/TransformStamped.h>
#include <move_base_msgs/MoveBaseAction.h>
#include <nav_msgs/OccupancyGrid.h>
#include <nav_msgs/Odometry.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/LaserScan.h>
#include <std_msgs/Bool.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include <kr3_msgs/CellArray.h>
#include <kr3_msgs/DetectionArray.h>

#include "kr3_executive/skills_geometry.hpp"
#include "kr3_executive/skills_search.hpp"
#include "skill_node_config.hpp"

namespace kr3::executive::skills
{

/// Throws when the skill under way must end: Cancelled or DeadlineExceeded.
using Interruption = std::function<void()>;

/// One object in one image.
struct Seen
{
  std::string name;
  double probability = 0.0;
  std::optional<Point> p_map;  ///< nothing when only its direction is known
};

/// The robot's other nodes as calls that wait. Messages arrive on the spinner's thread, calls come
/// from one thread at a time. Every waiting call throws what its Interruption throws, and
/// Unavailable when a peer stays silent.
class SkillRobot
{
public:
  SkillRobot(const ros::NodeHandle& nh, const SkillRobotConfig& config);
  ~SkillRobot();
  SkillRobot(const SkillRobot&) = delete;
  SkillRobot& operator=(const SkillRobot&) = delete;

  [[nodiscard]] CellMap cells(const Interruption& interruption);
  [[nodiscard]] Grid grid(const Interruption& interruption);
  [[nodiscard]] Pose pose(const Interruption& interruption);
  [[nodiscard]] bool holding() const;

  /// Subscribes to the camera's results, until restEyes(): cameras work only while somebody looks.
  void openEyes();
  void restEyes();
  /// Horizontal angle of view of the camera, rad. The eyes must be open.
  [[nodiscard]] double viewAngle(const Interruption& interruption);
  /// What is in the next image taken from now on. The eyes must be open and the robot must stand
  /// still.
  [[nodiscard]] std::vector<Seen> look(const Interruption& interruption);

  /// Turns on the spot to a heading in the map and stands still.
  void turnTo(double yaw_rad, const Interruption& interruption);
  /// Drives slowly straight on (or back, when negative) as far as the laser allows. Returns the way
  /// done, m.
  double creep(double distance_m, const Interruption& interruption);
  /// Has the navigator drive to a pose. Returns whether it arrived.
  [[nodiscard]] bool driveTo(const Pose& pose_map, const Interruption& interruption);
  void stop();

  /// @return whether the gripper holds something now
  [[nodiscard]] bool closeGripper();
  /// @return whether something was put down; false also when there is no room for it
  [[nodiscard]] bool openGripper();

  /// Waits until `condition` (called under the lock) holds.
  /// @throws Unavailable  naming `what`, after the peer timeout, unless `patient`
  void waitFor(const std::function<bool()>& condition, const std::string& what,
               const Interruption& interruption, bool patient = false);
  /// Wakes waitFor() so that it looks at its condition; runs `change` under the lock.
  void notify(const std::function<void()>& change);

private:
  [[nodiscard]] bool viewAngleKnown() const;
  /// Waits for an odometry message newer than the last one taken.
  [[nodiscard]] nav_msgs::Odometry nextOdometry(const Interruption& interruption);
  void standStill(const Interruption& interruption);
  void command(double linear_m_s, double angular_rad_s);
  [[nodiscard]] std::optional<geometry_msgs::TransformStamped> transform(
      const std::string& target, const std::string& source, const ros::Time& time) const;
  [[nodiscard]] std::vector<Point> scanInBase(const Interruption& interruption);
  [[nodiscard]] std::optional<Point> positionOf(
      const kr3_msgs::Detection& detection, const geometry_msgs::TransformStamped& T_map_camera);
  [[nodiscard]] std::optional<double> laserRange(
      double bearing_map_rad, const geometry_msgs::TransformStamped& T_map_laser);

  SkillRobotConfig config_;
  ros::NodeHandle nh_;
  tf2_ros::Buffer tf_;
  tf2_ros::TransformListener tf_listener_;

  mutable std::mutex mutex_;  ///< guards what follows
  std::condition_variable changed_;
  kr3_msgs::CellArrayConstPtr cells_;
  nav_msgs::OccupancyGridConstPtr map_;
  sensor_msgs::LaserScanConstPtr scan_;
  nav_msgs::OdometryConstPtr odometry_;
  kr3_msgs::DetectionArrayConstPtr detections_;
  std::optional<double> view_angle_rad_;
  bool holding_ = false;
  ros::Time last_odometry_;  ///< taken by nextOdometry()

  actionlib::SimpleActionClient<move_base_msgs::MoveBaseAction> move_base_;
  ros::ServiceClient close_;
  ros::ServiceClient open_;
  ros::Publisher command_;
  ros::Subscriber eyes_;
  ros::Subscriber camera_info_;
  std::vector<ros::Subscriber> subscribers_;
};

}  // namespace kr3::executive::skills
