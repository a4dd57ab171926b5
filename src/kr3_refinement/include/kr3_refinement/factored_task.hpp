#pragma once

#include <cstddef>
#include <vector>

#include <kr3_pomdp/factored_model.hpp>

#include "kr3_refinement/pomdp_task.hpp"

namespace kr3::refinement
{

/// The POMDP of a task in factors, and how its states are those of the task.
struct FactoredTask
{
  /// State variables: `task` (`running`, `boundary` where an outcome can leave the zoom, `done`),
  /// then one for each fluent of the task in its order. Variables that the robot always knows are
  /// marked as observed. One action variable; an observation variable for each fluent that is
  /// observed, `none` where an action tells nothing of it, except where the observed variables say
  /// it all.
  pomdp::FactoredModel model;

  /// The value of each state variable in each state of the task, shape [task states][variables].
  /// Of the boundary and of the done state this is one of several: there only `task` matters.
  std::vector<std::vector<std::size_t>> values;
};

/// The task's POMDP as a dynamic Bayesian network that says exactly the same (docs/refinement.md).
///
/// - Transitions and the initial belief follow the chain rule in the order of the variables: a
///   variable's parents are those earlier variables, after and before the action, without which
///   its probabilities would not be the same in some state. So fluents that state constraints
///   couple (what is held is where the robot is) need no common variable.
/// - A variable is observed when its value follows from what the robot has seen at any time from
///   the initial belief on. A fluent whose value is not certain at the start is therefore hidden,
///   however exact its sensors.
/// - Combinations of values that no state of the task has are never reached; what happens there
///   means nothing.
///
/// Cost: for each variable, (actions x states x outcomes) x (variables)^2.
///
/// @throws ResourceExhausted  a factor with more than 2^27 entries
[[nodiscard]] FactoredTask factored(const PomdpTask& task);

}  // namespace kr3::refinement
