#include "conversions.hpp"

#include <cmath>
#include <cstdint>
#include <cstdio>

#include <kr3_common/error.hpp>
#include <kr3_common/ros/status.hpp>

namespace kr3::pomdp
{

SolverLimits limitsFromGoal(const kr3_msgs::SolveGoal& goal, const LimitDefaults& defaults)
{
  if (goal.format != "pomdp")
  {
    throw InvalidArgument("format '" + goal.format + "', expected 'pomdp'");
  }
  const double time_s = goal.time_limit.toSec();
  if (!std::isfinite(goal.precision) || goal.precision < 0.0)
  {
    throw InvalidArgument("precision " + std::to_string(goal.precision) +
                          ", expected it finite and >= 0");
  }
  if (time_s < 0.0 || time_s > defaults.max_time_s)
  {
    throw InvalidArgument("time limit " + std::to_string(time_s) + " s, expected it in [0, " +
                          std::to_string(defaults.max_time_s) + "] s (parameter max_time_s)");
  }
  SolverLimits limits;
  limits.precision = goal.precision > 0.0 ? goal.precision : defaults.precision;
  limits.time_s = time_s > 0.0 ? time_s : defaults.max_time_s;
  limits.max_backups = goal.max_backups;
  return limits;
}

std::string keyOf(const kr3_msgs::SolveGoal& goal, const SolverLimits& limits)
{
  char text[128];
  std::snprintf(text, sizeof(text), "%.17g %.17g %llu\n", limits.precision, limits.time_s,
                static_cast<unsigned long long>(limits.max_backups));
  return goal.format + ' ' + text + goal.model;
}

kr3_msgs::SolveFeedback toMsg(const SolverProgress& progress)
{
  kr3_msgs::SolveFeedback feedback;
  feedback.lower_bound = progress.lower;
  feedback.upper_bound = progress.upper;
  feedback.backups = progress.backups;
  return feedback;
}

kr3_msgs::SolveResult toMsg(const SolvedModel& solved, const std::string& id, bool cached)
{
  kr3_msgs::SolveResult result;
  result.status = okStatus();
  result.policy_id = id;
  result.cached = static_cast<std::uint8_t>(cached);
  result.lower_bound = solved.result.lower;
  result.upper_bound = solved.result.upper;
  result.backups = solved.result.backups;
  result.num_alpha_vectors = static_cast<std::uint32_t>(solved.result.policy.numAlphaVectors());
  result.cpu_s = solved.result.cpu_s;
  return result;
}

std::size_t actionNamed(const Model& model, const std::string& name)
{
  const auto found = model.findAction(name);
  if (!found)
  {
    throw InvalidArgument("the model has no action '" + name + "'");
  }
  return *found;
}

std::size_t observationNamed(const Model& model, const std::string& name)
{
  const auto found = model.findObservation(name);
  if (!found)
  {
    throw InvalidArgument("the model has no observation '" + name + "'");
  }
  return *found;
}

}  // namespace kr3::pomdp
