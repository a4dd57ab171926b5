#pragma once

namespace kr3::pomdp::names
{

/// Relative names of the policy server's interfaces.
inline constexpr const char* kSolve = "pomdp/solve";
inline constexpr const char* kGetAction = "pomdp/get_action";
inline constexpr const char* kUpdateBelief = "pomdp/update_belief";
inline constexpr const char* kListPolicies = "pomdp/list_policies";
inline constexpr const char* kGetPolicyInfo = "pomdp/get_policy_info";
inline constexpr const char* kReleasePolicy = "pomdp/release_policy";
inline constexpr const char* kSavePolicy = "pomdp/save_policy";
inline constexpr const char* kLoadPolicy = "pomdp/load_policy";
inline constexpr const char* kCreateBelief = "pomdp/create_belief";
inline constexpr const char* kAdvanceBelief = "pomdp/advance_belief";
inline constexpr const char* kGetBelief = "pomdp/get_belief";
inline constexpr const char* kResetBelief = "pomdp/reset_belief";
inline constexpr const char* kDeleteBelief = "pomdp/delete_belief";
inline constexpr const char* kListBeliefs = "pomdp/list_beliefs";
inline constexpr const char* kPlanOnline = "pomdp/plan_online";

}  // namespace kr3::pomdp::names
