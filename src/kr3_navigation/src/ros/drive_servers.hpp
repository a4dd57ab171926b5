#pragma once

#include <functional>
#include <optional>
#include <string>

#include <actionlib/server/simple_action_server.h>
#include <move_base_msgs/MoveBaseAction.h>
#include <ros/node_handle.h>

#include <kr3_msgs/ExecuteSkillAction.h>

#include "kr3_navigation/cells.hpp"
#include "kr3_navigation/driver.hpp"
#include "kr3_navigation/pose_tracker.hpp"

namespace kr3::navigation
{

/// What the servers see of the rest of the node.
struct DriveContext
{
  const PoseTracker& tracker;
  std::function<const CellMap&()> cells;
  std::function<const PathPlanner&()> planner;
  std::function<void(const Velocity&)> command;  ///< to the wheels
  /// Navigator::whyUnreachable() for a goal and the driver's reason.
  std::function<std::string(Point, const std::string&)> why_unreachable;
};

/// The actions `move_base` and `skills/move_to` on one driver: a new goal of either preempts the
/// present one. All calls from one thread.
class DriveServers
{
public:
  DriveServers(ros::NodeHandle nh, const DriverOptions& driver, const CellOptions& cells,
               std::string map_frame, double time_limit_s, DriveContext context);

  /// Moves the driver on and answers the goal when it is done. Called at the control rate.
  void tick(const DriveInput& input);
  /// Stops the wheels until the next tick.
  void hold();
  /// Ends the present goal, because the node stops.
  void stop();

  /// See Driver::takeFreshMapRequest().
  [[nodiscard]] bool takeFreshMapRequest() { return driver_.takeFreshMapRequest(); }
  /// See Driver::takeContact().
  [[nodiscard]] std::optional<Point> takeContact() { return driver_.takeContact(); }
  [[nodiscard]] const Driver& driver() const { return driver_; }

private:
  enum class Client
  {
    kNone,
    kMoveBase,
    kMoveTo,
  };

  void onMoveBaseGoal();
  void onMoveToGoal();
  void onPreempt(Client client);
  void begin(Client client, const DriveGoal& goal, double time_limit_s);
  void cancelPresent(const std::string& why);
  void finish();
  void finishMoveBase(const std::string& failure);
  void finishMoveTo(const std::string& failure);
  void finishAtTimeLimit();
  void publishFeedback(const DriveInput& input);
  [[nodiscard]] kr3_msgs::ExecuteSkillResult moveToResult() const;
  [[nodiscard]] Point chooseStand() const;
  [[nodiscard]] std::size_t parseMoveTo(const kr3_msgs::ExecuteSkillGoal& goal) const;
  [[nodiscard]] DriveGoal parseMoveBase(const move_base_msgs::MoveBaseGoal& goal) const;

  Driver driver_;
  CellOptions cell_options_;
  std::string map_frame_;
  double default_time_limit_s_;
  DriveContext context_;
  Client client_ = Client::kNone;
  std::size_t target_cell_ = 0;
  double start_time_s_ = 0.0;
  double time_limit_s_ = 0.0;
  double feedback_time_s_ = 0.0;
  bool wheels_turn_ = false;

  actionlib::SimpleActionServer<move_base_msgs::MoveBaseAction> move_base_;
  actionlib::SimpleActionServer<kr3_msgs::ExecuteSkillAction> move_to_;
};

}  // namespace kr3::navigation
