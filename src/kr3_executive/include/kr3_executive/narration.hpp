#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <kr3_reasoner/reasoner.hpp>

#include "kr3_executive/bindings.hpp"
#include "kr3_executive/low_level_task.hpp"
#include "kr3_executive/mission.hpp"
#include "kr3_executive/mission_log.hpp"

namespace kr3::executive
{

/// The values equal the constants of kr3_msgs/MissionEvent.
enum class EventKind : std::uint8_t
{
  kGoal = 0,
  kPlan = 1,
  kHighLevelAction = 2,
  kPolicy = 3,
  kLowLevelAction = 4,
  kRecord = 5,
  kDiagnosis = 6,
  kReplan = 7,
  kDone = 8,
  kFailed = 9,
  kCancelled = 10,
};

[[nodiscard]] const char* toString(EventKind kind);

/// What happened, for people and for machines.
struct Narration
{
  std::string text;
  std::string data = "{}";  ///< one JSON object
};

struct ReportedEvent
{
  EventKind kind = EventKind::kGoal;
  std::uint32_t sequence = 0;  ///< from 0 in each mission
  std::uint32_t hl_step = 0;
  std::string hl_action;
  std::string ll_action;
  Narration narration;
};

/// The low level's belief, as marginals.
struct ReportedBelief
{
  std::string hl_action;
  std::uint32_t hl_step = 0;
  std::map<std::string, refinement::Distribution> fluents;
  std::string summary;  ///< in a line
};

struct ExplainedFact
{
  std::string literal;
  std::uint32_t step = 0;
  std::string reason;
};

/// The mission as a whole.
struct Snapshot
{
  State state;
  std::string ll_action;  ///< under execution, empty if none
  std::vector<reasoner::Record> history;
  std::vector<ExplainedFact> facts;     ///< about what the goal mentions, at the current step
  std::vector<std::string> exceptions;  ///< the minimal explanation in force
};

/// What an observer wants to be told.
struct Interest
{
  bool narration = true;  ///< events, beliefs, and what is explained in snapshots
  bool log = true;        ///< inputs and decisions
  bool snapshots = true;
};

/// Receives what a mission does, in the mission's thread. Must not throw.
class MissionObserver
{
public:
  virtual ~MissionObserver() = default;
  /// Asked once, before the first mission. What nobody wants is not computed, reasons for people
  /// least of all; missions go the same way.
  [[nodiscard]] virtual Interest interest() const { return {}; }
  virtual void onEvent(const ReportedEvent& event) = 0;
  virtual void onBelief(const ReportedBelief& belief) = 0;
  virtual void onSnapshot(const Snapshot& snapshot) = 0;
  /// Inputs and decisions, in the order in which they were taken in and made.
  virtual void onInput(const Input& /*input*/) {}
  virtual void onDecision(const ReportedDecision& /*decision*/) {}
  /// Records that were added to the history, where they are; whatever the interest.
  virtual void onRecords(const std::vector<reasoner::Record>& /*records*/) {}
  /// A policy that an action is carried out by; whatever the interest.
  virtual void onPolicy(const SolvedPolicy& /*policy*/) {}
};

/// Puts what the executive does into words, with the phrases of the domain.
class Narrator
{
public:
  explicit Narrator(std::map<std::string, Phrase> phrases);

  /// "tb1 in main_library", or the literal itself where the domain has no phrase.
  [[nodiscard]] std::string phrase(const std::string& literal) const;
  /// "not found there"
  [[nodiscard]] std::string refuted(const std::string& literal) const;

  [[nodiscard]] Narration goal(const std::string& goal) const;
  [[nodiscard]] Narration plan(const CostedPlan& plan, std::size_t num_plans) const;
  [[nodiscard]] Narration highLevelAction(const std::string& action, int step) const;
  [[nodiscard]] Narration policy(const std::string& action, const SolvedPolicy& policy,
                                 const refinement::PomdpTask& task) const;
  /// @param ignored  what was wrong with sightings that were left out
  [[nodiscard]] Narration lowLevelAction(const LowLevelAction& action, const LowLevelResult& result,
                                         const LowLevelTask& task,
                                         const std::vector<std::string>& ignored) const;
  [[nodiscard]] Narration record(const reasoner::Record& record, bool unexpected) const;
  /// Of a long history the earliest steps were replaced by what followed from them.
  [[nodiscard]] Narration summedUp(int steps, std::size_t records_left) const;
  [[nodiscard]] Narration replan(const std::string& why) const;
  [[nodiscard]] Narration end(const Finish& finish, const State& state) const;

  /// "expected tb1 in main_library (default d1(tb1)), not found there"
  [[nodiscard]] std::string surprise(const reasoner::Record& record, const Support& expected) const;
  /// "<surprises>: <why>; now expected tb1 in aux_library (default d2(tb1))"
  /// @param known        parts of the explanation that were given before; not said again
  /// @param defaults_of  the default that gave a literal, where one did
  [[nodiscard]] Narration diagnosis(const std::vector<std::string>& surprises,
                                    const reasoner::Diagnosis& diagnosis,
                                    const std::vector<std::string>& known,
                                    const std::map<std::string, std::string>& defaults_of,
                                    const std::vector<std::string>& expectations) const;

private:
  [[nodiscard]] std::string inWords(const std::vector<std::string>& explanation,
                                    const std::map<std::string, std::string>& defaults_of) const;

  std::map<std::string, Phrase> phrases_;
};

}  // namespace kr3::executive
