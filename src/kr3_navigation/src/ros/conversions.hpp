#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <geometry_msgs/Pose.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <geometry_msgs/TransformStamped.h>
#include <geometry_msgs/Twist.h>
#include <nav_msgs/OccupancyGrid.h>
#include <nav_msgs/Path.h>
#include <sensor_msgs/LaserScan.h>
#include <std_msgs/UInt8MultiArray.h>
#include <visualization_msgs/MarkerArray.h>

#include <kr3_msgs/CellArray.h>

#include "kr3_navigation/cells.hpp"
#include "kr3_navigation/particle_filter.hpp"
#include "kr3_navigation/path_follower.hpp"

namespace kr3::navigation
{

/// @throws InvalidArgument  a number is not finite, or the quaternion is not one
[[nodiscard]] Pose fromMsg(const geometry_msgs::Pose& message);
/// @throws InvalidArgument  no beams, or an angle step of zero
[[nodiscard]] LaserScan fromMsg(const sensor_msgs::LaserScan& message);

[[nodiscard]] geometry_msgs::Pose toMsg(const Pose& pose);
[[nodiscard]] geometry_msgs::Twist toMsg(const Velocity& velocity);
[[nodiscard]] geometry_msgs::TransformStamped toTransformMsg(const Pose& T_parent_child,
                                                             const std_msgs::Header& parent,
                                                             const std::string& child);
[[nodiscard]] geometry_msgs::PoseWithCovarianceStamped toMsg(const PoseEstimate& estimate,
                                                             const std_msgs::Header& header);
[[nodiscard]] nav_msgs::OccupancyGrid toMsg(const OccupancyGrid& grid,
                                            const std_msgs::Header& header);
[[nodiscard]] nav_msgs::Path toMsg(const std::vector<Point>& path, const std_msgs::Header& header);
[[nodiscard]] kr3_msgs::CellArray toMsg(const CellMap& map, const std_msgs::Header& header);
[[nodiscard]] visualization_msgs::MarkerArray toMarkers(const CellMap& map,
                                                        const std_msgs::Header& header);
[[nodiscard]] std_msgs::UInt8MultiArray toMsg(std::vector<std::uint8_t> bytes);

}  // namespace kr3::navigation
