#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "kr3_pomdp/model.hpp"

namespace kr3::pomdp
{

/// Where the runs of a model can stay for ever, whatever is observed.
struct EndComponents
{
  /// The states in question, ascending: those given.
  std::vector<std::uint32_t> states;
  /// Of each state of the model: whether it and all that follows earns 0.
  std::vector<bool> finished;
  /// Of each state of the model: the number of its component. A state outside end components, and
  /// each finished one, has its own.
  std::vector<std::uint32_t> component;
  /// Whether an action keeps to the end component of a state that is not finished; row-major, shape
  /// [num_actions, num_states].
  std::vector<bool> keeps;
};

/// The maximal end components among states that no action leaves: sets of states and actions such
/// that the actions stay inside and lead from each state to each.
///
/// @param states  ascending, closed under all actions
/// Source: de Alfaro (1997), Formal verification of probabilistic systems, Sec. 3.3.
[[nodiscard]] EndComponents endComponents(const Model& model, std::vector<std::uint32_t> states);

}  // namespace kr3::pomdp
