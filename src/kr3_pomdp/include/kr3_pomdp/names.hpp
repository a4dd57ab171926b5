#pragma once

namespace kr3::pomdp::names
{

/// Relative names of the policy server's interfaces.
inline constexpr const char* kSolve = "pomdp/solve";
inline constexpr const char* kGetAction = "pomdp/get_action";
inline constexpr const char* kUpdateBelief = "pomdp/update_belief";

}  // namespace kr3::pomdp::names
