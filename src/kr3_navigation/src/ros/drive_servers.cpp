#include "drive_servers.hpp"

#include <algorithm>

#include <kr3_common/error.hpp>
#include <kr3_common/ros/status.hpp>

#include "conversions.hpp"
#include "names.hpp"

namespace kr3::navigation
{
namespace
{

constexpr double kFeedbackPeriod = 0.5;    // s
constexpr double kLeastConfidence = 1e-3;  // the message promises more than 0

}  // namespace

DriveServers::DriveServers(ros::NodeHandle nh, const DriverOptions& driver,
                           const CellOptions& cells, std::string map_frame, double time_limit_s,
                           DriveContext context)
  : driver_(driver)
  , cell_options_(cells)
  , map_frame_(std::move(map_frame))
  , default_time_limit_s_(time_limit_s)
  , context_(std::move(context))
  , move_base_(nh, names::kMoveBase, false)
  , move_to_(nh, names::kMoveTo, false)
{
  move_base_.registerGoalCallback([this] { onMoveBaseGoal(); });
  move_base_.registerPreemptCallback([this] { onPreempt(Client::kMoveBase); });
  move_to_.registerGoalCallback([this] { onMoveToGoal(); });
  move_to_.registerPreemptCallback([this] { onPreempt(Client::kMoveTo); });
  move_base_.start();
  move_to_.start();
}

void DriveServers::onMoveBaseGoal()
{
  cancelPresent("a new goal took over");
  const auto goal = move_base_.acceptNewGoal();
  kr3_msgs::Status status;
  respond(status, names::kMoveBase, [&] {
    if (!context_.tracker.hasPose())
      throw Unavailable("no odometry or scan has arrived yet: the robot's pose is unknown");
    begin(Client::kMoveBase, parseMoveBase(*goal), default_time_limit_s_);
  });
  if (status.code != kr3_msgs::Status::OK)
    move_base_.setAborted({}, status.message);
}

DriveGoal DriveServers::parseMoveBase(const move_base_msgs::MoveBaseGoal& goal) const
{
  const std::string& frame = goal.target_pose.header.frame_id;
  if (frame != map_frame_)
    throw InvalidArgument("the goal is in frame '" + frame + "', expected '" + map_frame_ + "'");
  const Pose pose = fromMsg(goal.target_pose.pose);
  return {pose.position(), pose.yaw};
}

void DriveServers::onMoveToGoal()
{
  cancelPresent("a new goal took over");
  const auto goal = move_to_.acceptNewGoal();
  kr3_msgs::ExecuteSkillResult result;
  respond(result.status, names::kMoveTo, [&] {
    const std::size_t cell = parseMoveTo(*goal);
    if (!context_.tracker.hasPose())
      throw Unavailable("no odometry or scan has arrived yet: the robot's pose is unknown");
    target_cell_ = cell;
    const double limit = goal->time_limit.toSec();
    begin(Client::kMoveTo, {chooseStand(), std::nullopt},
          limit > 0.0 ? limit : default_time_limit_s_);
  });
  if (result.status.code != kr3_msgs::Status::OK)
    move_to_.setAborted(result, result.status.message);
}

Point DriveServers::chooseStand() const
{
  return presentStand(context_.cells().cells()[target_cell_], cell_options_, context_.planner());
}

std::size_t DriveServers::parseMoveTo(const kr3_msgs::ExecuteSkillGoal& goal) const
{
  if (!goal.skill.empty() && goal.skill != "move_to")
    throw InvalidArgument("the skill '" + goal.skill + "', expected 'move_to'");
  if (goal.arguments.size() != 1)
    throw InvalidArgument(std::to_string(goal.arguments.size()) +
                          " arguments, expected 1: the name of a cell");
  if (goal.time_limit.toSec() < 0.0)
    throw InvalidArgument("a time limit of " + std::to_string(goal.time_limit.toSec()) + " s");
  const CellMap& cells = context_.cells();
  const std::optional<std::size_t> cell = cells.find(goal.arguments[0]);
  if (!cell)
    throw InvalidArgument("there is no cell '" + goal.arguments[0] + "'; the nearest name is '" +
                          cells.nearestName(goal.arguments[0]) + "'");
  return *cell;
}

void DriveServers::begin(Client client, const DriveGoal& goal, double time_limit_s)
{
  client_ = client;
  driver_.start(goal);
  start_time_s_ = feedback_time_s_ = context_.tracker.poseTime();
  time_limit_s_ = time_limit_s;
}

void DriveServers::onPreempt(Client client)
{
  // A goal of a server that is not the present client was answered before; there is nothing to
  // stop.
  if (client_ == client)
    cancelPresent("cancelled by the client");
}

void DriveServers::cancelPresent(const std::string& why)
{
  const Client client = client_;
  client_ = Client::kNone;
  driver_.cancel();
  hold();
  if (client == Client::kMoveBase)
    move_base_.setPreempted({}, why);
  if (client == Client::kMoveTo)
  {
    kr3_msgs::ExecuteSkillResult result = moveToResult();
    result.status = makeStatus(ErrorCode::kCancelled, why);
    move_to_.setPreempted(result, why);
  }
}

void DriveServers::stop()
{
  cancelPresent("navigation stops");
}

void DriveServers::hold()
{
  if (wheels_turn_)
    context_.command(Velocity{});
  wheels_turn_ = false;
}

void DriveServers::tick(const DriveInput& input)
{
  if (client_ == Client::kNone)
    return;
  if (input.time_s < start_time_s_)  // the clock started again
    start_time_s_ = feedback_time_s_ = input.time_s;
  if (input.time_s - start_time_s_ > time_limit_s_)
  {
    driver_.cancel();
    hold();
    finishAtTimeLimit();
    return;
  }
  if (client_ == Client::kMoveTo && input.map_changed &&
      !context_.planner().isInMainRegion(driver_.goal().position))
    driver_.redirect({chooseStand(), std::nullopt});
  const Velocity velocity = driver_.step(input);
  if (!driver_.isActive())
  {
    hold();
    finish();
    return;
  }
  context_.command(velocity);
  wheels_turn_ = true;
  if (input.time_s - feedback_time_s_ >= kFeedbackPeriod)
    publishFeedback(input);
}

void DriveServers::publishFeedback(const DriveInput& input)
{
  feedback_time_s_ = input.time_s;
  if (client_ == Client::kMoveTo)
  {
    kr3_msgs::ExecuteSkillFeedback feedback;
    feedback.phase = toString(driver_.phase());
    feedback.progress = driver_.progress();
    move_to_.publishFeedback(feedback);
    return;
  }
  move_base_msgs::MoveBaseFeedback feedback;
  feedback.base_position.header.frame_id = map_frame_;
  feedback.base_position.header.stamp = ros::Time(input.time_s);
  feedback.base_position.pose = toMsg(input.pose);
  move_base_.publishFeedback(feedback);
}

void DriveServers::finish()
{
  const std::string failure =
      driver_.phase() == DrivePhase::kUnreachable
          ? context_.why_unreachable(driver_.goal().position, driver_.reason())
          : "";
  if (!failure.empty())
    ROS_WARN("unreachable: %s", failure.c_str());
  const Client client = client_;
  client_ = Client::kNone;
  if (client == Client::kMoveBase)
    finishMoveBase(failure);
  else
    finishMoveTo(failure);
}

void DriveServers::finishMoveBase(const std::string& failure)
{
  if (failure.empty())
    move_base_.setSucceeded({}, "reached");
  else
    move_base_.setAborted({}, "unreachable: " + failure);
}

void DriveServers::finishMoveTo(const std::string& failure)
{
  kr3_msgs::ExecuteSkillResult result = moveToResult();
  if (!failure.empty())
    result.outcome = "unreachable";
  move_to_.setSucceeded(result, failure.empty() ? failure : "unreachable: " + failure);
}

void DriveServers::finishAtTimeLimit()
{
  const Client client = client_;
  client_ = Client::kNone;
  const std::string why = "not there after " + std::to_string(time_limit_s_) + " s";
  ROS_WARN("drive: %s", why.c_str());
  if (client == Client::kMoveBase)
  {
    move_base_.setAborted({}, why);
    return;
  }
  kr3_msgs::ExecuteSkillResult result = moveToResult();
  result.status = makeStatus(ErrorCode::kDeadlineExceeded, why);
  move_to_.setAborted(result, why);
}

kr3_msgs::ExecuteSkillResult DriveServers::moveToResult() const
{
  const CellMap& cells = context_.cells();
  const std::size_t here = cells.cellAt(context_.tracker.pose().position());
  kr3_msgs::ExecuteSkillResult result;
  result.status = okStatus();
  result.outcome = here == target_cell_ ? "reached" : "slipped";
  result.observation = {cells.cells()[here].name};
  result.confidence =
      std::max(kLeastConfidence, context_.tracker.probabilityIn(cells.cells()[here].rectangle));
  result.duration_s = context_.tracker.poseTime() - start_time_s_;
  return result;
}

}  // namespace kr3::navigation
