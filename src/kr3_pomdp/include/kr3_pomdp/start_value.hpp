#pragma once

#include "kr3_pomdp/model.hpp"
#include "kr3_pomdp/policy.hpp"

namespace kr3::pomdp
{

/// A policy's own value before anything is seen: at the initial belief, or its expectation over the
/// model's initial outcomes. A lower bound for a policy of solve(); others promise nothing.
/// @throws InvalidArgument  a policy for another number of states
[[nodiscard]] inline double startValue(const Model& model, const Policy& policy)
{
  double value = 0.0;
  for (const InitialOutcome& outcome : model.initialOutcomes())
  {
    value += outcome.probability * policy.valueAt(outcome.belief);
  }
  return value;
}

}  // namespace kr3::pomdp
