#pragma once

#include "kr3_pomdp/model.hpp"

namespace kr3::pomdp
{

/// The model with its sensors made noise-free: after an action the robot sees which group the next
/// state is in, where a group is the states that give the same distribution of observations. What
/// the real sensor says can be sampled from the group, so the robot with these sensors can do
/// whatever the real one can, and no policy of the real model earns more than its optimum.
///
/// Source: Blackwell (1953), Equivalent comparisons of experiments.
[[nodiscard]] Model withNoiseFreeSensors(const Model& model);

}  // namespace kr3::pomdp
