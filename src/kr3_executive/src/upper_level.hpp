#pragma once

#include <atomic>
#include <cstddef>
#include <memory>

#include "coarse_plan.hpp"
#include "coarse_policy.hpp"
#include "flat_model.hpp"
#include "kr3_executive/interfaces.hpp"

namespace kr3::executive
{

struct UpperLevelOptions
{
  CoarsePolicy::Limits limits;
  SolveBudget lower;
  double threshold = 0.85;
  std::size_t samples = 100;  ///< simulated runs of each option
};

/// The upper level, whose options are carried out by policies that the upper level itself pays.
///
/// At first a lower policy is paid for success by the seconds that it saves
/// (CoarsePlan::worthSeconds); the upper level solved with what these do gives what ending is
/// worth, for which the lower policies are solved anew, and so on a few times.
/// @param plan  must outlive the result
/// @throws ResourceExhausted  it is larger than the limits
[[nodiscard]] std::shared_ptr<CoarsePolicy> solvedUpperLevel(
    CoarsePlan& plan, const CoarseBelief& start, const Objective& objective, PolicyServer& policies,
    const UpperLevelOptions& options, const std::atomic<bool>& cancel);

}  // namespace kr3::executive
