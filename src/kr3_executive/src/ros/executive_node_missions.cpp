// The part of ExecutiveNode that begins, ends and keeps missions.

#include <algorithm>
#include <chrono>
#include <utility>

#include <kr3_common/error.hpp>
#include <kr3_common/ros/status.hpp>

#include "executive_node.hpp"
#include "kr3_executive/knowledge_file.hpp"

namespace kr3::executive
{
namespace
{

constexpr double kLeastTimeLeft_s = 1e-3;  // 0 would mean no limit

ErrorCode codeOf(const std::exception& e)
{
  const auto* error = dynamic_cast<const Error*>(&e);
  return error == nullptr ? ErrorCode::kInternal : error->code();
}

}  // namespace

void ExecutiveNode::restoreKnowledge()
{
  if (config_.state_file.empty())
    return;
  if (auto knowledge = readKnowledge(config_.state_file))
  {
    driver_->setKnowledge(std::move(*knowledge));
    ROS_INFO("picked up %zu records from %s", driver_->knowledge().history.size(),
             config_.state_file.c_str());
  }
  under_way_ = readMissionUnderWay(config_.state_file);
  mission_start_s_ = clock_.now().toSec();
}

void ExecutiveNode::onAchieve(const kr3_msgs::AchieveGoalConstPtr& goal)
{
  kr3_msgs::AchieveResult result;
  endResumedMission();  // a new goal takes its place
  try
  {
    const MissionResult mission = runMission(
        {goal->goal,
         goal->max_hl_actions > 0 ? goal->max_hl_actions : config_.driver.limits.max_hl_actions,
         goal->time_limit.toSec()});
    result.status = makeStatus(mission.code, mission.code == ErrorCode::kOk ? "" : mission.reason);
    result.achieved = mission.achieved;
    result.reason = mission.reason;
    result.hl_actions = mission.hl_actions;
    result.ll_actions = mission.ll_actions;
    result.duration_s = mission.duration_s;
  }
  catch (const std::exception& e)
  {
    result.status = makeStatus(codeOf(e), e.what());
    result.reason = e.what();
  }
  if (result.status.code == kr3_msgs::Status::OK)
    achieve_->setSucceeded(result);
  else if (result.status.code == kr3_msgs::Status::CANCELLED)
    achieve_->setPreempted(result);
  else
  {
    logFailure("achieve '" + goal->goal + "'", result.status);
    achieve_->setAborted(result);
  }
}

MissionResult ExecutiveNode::runMission(const MissionUnderWay& mission)
{
  Limits limits = config_.driver.limits;
  limits.max_hl_actions = mission.max_hl_actions;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    under_way_ = mission;
    mission_start_s_ = clock_.now().toSec();
  }
  const Thinking thinking(pace_.get());
  const auto over = [this] {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      under_way_.reset();
    }
    save();
  };
  try
  {
    const MissionResult result =
        driver_->achieve(mission.goal, scenario_.initial_records, limits, mission.time_left_s);
    const bool cut_off = stopping_ || (result.code == ErrorCode::kUnavailable && !ros::ok());
    if (!cut_off)
      over();
    return result;
  }
  catch (const InvalidArgument&)
  {
    over();
    throw;
  }
}

void ExecutiveNode::resumeMission()
{
  const std::optional<MissionUnderWay> mission = under_way_;  // no mission runs yet
  if (!mission)
    return;
  ROS_INFO("going on with '%s'", mission->goal.c_str());
  resumed_ = std::async(std::launch::async, [this, mission] {
    try
    {
      const MissionResult result = runMission(*mission);
      ROS_INFO("'%s' ended: %s", mission->goal.c_str(), result.reason.c_str());
    }
    catch (const std::exception& e)
    {
      ROS_ERROR("'%s' cannot be taken up again: %s", mission->goal.c_str(), e.what());
    }
  });
}

void ExecutiveNode::endResumedMission()
{
  while (resumed_.valid() &&
         resumed_.wait_for(std::chrono::milliseconds(20)) != std::future_status::ready)
    driver_->cancel();  // again, as it may not have begun
}

bool ExecutiveNode::onCancel(std_srvs::Trigger::Request& /*request*/,
                             std_srvs::Trigger::Response& response)
{
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    response.success = static_cast<unsigned char>(under_way_.has_value());
  }
  driver_->cancel();
  response.message = response.success != 0 ? "the mission ends" : "no mission is under way";
  return true;
}

void ExecutiveNode::save()
{
  if (config_.state_file.empty() || !driver_)
    return;
  std::optional<MissionUnderWay> mission;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    mission = under_way_;
    if (mission)
    {
      const std::uint32_t done = snapshot_.state.hl_actions_done;
      mission->max_hl_actions = mission->max_hl_actions > done ? mission->max_hl_actions - done : 1;
      if (mission->time_left_s > 0.0)
      {
        const double elapsed_s = clock_.now().toSec() - mission_start_s_;
        mission->time_left_s = std::max(kLeastTimeLeft_s, mission->time_left_s - elapsed_s);
      }
    }
  }
  try
  {
    writeKnowledge(config_.state_file, driver_->knowledge(), mission);
  }
  catch (const Error& e)
  {
    ROS_ERROR_THROTTLE(10.0, "the history is not kept: %s", e.what());
  }
}

}  // namespace kr3::executive
