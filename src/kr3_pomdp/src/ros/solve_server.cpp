#include "solve_server.hpp"

#include <utility>

#include <kr3_common/error.hpp>
#include <kr3_common/ros/status.hpp>

#include "kr3_pomdp/names.hpp"

namespace kr3::pomdp
{

namespace
{

using GoalHandle = actionlib::ActionServer<kr3_msgs::SolveAction>::GoalHandle;

/// What a failed goal gets.
kr3_msgs::SolveResult failure(const std::exception_ptr& error)
{
  kr3_msgs::SolveResult result;
  respond(result.status, "solve", [&error] { std::rethrow_exception(error); });
  return result;
}

/// Accepts a goal that was not accepted before.
void accept(GoalHandle& goal)
{
  const auto status = goal.getGoalStatus().status;
  if (status == actionlib_msgs::GoalStatus::PENDING ||
      status == actionlib_msgs::GoalStatus::RECALLING)
  {
    goal.setAccepted();
  }
}

void finish(GoalHandle goal, const SolveOutcome& outcome)
{
  const kr3_msgs::SolveResult result = outcome.error ? failure(outcome.error) : toMsg(outcome);
  if (outcome.cancelled)
  {
    goal.setCanceled(
        result, outcome.error ? result.status.message : "preempted; the policy is the best so far");
    return;
  }
  accept(goal);
  if (outcome.error)
  {
    goal.setAborted(result, result.status.message);
  }
  else
  {
    goal.setSucceeded(result);
  }
}

}  // namespace

SolveServer::SolveServer(ros::NodeHandle nh, SolveQueue& queue, const GoalLimits& limits,
                         bool cancel_abandoned)
  : queue_(queue)
  , limits_(limits)
  , server_(
        nh, names::kSolve, [this](Goal goal) { onGoal(std::move(goal)); },
        [this](const Goal& goal) { onCancel(goal); }, false)
{
  server_.start();
  if (cancel_abandoned)
  {
    constexpr std::uint32_t kQueueSize = 50;
    watched_results_ = nh.advertise<kr3_msgs::SolveActionResult>(
        std::string(names::kSolve) + "/result", kQueueSize, ros::SubscriberStatusCallback(),
        [this](const ros::SingleSubscriberPublisher& client) {
      onClientGone(client.getSubscriberName());
        });
  }
}

void SolveServer::onGoal(Goal goal)
{
  try
  {
    SolveRequest request = fromMsg(*goal.getGoal(), limits_);
    SolveQueue::Callbacks callbacks;
    callbacks.report = [goal](const SolveReport& report) mutable {
      if (report.phase != SolvePhase::kQueued)
      {
        accept(goal);
      }
      goal.publishFeedback(toMsg(report));
    };
    callbacks.done = [goal](const SolveOutcome& outcome) { finish(goal, outcome); };
    queue_.submit(goal.getGoalID().id, std::move(request), std::move(callbacks));
  }
  catch (...)
  {
    finish(goal, {"", nullptr, false, false, std::current_exception()});
  }
}

void SolveServer::onCancel(const Goal& goal)
{
  const std::string id = goal.getGoalID().id;
  queue_.cancelIf([&id](const std::string& key) { return key == id; });
}

void SolveServer::onClientGone(const std::string& client)
{
  // actionlib's clients, in C++ and in Python, name their goals after their node.
  const std::string prefix = client + '-';
  const std::size_t count = queue_.cancelIf(
      [&prefix](const std::string& key) { return key.compare(0, prefix.size(), prefix) == 0; });
  if (count > 0)
  {
    ROS_WARN("cancelled %zu goals of '%s', which went away", count, client.c_str());
  }
}

}  // namespace kr3::pomdp
