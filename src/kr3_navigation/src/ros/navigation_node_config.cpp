#include "navigation_node_config.hpp"

#include <kr3_common/ros/param_reader.hpp>

namespace kr3::navigation
{
namespace
{

/// A number that must lie in (0, limit].
void readPositive(ParamReader& params, const std::string& name, double& value, double limit)
{
  value = params.get(name, value);
  params.check(value > 0.0 && value <= limit, name,
               "must be in (0, " + std::to_string(limit) + "]");
}

void readPose(ParamReader& params, NavigationNodeConfig& config)
{
  const std::string source = params.get<std::string>("pose_source", "localisation");
  params.check(source == "localisation" || source == "ground_truth" || source == "mapping",
               "pose_source",
               "must be 'localisation', 'ground_truth' or 'mapping', not '" + source + "'");
  config.pose_source = source == "ground_truth" ? PoseSource::kGroundTruth
                       : source == "mapping"    ? PoseSource::kMapping
                                                : PoseSource::kLocalisation;
  const auto initial = params.get("initial_pose", std::vector<double>{});
  params.check(initial.empty() || initial.size() == 3, "initial_pose",
               "must be [] or [x, y, yaw] in m and rad, found " + std::to_string(initial.size()) +
                   " numbers");
  if (initial.size() == 3)
    config.initial_pose = Pose{initial[0], initial[1], initial[2]};
}

void readMap(ParamReader& params, NavigationNodeConfig& config)
{
  const std::string source = params.get<std::string>("place_source", "building");
  params.check(source == "building" || source == "map", "place_source",
               "must be 'building' or 'map', not '" + source + "'");
  params.check(source != "map" || config.pose_source == PoseSource::kLocalisation, "place_source",
               "must be 'building' while a map is built");
  config.place_source = source == "map" ? PlaceSource::kMap : PlaceSource::kBuilding;
  readPositive(params, "room_door_width", config.segmentation.door_width_m, 5.0);
  readPositive(params, "room_least_area", config.segmentation.least_area_m2, 1000.0);
  if (config.place_source == PlaceSource::kBuilding)
    config.building = params.require<std::string>("building");
  else
    config.building = params.get<std::string>("building", "");
  config.map = params.get<std::string>("map", "");
  params.check(config.pose_source != PoseSource::kLocalisation || !config.map.empty(), "map",
               "must name an OctoMap file (.bt) when pose_source is 'localisation'");
  config.map_out = params.get<std::string>("map_out", "");
  readPositive(params, "map_resolution", config.occupancy.resolution_m, 1.0);
  readPositive(params, "map_publish_period", config.map_publish_period_s, 3600.0);
  readPositive(params, "mapping_range", config.live_map.mapping_range_m, 100.0);
  readPositive(params, "revision_range", config.live_map.revision_range_m, 100.0);
  config.live_map.z_min_m = params.get("map_z_min", config.live_map.z_min_m);
  config.live_map.z_max_m = params.get("map_z_max", config.live_map.z_max_m);
  params.check(config.live_map.z_min_m < config.live_map.z_max_m, "map_z_max",
               "must be greater than map_z_min");
  config.cells.cells_per_room = params.get("cells_per_room", config.cells.cells_per_room);
  params.check(config.cells.cells_per_room >= 1 && config.cells.cells_per_room <= 1000,
               "cells_per_room", "must be from 1 to 1000");
}

void readDriving(ParamReader& params, NavigationNodeConfig& config)
{
  DriverOptions& driver = config.driver;
  readPositive(params, "robot_radius", driver.robot_radius_m, 5.0);
  double safety_margin_m = 0.06;
  readPositive(params, "safety_margin", safety_margin_m, 5.0);
  config.live_map.planner.inflation_radius_m = driver.robot_radius_m + safety_margin_m;
  config.live_map.planner.unknown_is_free = config.pose_source != PoseSource::kLocalisation;
  readPositive(params, "stop_distance", driver.stop_distance_m, 5.0);
  readPositive(params, "max_linear_speed", driver.limits.max_linear, 5.0);
  readPositive(params, "max_angular_speed", driver.limits.max_angular, 10.0);
  readPositive(params, "linear_acceleration", driver.limits.linear_acceleration, 10.0);
  readPositive(params, "angular_acceleration", driver.limits.angular_acceleration, 50.0);
  readPositive(params, "position_tolerance", driver.position_tolerance_m, 0.12);
  readPositive(params, "yaw_tolerance", driver.yaw_tolerance_rad, 0.5);
  readPositive(params, "control_period", config.control_period_s, 0.25);
  readPositive(params, "drive_time_limit", config.drive_time_limit_s, 86400.0);
}

}  // namespace

NavigationNodeConfig loadNavigationNodeConfig(const ros::NodeHandle& private_nh)
{
  NavigationNodeConfig config;
  ParamReader params(private_nh);
  readPose(params, config);
  readMap(params, config);
  readDriving(params, config);
  config.particle_filter.num_particles =
      params.get("num_particles", config.particle_filter.num_particles);
  params.check(
      config.particle_filter.num_particles >= 1 && config.particle_filter.num_particles <= 1000000,
      "num_particles", "must be from 1 to 1000000");
  config.seed = params.get("seed", config.seed);
  params.check(config.seed >= 0, "seed", "must not be negative");
  config.map_frame = params.get("map_frame", config.map_frame);
  config.odom_frame = params.get("odom_frame", config.odom_frame);
  config.base_frame = params.get("base_frame", config.base_frame);
  params.finish();
  return config;
}

}  // namespace kr3::navigation
