#pragma once

#include <cstddef>
#include <string>

#include <kr3_msgs/SolveFeedback.h>
#include <kr3_msgs/SolveGoal.h>
#include <kr3_msgs/SolveResult.h>

#include "kr3_pomdp/policy_cache.hpp"

namespace kr3::pomdp
{

/// What a goal that leaves a limit at 0 gets.
struct LimitDefaults
{
  double precision;
  double max_time_s;  ///< also the most that a goal may ask for
};

/// @throws InvalidArgument  another format than "pomdp", a negative or not finite limit, or more
///                          time than allowed
[[nodiscard]] SolverLimits limitsFromGoal(const kr3_msgs::SolveGoal& goal,
                                          const LimitDefaults& defaults);

/// Everything that the answer to a goal depends on, as text.
[[nodiscard]] std::string keyOf(const kr3_msgs::SolveGoal& goal, const SolverLimits& limits);

[[nodiscard]] kr3_msgs::SolveFeedback toMsg(const SolverProgress& progress);
[[nodiscard]] kr3_msgs::SolveResult toMsg(const SolvedModel& solved, const std::string& id,
                                          bool cached);

/// @throws InvalidArgument  the model has no action (observation) of this name
[[nodiscard]] std::size_t actionNamed(const Model& model, const std::string& name);
[[nodiscard]] std::size_t observationNamed(const Model& model, const std::string& name);

}  // namespace kr3::pomdp
