#include "sim_node_config.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <kr3_common/ros/param_reader.hpp>

namespace kr3::sim
{

SimNodeConfig loadSimNodeConfig(const ros::NodeHandle& private_nh)
{
  SimNodeConfig config;
  ParamReader params(private_nh);
  const auto number = [&](const std::string& name, double& value, double low, double high) {
    value = params.get(name, value);
    params.check(value >= low && value <= high, name,
                 "must be in [" + std::to_string(low) + ", " + std::to_string(high) + "]");
  };
  const auto whole = [&](const std::string& name, int& value, int low, int high) {
    value = params.get(name, value);
    params.check(value >= low && value <= high, name,
                 "must be in [" + std::to_string(low) + ", " + std::to_string(high) + "]");
  };

  const auto building_path = params.require<std::string>("building");
  const auto objects_path = params.require<std::string>("objects");
  config.scenario.placements = params.get("placements", config.scenario.placements);
  config.scenario.robot_start = params.get("robot_start", config.scenario.robot_start);
  const std::vector<double> pose = params.get("robot_pose", std::vector<double>());
  const bool is_pose = pose.size() == 3 && std::all_of(pose.begin(), pose.end(),
                                                       [](double v) { return std::isfinite(v); });
  params.check(pose.empty() || is_pose, "robot_pose", "must be empty or x, y, yaw");
  params.check(pose.empty() || config.scenario.robot_start.empty(), "robot_pose",
               "must be empty if robot_start says where the robot starts");
  if (is_pose)
  {
    config.scenario.robot_pose = Pose2{pose[0], pose[1], pose[2]};
  }
  WorldConfig& world = config.scenario.world;
  int seed = static_cast<int>(world.seed);
  whole("seed", seed, 0, 2147483647);
  world.seed = static_cast<std::uint64_t>(seed);
  number("real_time_factor", config.real_time_factor, 0.0, 1000.0);
  number("time_step", world.time_step_s, 0.0005, 0.005);
  number("command_timeout", config.command_timeout_s, 0.05, 10.0);

  whole("camera_width", config.camera.width, 16, 4096);
  whole("camera_height", config.camera.height, 16, 4096);
  number("camera_hfov", config.camera.horizontal_fov_rad, 0.1, 3.0);
  const std::vector<double> distortion =
      params.get("camera_distortion", std::vector<double>(config.camera.distortion.size(), 0.0));
  const bool has_five = distortion.size() == config.camera.distortion.size();
  params.check(has_five, "camera_distortion", "must be 5 numbers: k1, k2, p1, p2, k3");
  if (has_five)
  {
    std::copy(distortion.begin(), distortion.end(), config.camera.distortion.begin());
  }
  number("camera_rate", config.camera_rate_hz, 0.1, 100.0);
  number("camera_pitch", world.robot.camera_pitch_rad, -1.5, 1.5);
  number("camera_exposure_stddev", config.camera_noise.exposure_stddev, 0.0, 0.5);
  number("camera_pixel_stddev", config.camera_noise.pixel_stddev, 0.0, 50.0);

  whole("laser_beams", world.laser.num_beams, 8, 3600);
  number("laser_max_range", world.laser.max_range_m, 0.5, 100.0);
  number("laser_noise_stddev", world.laser.noise_stddev_m, 0.0, 1.0);
  number("laser_dropout_rate", world.laser.dropout_rate, 0.0, 1.0);
  number("odometry_radius_stddev", world.odometry.radius_stddev, 0.0, 0.1);
  number("odometry_track_stddev", world.odometry.track_stddev, 0.0, 0.1);
  number("odometry_slip_stddev", world.odometry.slip_stddev, 0.0, 1.0);
  number("grasp_failure_rate", world.grasp_failure_rate, 0.0, 1.0);
  number("drop_rate", world.drop_rate_per_m, 0.0, 10.0);
  number("gripper_reach", world.robot.reach_m, 0.3, 2.0);
  number("gripper_reach_angle", world.robot.reach_angle_rad, 0.05, 3.1);
  config.lockstep_consumers = params.get("lockstep_consumers", config.lockstep_consumers);
  number("lockstep_timeout", config.lockstep_timeout_s, 0.1, 3600.0);
  number("octomap_resolution", config.octomap.resolution_m, 0.01, 1.0);
  number("octomap_z_min", config.octomap.z_min_m, -1.0, 10.0);
  number("octomap_z_max", config.octomap.z_max_m, -1.0, 10.0);
  params.check(config.octomap.z_min_m < config.octomap.z_max_m, "octomap_z_max",
               "must be above octomap_z_min");
  params.finish();

  config.scenario.building = loadBuilding(building_path);
  config.scenario.models = loadObjectModels(objects_path);
  return config;
}

}  // namespace kr3::sim
