#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <kr3_refinement/low_level_domain.hpp>
#include <kr3_refinement/models.hpp>

#include "kr3_executive/bindings.hpp"
#include "kr3_executive/interfaces.hpp"
#include "kr3_executive/low_level_task.hpp"
#include "kr3_executive/mission.hpp"
#include "kr3_executive/mission_log.hpp"
#include "kr3_executive/narration.hpp"
#include "kr3_executive/rule_interpreter.hpp"

namespace kr3::executive
{

/// How a mission ended.
struct MissionResult
{
  ErrorCode code = ErrorCode::kOk;  ///< kOk also when no plan was left
  bool achieved = false;            ///< the history entails the goal
  std::string reason;
  std::uint32_t hl_actions = 0;
  std::uint32_t ll_actions = 0;
  double duration_s = 0.0;  ///< on the driver's clock
};

/// The loop around the transition function: performs its decisions with a reasoner, a policy server
/// and an executor, and feeds back what comes of them. One core for a robot and for the abstract
/// simulator.
///
/// achieve() runs in one thread; cancel() and tell() may be called from others, and by the observer
/// from within. Everything passed by reference must outlive the driver.
///
/// What enters a mission from outside enters here alone, and is reported as an Input where it does
/// (mission_log.hpp).
class MissionDriver
{
public:
  using Clock = std::function<double()>;  ///< s, never runs backwards

  MissionDriver(const refinement::LowLevelDomain& domain, const refinement::Models& models,
                const Narrator& narrator, HighLevelReasoner& reasoner, PolicyServer& policies,
                LowLevelExecutor& executor, MissionObserver& observer, Clock clock,
                DriverConfig config);

  /// Runs a mission until it ends; failures on the way are in the result.
  ///
  /// @param initial  records told when the history is empty (line 1)
  /// @param time_limit_s  on the clock, 0 = none
  /// @throws InvalidArgument  the goal does not fit the description; nothing was started
  MissionResult achieve(const std::string& goal, const std::vector<reasoner::Record>& initial,
                        const Limits& limits, double time_limit_s);

  /// Ends the mission under way; it stays cancelled until the next achieve().
  void cancel() { cancel_ = true; }

  /// A fact from a person; taken in at once when no mission runs, else after the low-level action
  /// under way. @throws InvalidArgument  it does not fit the description
  void tell(const reasoner::Record& record);

  /// Not while a mission runs.
  [[nodiscard]] const Knowledge& knowledge() const { return knowledge_; }
  void setKnowledge(Knowledge knowledge);

  [[nodiscard]] const DriverConfig& config() const { return config_; }

private:
  Event perform(const Decision& decision);
  Event performPlan();
  Event performPolicy(const RequestPolicy& request);
  Event performAction();
  /// Asks for the policy of the task at its present belief.
  SolvedPolicy solvePolicy(const std::string& action);
  Event performRecords(const std::vector<reasoner::Record>& records);
  Event performDiagnosis();
  Event performReopen();
  void apply(const Event& event);
  void report(EventKind kind, Narration narration);
  void publish();
  void note(const Input& input);
  void note(ReportedDecision decision);
  [[nodiscard]] LowLevelResult execute(const LowLevelAction& action);
  void refreshFacts();
  void takeInTold();
  [[nodiscard]] std::string believedValue(const std::string& fluent) const;
  [[nodiscard]] std::optional<Event> interruption();
  [[nodiscard]] Event afterObservation(const LowLevelAction& action, bool explained);
  /// What is entailed now, and what is assumed where nothing is.
  [[nodiscard]] std::vector<reasoner::Literal> believedState(
      const std::vector<std::string>& hypothesis);
  [[nodiscard]] Support supportOf(const std::string& literal);
  [[nodiscard]] Support supportOf(const std::string& literal, int step);
  [[nodiscard]] Support findSupport(const std::string& literal, int step);
  [[nodiscard]] bool isUnexpected(const reasoner::Record& record);
  [[nodiscard]] std::optional<std::string> happened(const std::vector<std::string>& changed) const;
  void addToHistory(const std::vector<reasoner::Record>& records);

  const refinement::LowLevelDomain& domain_;
  const refinement::Models& models_;
  const Narrator& narrator_;
  HighLevelReasoner& reasoner_;
  PolicyServer& policies_;
  LowLevelExecutor& executor_;
  MissionObserver& observer_;
  Clock clock_;
  DriverConfig config_;
  RuleInterpreter high_level_laws_;

  Knowledge knowledge_;
  State state_;
  Decision decision_;
  std::unique_ptr<LowLevelTask> task_;  // of the current high-level action
  std::string policy_id_;
  std::string ll_action_;                      // under execution
  std::vector<reasoner::Literal> task_state_;  // s1 of the task
  std::vector<std::string> surprises_;         // texts, until the diagnosis
  std::vector<std::string> surprised_fluents_;
  std::vector<std::string> exceptions_;  // the minimal explanation in force
  std::vector<ExplainedFact> facts_;
  std::map<std::pair<std::string, int>, Support> supports_;  // of the present history
  std::map<std::string, std::string> expected_by_default_;   // default that once gave a literal
  std::uint32_t sequence_ = 0;
  std::uint32_t num_decisions_ = 0;
  std::optional<double> deadline_s_;

  std::atomic<bool> cancel_{false};
  std::atomic<bool> running_{false};
  std::mutex mission_mutex_;  // held while a mission runs
  std::mutex told_mutex_;
  std::vector<reasoner::Record> told_;
};

}  // namespace kr3::executive
