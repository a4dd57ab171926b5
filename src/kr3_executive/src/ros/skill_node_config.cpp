#include "skill_node_config.hpp"

#include <kr3_common/ros/param_reader.hpp>

namespace kr3::executive::skills
{
namespace
{

/// Reads parameters of one kind of range.
class Reader
{
public:
  explicit Reader(ParamReader& params) : params_(params) {}

  void positive(const std::string& name, double& value)
  {
    value = params_.get(name, value);
    params_.check(value > 0.0, name, "must be > 0");
  }
  void notNegative(const std::string& name, double& value)
  {
    value = params_.get(name, value);
    params_.check(value >= 0.0, name, "must be >= 0");
  }
  void probability(const std::string& name, double& value)
  {
    value = params_.get(name, value);
    params_.check(value > 0.0 && value <= 1.0, name, "must be in (0, 1]");
  }
  void count(const std::string& name, int& value)
  {
    value = params_.get(name, value);
    params_.check(value > 0, name, "must be > 0");
  }

private:
  ParamReader& params_;
};

}  // namespace

SkillNodeConfig loadSkillNodeConfig(const ros::NodeHandle& private_nh)
{
  SkillNodeConfig config;
  ParamReader params(private_nh);
  Reader read(params);
  config.objects = params.require<std::string>("objects");
  config.bindings = params.get("bindings", config.bindings);
  SkillRobotConfig& robot = config.robot;
  robot.map_frame = params.get("map_frame", robot.map_frame);
  robot.base_frame = params.get("base_frame", robot.base_frame);
  read.positive("turn_speed", robot.turn_speed_rad_s);
  params.check(robot.turn_speed_rad_s >= 0.4, "turn_speed", "must be >= 0.4");
  read.positive("turn_tolerance", robot.turn_tolerance_rad);
  read.positive("creep_speed", robot.creep_speed_m_s);
  read.positive("robot_radius", robot.robot_radius_m);
  read.notNegative("stop_clearance", robot.stop_clearance_m);
  read.positive("peer_timeout", robot.peer_timeout_s);
  read.notNegative("furniture_depth", robot.furniture_depth_m);
  read.probability("accept_probability", config.search.accept_probability);
  read.probability("sure_probability", config.search.sure_probability);
  read.probability("miss_confidence", config.search.miss_confidence);
  read.notNegative("boundary_margin", config.search.boundary_margin_m);
  read.notNegative("other_room_penalty", config.search.other_room_penalty_m);
  read.notNegative("view_overlap", config.view_overlap_rad);
  read.count("images_per_heading", config.images_per_heading);
  read.notNegative("cell_margin", config.cell_margin_m);
  read.notNegative("return_margin", config.return_margin_m);
  read.positive("approach_min_distance", config.approach.min_distance_m);
  read.positive("approach_best_distance", config.approach.best_distance_m);
  read.positive("approach_max_distance", config.approach.max_distance_m);
  params.check(config.approach.min_distance_m <= config.approach.best_distance_m &&
                   config.approach.best_distance_m <= config.approach.max_distance_m,
               "approach_best_distance",
               "must lie between approach_min_distance and approach_max_distance");
  read.notNegative("approach_clearance", config.approach.clearance_m);
  read.count("approach_directions", config.approach.num_directions);
  read.count("max_approaches", config.max_approaches);
  read.positive("grasp_distance", config.grasp_distance_m);
  read.notNegative("back_off", config.back_off_m);
  read.positive("search_time_limit", config.search_time_limit_s);
  read.positive("grasp_time_limit", config.grasp_time_limit_s);
  read.positive("put_down_time_limit", config.put_down_time_limit_s);
  read.positive("hand_over_time_limit", config.hand_over_time_limit_s);
  config.approach.robot_radius_m = robot.robot_radius_m;
  params.finish();
  return config;
}

}  // namespace kr3::executive::skills
