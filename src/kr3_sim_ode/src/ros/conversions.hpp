#pragma once

#include <string>
#include <vector>

#include <geometry_msgs/TransformStamped.h>
#include <nav_msgs/Odometry.h>
#include <opencv2/core/mat.hpp>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/LaserScan.h>

#include <kr3_msgs/ContactArray.h>
#include <kr3_msgs/ModelStates.h>
#include <kr3_msgs/ModelTwists.h>

#include "kr3_sim_ode/camera.hpp"
#include "kr3_sim_ode/world.hpp"

namespace kr3::sim
{

[[nodiscard]] geometry_msgs::Pose toMsg(const Pose& pose);
[[nodiscard]] Pose fromMsg(const geometry_msgs::Pose& pose);
[[nodiscard]] std_msgs::Header makeHeader(const ros::Time& stamp, const std::string& frame);
[[nodiscard]] geometry_msgs::TransformStamped toTransform(const ros::Time& stamp,
                                                          const std::string& parent,
                                                          const std::string& child,
                                                          const Pose& T_parent_child);
[[nodiscard]] nav_msgs::Odometry toOdometry(const ros::Time& stamp, const std::string& frame,
                                            const Pose& pose, const Velocity& velocity);

/// @param ranges  as from World::scan()
[[nodiscard]] sensor_msgs::LaserScan toScan(const ros::Time& stamp, const LaserModel& laser,
                                            double period_s, const std::vector<double>& ranges);

/// @param image  CV_8UC3, BGR
[[nodiscard]] sensor_msgs::Image toImage(const ros::Time& stamp, const cv::Mat& image);
[[nodiscard]] sensor_msgs::CameraInfo toCameraInfo(const ros::Time& stamp,
                                                   const CameraModel& camera);
[[nodiscard]] kr3_msgs::ModelStates toModelStates(const ros::Time& stamp, const World& world);

[[nodiscard]] kr3_msgs::ModelTwists toModelTwists(const ros::Time& stamp,
                                                  const std::vector<BodyTwist>& twists);
[[nodiscard]] kr3_msgs::ContactArray toContactArray(const ros::Time& stamp,
                                                    const std::vector<ContactReport>& contacts);

/// laser, camera_link, camera_optical_frame and gripper, where they are mounted.
[[nodiscard]] std::vector<geometry_msgs::TransformStamped> mountTransforms(const ros::Time& stamp,
                                                                           const RobotModel& robot);

}  // namespace kr3::sim
