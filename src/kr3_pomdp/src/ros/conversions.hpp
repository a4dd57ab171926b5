#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <kr3_msgs/BeliefSummary.h>
#include <kr3_msgs/PolicySummary.h>
#include <kr3_msgs/SolveFeedback.h>
#include <kr3_msgs/SolveGoal.h>
#include <kr3_msgs/SolveResult.h>

#include "kr3_pomdp/solve_queue.hpp"

namespace kr3::pomdp
{

/// What a goal that leaves a limit at 0 gets, and the most that it may ask for.
struct GoalLimits
{
  double default_precision;
  double max_time_s;             ///< also the default
  std::size_t max_search_bytes;  ///< also the default
  int max_threads;               ///< the default is 1
  std::size_t max_model_bytes;   ///< of the text
};

/// @throws InvalidArgument    an unknown format, no model, a limit that is negative or not finite,
/// or
///                            more of it than allowed
/// @throws ResourceExhausted  a model that is longer than allowed
[[nodiscard]] SolveRequest fromMsg(const kr3_msgs::SolveGoal& goal, const GoalLimits& limits);

/// A belief from a message: one entry for each state, or for each of `states` when there are any.
///
/// @param num_states  of the model
/// @throws InvalidArgument  shapes that do not fit, states out of order or range, entries that make
///                          no belief
[[nodiscard]] Belief beliefFromMsg(const std::vector<double>& belief,
                                   const std::vector<std::uint32_t>& states,
                                   std::size_t num_states);

[[nodiscard]] kr3_msgs::SolveFeedback toMsg(const SolveReport& report);
/// @param outcome  with a policy
[[nodiscard]] kr3_msgs::SolveResult toMsg(const SolveOutcome& outcome);
[[nodiscard]] kr3_msgs::PolicySummary toMsg(const StoredPolicy& stored);
[[nodiscard]] kr3_msgs::BeliefSummary toMsg(const StoredBelief& stored);

/// Fills the fields of a response that say what to do; `action` is the one for its name.
template <typename Response>
void fillChoice(const SolvedModel& solved, const Belief& belief, Response& response,
                std::string& action)
{
  const std::optional<Policy::Choice> choice = choiceAt(solved, belief);
  response.has_action = static_cast<std::uint8_t>(choice.has_value());
  if (choice)
  {
    response.action_index = static_cast<std::uint32_t>(choice->action);
    action = solved.model().actionName(choice->action);
    response.value = choice->value;
  }
}

}  // namespace kr3::pomdp
