#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "observed_model.hpp"

namespace kr3::pomdp
{

/// First bounds of the values of a model with discount 1, where sums of rewards have a bound only
/// because runs end.
struct UndiscountedBounds
{
  /// No policy earns more, shape [num_states of the model]; a backup of it is nowhere above it. 0
  /// in states that cannot be reached.
  std::vector<double> upper;
  /// What the base plan earns at least, shape [num_states of the model]; a backup of it is nowhere
  /// below it. Hugely negative in states that cannot be reached.
  std::vector<double> lower;
  /// The base plan does this action for ever; without it, it picks one at random at each step.
  std::optional<std::size_t> base_action;
};

/// Bounds for models in which each run ends, or costs something at each step of a part that it
/// never leaves: states are finished when all that follows earns 0, and every end component (a set
/// of states and actions that the robot can keep to) of the others has negative rewards only. Then
/// going on for ever is never worth it, and the value is that of a stochastic shortest path.
///
/// @param keep_going  asked between sweeps over the states; the bounds are sound whenever it stops,
///                    once they are there at all
/// @throws InvalidArgument    some run need not end and earns something or nothing for ever, or
/// ends
///                            nowhere; the message names the state
/// @throws ResourceExhausted  runs that take more than about 1e5 steps to end
/// Sources: Bertsekas and Tsitsiklis (1991), stochastic shortest paths; Horak, Bosansky and
/// Chatterjee (2018), Goal-HSVI: the lower bound from random actions; end components: de Alfaro
/// (1997).
[[nodiscard]] UndiscountedBounds undiscountedBounds(const ObservedModel& model,
                                                    const std::function<bool()>& keep_going);

/// The value of doing `action` and then what the base plan does, shape [num_states].
[[nodiscard]] std::vector<double> thenBasePlan(const Model& model, const UndiscountedBounds& bounds,
                                               std::size_t action);

}  // namespace kr3::pomdp
