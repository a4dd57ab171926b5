#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <kr3_pomdp/model.hpp>

namespace kr3::refinement
{

/// States that can come about from the initial belief by some actions, shape [states].
[[nodiscard]] std::vector<bool> reachableStates(const pomdp::Model& model);

/// Which variables the robot always knows: their values are certain at the start, and after every
/// action they follow from those before it, the action and the observation.
///
/// @param labels  the value of each variable in each state, shape [states][variables]
/// @return the greatest such set, shape [variables]
/// Source: the condition of mixed observability, Ong, Png, Hsu and Lee (2010).
[[nodiscard]] std::vector<bool> knownVariables(
    const pomdp::Model& model, const std::vector<std::vector<std::uint32_t>>& labels);

}  // namespace kr3::refinement
