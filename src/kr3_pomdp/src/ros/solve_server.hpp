#pragma once

#include <memory>
#include <string>

#include <actionlib/server/action_server.h>
#include <ros/node_handle.h>

#include <kr3_msgs/SolveAction.h>

#include "conversions.hpp"
#include "kr3_pomdp/solve_queue.hpp"

namespace kr3::pomdp
{

/// The action that solves models: each goal becomes a request in a queue, so that several clients
/// have goals at the same time. Its callbacks run where the callback queue of its node handle is
/// served.
class SolveServer
{
public:
  /// @param queue             outlives this object, and is stopped before it ends
  /// @param cancel_abandoned  goals end when their client's node no longer listens to results
  SolveServer(ros::NodeHandle nh, SolveQueue& queue, const GoalLimits& limits,
              bool cancel_abandoned);
  SolveServer(const SolveServer&) = delete;
  SolveServer& operator=(const SolveServer&) = delete;

private:
  using Server = actionlib::ActionServer<kr3_msgs::SolveAction>;
  using Goal = Server::GoalHandle;

  void onGoal(Goal goal);
  void onCancel(const Goal& goal);
  void onClientGone(const std::string& client);

  SolveQueue& queue_;
  const GoalLimits limits_;
  ros::Publisher watched_results_;  // the action's result topic, for who leaves it
  Server server_;
};

}  // namespace kr3::pomdp
