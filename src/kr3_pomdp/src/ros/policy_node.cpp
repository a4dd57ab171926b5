#include "policy_node.hpp"

#include <cstdio>
#include <sstream>
#include <utility>
#include <vector>

#include <kr3_common/error.hpp>
#include <kr3_common/ros/param_reader.hpp>
#include <kr3_common/ros/status.hpp>

#include "conversions.hpp"
#include "kr3_pomdp/names.hpp"
#include "kr3_pomdp/pomdp_format.hpp"

namespace kr3::pomdp
{

PolicyNodeConfig loadPolicyNodeConfig(const ros::NodeHandle& private_nh)
{
  PolicyNodeConfig config;
  ParamReader params(private_nh);
  config.default_precision = params.get("default_precision", config.default_precision);
  config.max_time_s = params.get("max_time_s", config.max_time_s);
  config.feedback_period_s = params.get("feedback_period_s", config.feedback_period_s);
  config.cache_megabytes = params.get("cache_megabytes", config.cache_megabytes);
  params.check(config.default_precision > 0.0, "default_precision", "must be positive");
  params.check(config.max_time_s > 0.0, "max_time_s", "must be positive");
  params.check(config.feedback_period_s > 0.0, "feedback_period_s", "must be positive");
  params.check(config.cache_megabytes > 0, "cache_megabytes", "must be positive");
  params.finish();
  return config;
}

PolicyNode::PolicyNode(ros::NodeHandle nh, const ros::NodeHandle& private_nh,
                       const PolicyNodeConfig& config)
  : config_(config)
  , cache_(static_cast<std::size_t>(config.cache_megabytes) << 20)
  , diagnostics_(nh, private_nh)
  , get_action_(nh.advertiseService(names::kGetAction, &PolicyNode::onGetAction, this))
  , update_belief_(nh.advertiseService(names::kUpdateBelief, &PolicyNode::onUpdateBelief, this))
  , solve_(
        nh, names::kSolve, [this](const kr3_msgs::SolveGoalConstPtr& goal) { onSolve(goal); },
        false)
{
  diagnostics_.setHardwareID("none");
  diagnostics_.add("policies", this, &PolicyNode::diagnose);
  diagnostics_timer_ = nh.createWallTimer(
      ros::WallDuration(1.0), [this](const ros::WallTimerEvent&) { diagnostics_.force_update(); });
  solve_.start();
}

PolicyNode::~PolicyNode()
{
  solve_.shutdown();
}

std::shared_ptr<const SolvedModel> PolicyNode::policy(const std::string& id)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  auto found = cache_.find(id);
  if (!found)
  {
    throw NotFound("no policy '" + id + "' (any more): solve the model again");
  }
  return found;
}

void PolicyNode::onSolve(const kr3_msgs::SolveGoalConstPtr& goal)
{
  kr3_msgs::SolveResult result;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    solving_ = true;
  }
  respond(result.status, "solve", [&] { result = solveGoal(*goal); });
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    solving_ = false;
  }
  if (result.status.code != kr3_msgs::Status::OK)
  {
    solve_.setAborted(result, result.status.message);
  }
  else if (solve_.isPreemptRequested() || !ros::ok())
  {
    solve_.setPreempted(result, "preempted; the policy is the best so far");
  }
  else
  {
    solve_.setSucceeded(result);
  }
}

kr3_msgs::SolveResult PolicyNode::solveGoal(const kr3_msgs::SolveGoal& goal)
{
  const SolverLimits limits = limitsFromGoal(goal, {config_.default_precision, config_.max_time_s});
  const std::string key = keyOf(goal, limits);
  const std::string id = contentHash(key);
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (const auto known = cache_.find(id); known && known->key == key)
    {
      ++num_cached_;
      return toMsg(*known, id, true);
    }
  }
  std::istringstream text(goal.model);
  Model model = readPomdp(text, "model");
  double next_feedback_s = 0.0;
  SolveResult solution = solve(model, limits, [&](const SolverProgress& progress) {
    if (progress.elapsed_s >= next_feedback_s)
    {
      solve_.publishFeedback(toMsg(progress));
      next_feedback_s = progress.elapsed_s + config_.feedback_period_s;
    }
    return ros::ok() && !solve_.isPreemptRequested();
  });
  // A preempted run must not answer later requests for the whole one.
  const std::string stored_id = solution.reason == StopReason::kCancelled ? id + "-preempted" : id;
  SolvedModel solved{key, std::move(model), std::move(solution)};
  kr3_msgs::SolveResult reply = toMsg(solved, stored_id, false);
  const std::lock_guard<std::mutex> lock(mutex_);
  cache_.put(stored_id, std::move(solved));
  ++num_solved_;
  return reply;
}

bool PolicyNode::onGetAction(kr3_msgs::GetPolicyAction::Request& request,
                             kr3_msgs::GetPolicyAction::Response& response)
{
  return respond(response.status, "get_action", [&] {
    const auto solved = policy(request.policy_id);
    const Policy::Choice choice = solved->result.policy.bestAt(Belief(request.belief));
    response.action_index = static_cast<std::uint32_t>(choice.action);
    response.action = solved->model.actionName(choice.action);
    response.value = choice.value;
  });
}

bool PolicyNode::onUpdateBelief(kr3_msgs::UpdateBelief::Request& request,
                                kr3_msgs::UpdateBelief::Response& response)
{
  return respond(response.status, "update_belief", [&] {
    const auto solved = policy(request.policy_id);
    const BeliefUpdate update =
        updated(solved->model, Belief(request.belief), actionNamed(solved->model, request.action),
                observationNamed(solved->model, request.observation));
    response.belief = update.posterior.probabilities();
    response.probability = update.probability;
  });
}

void PolicyNode::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  status.summary(diagnostic_msgs::DiagnosticStatus::OK, solving_ ? "solving" : "idle");
  status.add("policies", cache_.size());
  status.add("bytes", cache_.sizeInBytes());
  status.add("solved", num_solved_);
  status.add("answered from the cache", num_cached_);
}

}  // namespace kr3::pomdp
