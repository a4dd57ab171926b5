#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>

#include <actionlib/server/simple_action_server.h>
#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/node_handle.h>

#include <kr3_msgs/GetPolicyAction.h>
#include <kr3_msgs/SolveAction.h>
#include <kr3_msgs/UpdateBelief.h>

#include "kr3_pomdp/policy_cache.hpp"

namespace kr3::pomdp
{

/// Parameters of the policy node; config/policy_node.yaml says what they mean.
struct PolicyNodeConfig
{
  double default_precision = 0.01;
  double max_time_s = 60.0;
  double feedback_period_s = 0.25;
  int cache_megabytes = 512;
};

/// @throws InvalidArgument  listing everything wrong with the parameters
[[nodiscard]] PolicyNodeConfig loadPolicyNodeConfig(const ros::NodeHandle& private_nh);

/// Solves models on request, and answers what to do and what to believe.
///
/// Solving runs in the action server's own thread, so that the services answer meanwhile; the cache
/// is shared under a mutex.
class PolicyNode
{
public:
  PolicyNode(ros::NodeHandle nh, const ros::NodeHandle& private_nh, const PolicyNodeConfig& config);
  ~PolicyNode();
  PolicyNode(const PolicyNode&) = delete;
  PolicyNode& operator=(const PolicyNode&) = delete;

private:
  using SolveServer = actionlib::SimpleActionServer<kr3_msgs::SolveAction>;

  void onSolve(const kr3_msgs::SolveGoalConstPtr& goal);
  kr3_msgs::SolveResult solveGoal(const kr3_msgs::SolveGoal& goal);
  bool onGetAction(kr3_msgs::GetPolicyAction::Request& request,
                   kr3_msgs::GetPolicyAction::Response& response);
  bool onUpdateBelief(kr3_msgs::UpdateBelief::Request& request,
                      kr3_msgs::UpdateBelief::Response& response);
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status);

  /// @throws NotFound  no such policy (any more)
  std::shared_ptr<const SolvedModel> policy(const std::string& id);

  PolicyNodeConfig config_;
  std::mutex mutex_;  // guards the members down to `solving_`
  PolicyCache cache_;
  std::uint64_t num_solved_ = 0;
  std::uint64_t num_cached_ = 0;
  bool solving_ = false;

  diagnostic_updater::Updater diagnostics_;
  ros::WallTimer diagnostics_timer_;
  ros::ServiceServer get_action_;
  ros::ServiceServer update_belief_;
  SolveServer solve_;
};

}  // namespace kr3::pomdp
