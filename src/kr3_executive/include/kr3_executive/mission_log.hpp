#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <kr3_reasoner/reasoner.hpp>

#include "kr3_executive/interfaces.hpp"
#include "kr3_executive/low_level_task.hpp"
#include "kr3_executive/mission.hpp"

/// What enters a mission from outside, and what it decides: enough to compute it again. From the
/// same inputs, in the same places between the decisions, the same decisions follow, as long as
/// plans and policies are bounded by counted work and not by time.
namespace kr3::executive
{

struct DriverConfig
{
  Limits limits;
  SolveBudget budget;
  /// Belief that an object is where only a default puts it, in (0, 1).
  double default_probability = 0.85;
  /// Belief in a value that is only assumed, when the low level begins to look: at least this, and
  /// 1/k among k hypotheses if that is more. With even odds the posterior odds are what the looks
  /// alone say (their Bayes factor), so that the records of several places can be compared. The
  /// share 1/k enters where plans are compared. In (0, 1).
  double least_hypothesis_probability = 0.5;
  /// Probability that an exogenous action has changed a value which was known before the robot
  /// looks again, where the description has one that could. In [0, 1).
  double change_probability = 0.05;
  /// A low-level action that could not be executed is tried again this often.
  std::uint32_t max_skill_retries = 2;
  /// Plans of one hypothesis that are compared when an action was tried in vain, at least 1.
  std::uint32_t max_alternatives = 12;
  /// Steps of history that a mission starts with at most, half as many again apart; what is earlier
  /// is summed up (history_summary.hpp). 0: all are kept.
  std::uint32_t history_window = kDefaultHistoryWindow;
  /// Whether snapshots explain what is entailed about the goal's objects; costs some questions.
  bool explain_facts = false;
};

/// What outlives a mission and a restart.
struct Knowledge
{
  std::vector<reasoner::Record> history;
  LowLevelMemory memory;
};

// ---- Inputs -----------------------------------------------------------------------------------

/// The first input of each mission: everything it starts from.
struct MissionBegun
{
  std::string goal;
  std::vector<reasoner::Record> initial;  ///< told if the history is empty
  Limits limits;
  double time_limit_s = 0.0;  ///< 0 = none
  DriverConfig config;
  Knowledge knowledge;
  std::optional<ReasonerSettings> reasoner = {};  ///< nothing when it did not tell
};

/// A request to the executor ended; each try is one input.
struct SkillEnded
{
  LowLevelAction action;
  ErrorCode code = ErrorCode::kOk;  ///< else it could not be executed, and `result` is empty
  std::string message;              ///< of the error
  LowLevelResult result;
};

/// A person told a fact.
struct FactTold
{
  reasoner::Record record;     ///< checked; its step is set when it is taken in
  bool during_mission = true;  ///< else it went straight into the history
};

/// Somebody cancelled the mission. After a SkillEnded with ErrorCode::kCancelled nothing new came
/// from outside.
struct MissionCancelled
{
};

/// The time allowed for the mission ran out.
struct TimeExpired
{
};

/// The reasoner, the policy server or the executor could not answer; the mission ends. After a
/// SkillEnded with the same code nothing new came from outside.
struct RequestRefused
{
  ErrorCode code = ErrorCode::kInternal;
  std::string message;
};

using Input =
    std::variant<MissionBegun, SkillEnded, FactTold, MissionCancelled, TimeExpired, RequestRefused>;

// ---- Decisions --------------------------------------------------------------------------------

/// A decision in plain words of the language; equal decisions have equal texts.
struct ReportedDecision
{
  std::uint32_t sequence = 0;  ///< from 0 in each mission, as MissionBegun does not count
  std::string kind;  ///< as toString(Decision); what a policy chose: "low_level_action" or
                     ///< "low_level_finish"; what was computed on the way: "plans", "policy",
                     ///< "diagnosis"
  std::vector<std::string> details;  ///< of AddRecords a record a line; of a plan that was chosen
                                     ///< its hypothesis and steps; of others their argument
  std::vector<std::string> basis;    ///< numbers that it rests on, with all their digits: costs of
                                     ///< plans, bounds of a policy, a hash of the belief
  std::optional<SolvedPolicy> policy;  ///< of "policy"
  bool cut_short = false;  ///< ended by wall time or memory, not by counted work: of "policy",
                           ///< "plans" and "diagnosis"; it need not repeat
};

/// "request_plan", "request_policy", "execute_policy_action", "add_records", "request_diagnosis",
/// "reopen_refutation", "finish", "wait".
[[nodiscard]] const char* toString(const Decision& decision);

/// A decision of the core, with what it is about. Confidences are given to 9 digits.
[[nodiscard]] ReportedDecision reported(const Decision& decision, const State& state);

/// Plans that were found, a line each, with their costs as basis.
/// @param cut_short  wall time left some out
[[nodiscard]] ReportedDecision reported(const std::vector<CostedPlan>& plans, bool cut_short);

/// The policy for a high-level action, to be followed from `belief`.
[[nodiscard]] ReportedDecision reported(const std::string& action, const SolvedPolicy& policy,
                                        const pomdp::Belief& belief);

/// A diagnosis: its minimal explanations, a line each.
[[nodiscard]] ReportedDecision reported(const reasoner::Diagnosis& diagnosis);

/// A diagnosis that was not found within the reasoner's limit of time.
[[nodiscard]] ReportedDecision reportedLateDiagnosis();

/// What a policy says at a belief.
/// @param action  empty to finish
[[nodiscard]] ReportedDecision reportedLowLevel(const std::string& action,
                                                const pomdp::Belief& belief);

}  // namespace kr3::executive
