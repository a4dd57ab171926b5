#pragma once

#include <filesystem>
#include <string>

#include <ros/node_handle.h>

#include "kr3_navigation/cells.hpp"
#include "kr3_navigation/driver.hpp"
#include "kr3_navigation/live_map.hpp"
#include "kr3_navigation/particle_filter.hpp"
#include "kr3_navigation/room_segmentation.hpp"

namespace kr3::navigation
{

/// Where rooms come from.
enum class PlaceSource
{
  kBuilding,  ///< the labels of the building file
  kMap,       ///< segmentation of the map
};

enum class PoseSource
{
  kLocalisation,  ///< particle filter against a given map
  kGroundTruth,   ///< the simulator's pose, while the map is built
  kMapping,       ///< particle filter against the map that is being built
};

/// The parameters of navigation_node; README.md has the table.
struct NavigationNodeConfig
{
  std::filesystem::path building;  ///< read with PlaceSource::kBuilding only
  PlaceSource place_source = PlaceSource::kBuilding;
  SegmentationOptions segmentation;
  std::filesystem::path map;      ///< read with kLocalisation only
  std::filesystem::path map_out;  ///< written by save_map; may be empty
  PoseSource pose_source = PoseSource::kLocalisation;
  Pose initial_pose;  ///< where the robot was when its odometry was zero
  std::string map_frame = "map";
  std::string odom_frame = "odom";
  std::string base_frame = "base_link";
  double control_period_s = 0.05;
  double drive_time_limit_s = 300.0;
  double map_publish_period_s = 2.0;
  int seed = 1;
  OccupancyMapOptions occupancy;
  LiveMapOptions live_map;
  CellOptions cells;
  DriverOptions driver;
  ParticleFilterOptions particle_filter;
};

/// @throws InvalidArgument  listing every bad parameter
[[nodiscard]] NavigationNodeConfig loadNavigationNodeConfig(const ros::NodeHandle& private_nh);

}  // namespace kr3::navigation
