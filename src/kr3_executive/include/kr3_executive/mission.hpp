#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include <kr3_common/error.hpp>
#include <kr3_reasoner/reasoner.hpp>

/// Algorithm 1 of Zhang, Sridharan, Gelfond and Wyatt (2014), "Control loop of architecture", as a
/// pure transition function: no clock, no I/O, no solver. A driver turns decisions into requests
/// and their results into events (driver.hpp).
namespace kr3::executive
{

/// Where a mission stands; comments give the line of Algorithm 1.
enum class Phase : std::uint8_t
{
  kIdle,
  kReporting,   ///< line 1: what is known at the start enters the high-level history
  kPlanning,    ///< lines 3-6, and 20-22: plans are requested
  kPreparing,   ///< lines 9-11: zoom, initial belief, policy
  kExecuting,   ///< lines 12-15
  kRecording,   ///< line 16
  kDiagnosing,  ///< lines 17-19
  kReopening,   ///< every hypothesis was refuted: the least certain refutation is taken back
  kFinished,
};

[[nodiscard]] const char* toString(Phase phase);

/// Bounds that make every mission end.
struct Limits
{
  std::uint32_t max_hl_actions = 40;  ///< per mission
  std::uint32_t max_ll_actions = 60;  ///< per high-level action
  std::uint32_t max_attempts = 3;     ///< of one high-level action under one hypothesis
  /// Refutations taken back per mission. The driver takes those of a value back twice at most, for
  /// as many values as there are; this bound is for those who want fewer, and ends any mission
  /// besides.
  std::uint32_t max_reopened = 1000;
  std::uint32_t max_rebuilds = 3;  ///< of the low-level task, per high-level action
  std::uint32_t max_detours = 2;   ///< longer ways taken where no shortest one is left
  double threshold = 0.85;         ///< belief becomes knowledge above it, in (0.5, 1)
};

/// A plan with its expected low-level cost.
struct CostedPlan
{
  reasoner::Plan plan;
  double cost_s = 0.0;
  std::string confirms = {};  ///< literal of a goal that is entailed but not known; empty: the plan
                              ///< is for the goal itself
  std::string reason = {};    ///< why `confirms` is believed
  bool refuted = false;  ///< it rests on a value that was looked for in vain, and only a change
                         ///< that nobody saw could have brought since
  /// Where its first action would begin: the values that it is about (driver.hpp, situationOf());
  /// empty while nothing has failed.
  std::string situation = {};
  bool detour = false;  ///< longer than necessary, around an action that was tried in vain
};

/// A value that the low level doubts: an assumption of the high-level action under execution.
struct Refutation
{
  std::string literal;       ///< such as "loc(tb1) = main_library"
  double probability = 0.0;  ///< that it does not hold
};

/// A high-level literal that was noticed by the way and is believed above the threshold.
struct Noticed
{
  std::string literal;      ///< "loc(tb1) = kitchen", "-in_hand(rob1, tb1)"
  double confidence = 0.0;  ///< by the sightings since the action began
  bool overturns = false;   ///< the plan rests on something else: the action ends
};

/// What the low level believes about the high-level action under execution.
struct Assessment
{
  double achieved = 0.0;                ///< probability that all its effects hold
  std::vector<std::string> effects;     ///< literals that hold after it and did not before
  std::vector<Refutation> refutations;  ///< for each assumption that the belief can refute
  bool remembered = false;  ///< the initial belief rested on earlier low-level observations
  bool attempted = false;   ///< the physical action itself was executed
  std::vector<std::string> changed;  ///< observed literals that neither hold before nor after
  /// Literals about the effects' fluents that were observed without doubt, the effects or not.
  std::vector<std::string> seen;
  std::optional<std::string> happened;  ///< high-level action that `changed` shows to have occurred
  std::vector<Noticed> noticed;         ///< by sightings, beside what the action is about
  /// A sighting contradicts what the belief takes for certain and nothing observes, such as that
  /// what was picked up is still held: `achieved` counts no more.
  bool denied = false;
};

// ---- Events -----------------------------------------------------------------------------------

struct GoalGiven
{
  std::string goal;
  Limits limits;
  std::vector<reasoner::Record> records;  ///< line 1: may be empty
  int step = 0;                           ///< current step of the history
};
struct RecordsAdded
{
  int step = 0;             ///< current step afterwards
  bool unexpected = false;  ///< one of them contradicts what was entailed or assumed
};
struct PlanReady
{
  bool goal_entailed = false;
  std::vector<CostedPlan> plans;
  std::string reason;  ///< when there is none
};
struct PolicyReady
{
  Assessment assessment;       ///< at the initial belief
  std::string situation = {};  ///< where the action begins, as CostedPlan::situation
};
struct ActionExecuted
{
  std::string action;
  Assessment assessment;  ///< after the belief update
};
/// The policy chose to finish.
struct PolicyFinished
{
  Assessment assessment;
};
/// What was observed is impossible in the zoomed model, or a skill refused what the model allows.
struct TaskLost
{
  std::string reason;
  Assessment assessment = {};  ///< before it
};
/// The plan's next action is impossible in what is known now, or changes nothing.
struct ActionImpossible
{
  std::string reason;
  std::string situation = {};  ///< where it would begin, as CostedPlan::situation
};
struct DiagnosisReady
{
  bool consistent = true;
};
struct RefutationReopened
{
  bool found = false;  ///< whether there was one to take back
};
/// A person told a fact.
struct Told
{
  reasoner::Record record;  ///< its step is set by the transition
};
struct CancelRequested
{
};
/// A request could not be answered.
struct RequestFailed
{
  ErrorCode code = ErrorCode::kInternal;
  std::string message;
};
using Event = std::variant<GoalGiven, RecordsAdded, PlanReady, PolicyReady, ActionExecuted,
                           PolicyFinished, TaskLost, ActionImpossible, DiagnosisReady,
                           RefutationReopened, Told, CancelRequested, RequestFailed>;

// ---- Decisions --------------------------------------------------------------------------------

struct RequestPlan
{
  /// An action was tried in vain: other plans of the same hypothesis are wanted too, and ways round
  /// it.
  bool alternatives = false;
};
/// Lines 9-11 for the current high-level action of the plan.
struct RequestPolicy
{
  std::string action;
  bool rebuild = false;  ///< the robot is not where the last task could place it
};
/// Line 13: what the policy says at the belief.
struct ExecutePolicyAction
{
};
struct AddRecords
{
  std::vector<reasoner::Record> records;
};
struct RequestDiagnosis
{
};
struct ReopenRefutation
{
};
struct Finish
{
  ErrorCode code = ErrorCode::kOk;  ///< kOk also when no plan is left
  bool achieved = false;            ///< the history entails the goal
  std::string reason;
};
/// Nothing to do, the event changed nothing.
struct Wait
{
};
using Decision = std::variant<Wait, RequestPlan, RequestPolicy, ExecutePolicyAction, AddRecords,
                              RequestDiagnosis, ReopenRefutation, Finish>;

// ---- State and transition ---------------------------------------------------------------------

/// How the last high-level action ended.
enum class ActionResult : std::uint8_t
{
  kNone,
  kAchieved,
  kRefuted,
  kDisplaced,   ///< the world is or changed otherwise than the plan assumes
  kUnresolved,  ///< the belief settles nothing
};

[[nodiscard]] const char* toString(ActionResult result);

struct State
{
  Phase phase = Phase::kIdle;
  std::string goal;
  Limits limits;
  int step = 0;  ///< current step of the high-level history
  std::optional<CostedPlan> plan;
  std::size_t plan_index = 0;  ///< step of the plan under execution
  std::uint32_t hl_actions_done = 0;
  std::uint32_t ll_actions_done = 0;
  std::uint32_t ll_actions_here = 0;  ///< for the current high-level action
  std::uint32_t rebuilds = 0;         ///< for the current high-level action
  std::uint32_t reopened = 0;
  std::uint32_t detours = 0;
  std::map<std::string, std::uint32_t> failures;  ///< by attemptKey()
  std::set<std::string> impossible;               ///< the same keys: until something new is known
  std::string situation;                          ///< where the current high-level action began
  bool alternatives = false;  ///< an action was tried in vain: RequestPlan::alternatives
  ActionResult last_result = ActionResult::kNone;
  Assessment assessment;          ///< of the current high-level action
  bool replan = false;            ///< what was learned may make another plan better
  bool cancelling = false;        ///< finish once the records are in
  std::optional<Finish> outcome;  ///< set in kFinished

  /// The high-level action under execution; empty if none.
  [[nodiscard]] std::string currentAction() const;

  /// How often an action was tried in vain. @param where  as CostedPlan::situation
  [[nodiscard]] std::uint32_t failuresOf(const std::string& action,
                                         const std::vector<std::string>& hypothesis,
                                         const std::string& where) const;
};

/// What counts as the same attempt: an action under a hypothesis, where it begins.
[[nodiscard]] std::string attemptKey(const std::string& action,
                                     const std::vector<std::string>& hypothesis,
                                     const std::string& situation);

struct Transition
{
  State state;
  Decision decision;
};

/// One step of Algorithm 1. Total: an event that does not fit the phase gives Wait and the same
/// state. Each mission ends in exactly one Finish.
[[nodiscard]] Transition step(const State& state, const Event& event);

/// Source of the records of what was noticed by the way.
inline constexpr char kSightingSource[] = "sighting";

/// The records that line 16 adds when an action ends with this result.
/// @param least  belief that refutes an assumption, in [0.5, 1)
[[nodiscard]] std::vector<reasoner::Record> recordsOf(const std::string& action, int step,
                                                      ActionResult result,
                                                      const Assessment& assessment, double least);

}  // namespace kr3::executive
