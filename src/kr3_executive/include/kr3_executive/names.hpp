#pragma once

/// Names of topics, services and actions of this package's nodes; relative, so they can be
/// remapped.
namespace kr3::executive::names
{

inline constexpr char kAchieve[] = "executive/achieve";
inline constexpr char kCancel[] = "executive/cancel";
inline constexpr char kTell[] = "executive/tell";
inline constexpr char kState[] = "executive/state";
inline constexpr char kEvents[] = "executive/events";
inline constexpr char kBelief[] = "executive/belief";
inline constexpr char kBeliefMarkers[] = "executive/belief_markers";
inline constexpr char kPlanMarkers[] = "executive/plan_markers";
inline constexpr char kInputs[] = "executive/inputs";

// What executive_node uses of others.
inline constexpr char kCells[] = "cells";
inline constexpr char kSetHistory[] = "reasoner/set_history";
inline constexpr char kAddRecords[] = "reasoner/add_records";
inline constexpr char kEntails[] = "reasoner/entails";
inline constexpr char kExplain[] = "reasoner/explain";
inline constexpr char kDiagnose[] = "reasoner/diagnose";
inline constexpr char kGetState[] = "reasoner/get_state";
inline constexpr char kFindRetractions[] = "reasoner/find_retractions";
inline constexpr char kProgress[] = "reasoner/progress_history";
inline constexpr char kGetOptions[] = "reasoner/get_options";
inline constexpr char kPlan[] = "reasoner/plan";
inline constexpr char kSolve[] = "pomdp/solve";
inline constexpr char kGetAction[] = "pomdp/get_action";

}  // namespace kr3::executive::names
