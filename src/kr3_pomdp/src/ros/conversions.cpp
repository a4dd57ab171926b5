#include "conversions.hpp"

#include <cmath>

#include <kr3_common/error.hpp>
#include <kr3_common/ros/status.hpp>

namespace kr3::pomdp
{

namespace
{

ros::Duration durationOf(double seconds)
{
  return ros::Duration(seconds);
}

std::uint32_t count(std::size_t n)
{
  return static_cast<std::uint32_t>(n);
}

}  // namespace

SolveRequest fromMsg(const kr3_msgs::SolveGoal& goal, const GoalLimits& limits)
{
  const double time_s = goal.time_limit.toSec();
  if (!std::isfinite(goal.precision) || goal.precision < 0.0)
  {
    throw InvalidArgument("precision " + std::to_string(goal.precision) +
                          ", expected it finite and >= 0");
  }
  if (time_s < 0.0 || time_s > limits.max_time_s)
  {
    throw InvalidArgument("time limit " + std::to_string(time_s) + " s, expected it in [0, " +
                          std::to_string(limits.max_time_s) + "] s (parameter max_time_s)");
  }
  if (goal.max_memory_bytes > limits.max_search_bytes)
  {
    throw InvalidArgument("memory limit " + std::to_string(goal.max_memory_bytes) +
                          " bytes, expected at most " + std::to_string(limits.max_search_bytes) +
                          " (parameter max_search_megabytes)");
  }
  if (goal.num_threads > static_cast<std::uint32_t>(limits.max_threads))
  {
    throw InvalidArgument(std::to_string(goal.num_threads) + " threads, expected at most " +
                          std::to_string(limits.max_threads) + " (parameter max_threads)");
  }
  SolveRequest request;
  request.model = checkedModelText(goal.format, goal.model, limits.max_model_bytes);
  request.limits.precision = goal.precision > 0.0 ? goal.precision : limits.default_precision;
  request.limits.time_s = time_s > 0.0 ? time_s : limits.max_time_s;
  request.limits.max_backups = goal.max_backups;
  request.limits.max_memory_bytes =
      goal.max_memory_bytes > 0 ? goal.max_memory_bytes : limits.max_search_bytes;
  request.limits.num_threads = goal.num_threads > 0 ? static_cast<int>(goal.num_threads) : 1;
  request.ignore_cache = goal.ignore_cache != 0;
  return request;
}

Belief beliefFromMsg(const std::vector<double>& belief, const std::vector<std::uint32_t>& states,
                     std::size_t num_states)
{
  const std::size_t expected = states.empty() ? num_states : states.size();
  if (belief.size() != expected)
  {
    throw InvalidArgument("belief over " + std::to_string(belief.size()) + " states, expected " +
                          std::to_string(expected));
  }
  if (states.empty())
  {
    return Belief(belief);
  }
  std::vector<SparseEntry> entries;
  for (std::size_t i = 0; i < states.size(); ++i)
  {
    entries.push_back({states[i], belief[i]});
  }
  return dense(entries, num_states);
}

kr3_msgs::SolveFeedback toMsg(const SolveReport& report)
{
  kr3_msgs::SolveFeedback feedback;
  feedback.lower_bound = report.progress.lower;
  feedback.upper_bound = report.progress.upper;
  feedback.backups = report.progress.backups;
  feedback.num_alpha_vectors = count(report.progress.num_alpha_vectors);
  feedback.memory_bytes = report.progress.memory_bytes;
  feedback.elapsed_s = report.progress.elapsed_s;
  feedback.num_ahead = count(report.num_ahead);
  switch (report.phase)
  {
    case SolvePhase::kQueued:
      feedback.phase = kr3_msgs::SolveFeedback::QUEUED;
      break;
    case SolvePhase::kReading:
      feedback.phase = kr3_msgs::SolveFeedback::READING;
      break;
    case SolvePhase::kSolving:
      feedback.phase = kr3_msgs::SolveFeedback::SOLVING;
      break;
  }
  return feedback;
}

kr3_msgs::SolveResult toMsg(const SolveOutcome& outcome)
{
  const SolvedModel& solved = *outcome.solved;
  kr3_msgs::SolveResult result;
  result.status = okStatus();
  result.policy_id = outcome.id;
  result.cached = static_cast<std::uint8_t>(outcome.cached);
  result.lower_bound = solved.lower;
  result.upper_bound = solved.upper;
  result.backups = solved.backups;
  result.num_alpha_vectors = count(solved.policy ? solved.policy->numAlphaVectors() : 0);
  result.cpu_s = solved.cpu_s;
  result.stop_reason = solved.reasonText();
  result.wall_s = solved.elapsed_s;
  result.memory_bytes = solved.search_memory_bytes;
  return result;
}

kr3_msgs::PolicySummary toMsg(const StoredPolicy& stored)
{
  const SolvedModel& solved = *stored.solved;
  kr3_msgs::PolicySummary summary;
  summary.policy_id = stored.id;
  summary.num_states = count(solved.model().numStates());
  summary.num_actions = count(solved.model().numActions());
  summary.num_observations = count(solved.model().numObservations());
  summary.discount = solved.model().discount();
  summary.num_alpha_vectors = count(solved.policy ? solved.policy->numAlphaVectors() : 0);
  summary.lower_bound = solved.lower;
  summary.upper_bound = solved.upper;
  summary.backups = solved.backups;
  summary.stop_reason = solved.reasonText();
  summary.memory_bytes = stored.bytes;
  summary.age = durationOf(stored.age_s);
  summary.idle = durationOf(stored.idle_s);
  summary.num_beliefs = count(stored.num_beliefs);
  return summary;
}

kr3_msgs::BeliefSummary toMsg(const StoredBelief& stored)
{
  kr3_msgs::BeliefSummary summary;
  summary.belief_id = stored.id;
  summary.policy_id = stored.policy_id;
  summary.version = stored.belief->version();
  summary.num_nonzero = count(stored.belief->numNonzero());
  summary.memory_bytes = stored.belief->sizeInBytes();
  summary.age = durationOf(stored.age_s);
  summary.idle = durationOf(stored.idle_s);
  return summary;
}

}  // namespace kr3::pomdp
