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

#include <kr3_reasoner/ground_literals.hpp>
#include <kr3_refinement/low_level_domain.hpp>
#include <kr3_refinement/models.hpp>

#include "kr3_executive/bindings.hpp"
#include "kr3_executive/interfaces.hpp"
#include "kr3_executive/low_level_task.hpp"
#include "kr3_executive/mission.hpp"
#include "kr3_executive/mission_interface.hpp"
#include "kr3_executive/mission_log.hpp"
#include "kr3_executive/narration.hpp"
#include "kr3_executive/plan_cost.hpp"
#include "kr3_executive/rule_interpreter.hpp"

namespace kr3::executive
{

/// The loop around the transition function: performs its decisions with a reasoner, a policy server
/// and an executor, and feeds back what comes of them. One core for a robot and for the abstract
/// simulator.
///
/// Everything passed by reference must outlive the driver.
///
/// What is made of high-level actions may be shared with other missions of the same domain and
/// models, through `costs`.
///
/// What enters a mission from outside enters here alone, and is reported as an Input where it does
/// (mission_log.hpp).
class MissionDriver : public Mission
{
public:
  MissionDriver(const refinement::LowLevelDomain& domain, const refinement::Models& models,
                const Narrator& narrator, HighLevelReasoner& reasoner, PolicyServer& policies,
                LowLevelExecutor& executor, MissionObserver& observer, Clock clock,
                DriverConfig config, std::shared_ptr<PlanCosts> costs = nullptr);

  /// Line 1: `initial` is told when the history is empty.
  MissionResult achieve(const std::string& goal, const std::vector<reasoner::Record>& initial,
                        const Limits& limits, double time_limit_s) override;
  void cancel() override { cancel_ = true; }
  void tell(const reasoner::Record& record) override;
  [[nodiscard]] const Knowledge& knowledge() const override { return knowledge_; }
  void setKnowledge(Knowledge knowledge) override;

  [[nodiscard]] const DriverConfig& config() const { return config_; }

private:
  Event perform(const Decision& decision);
  Event performPlan(const RequestPlan& request);
  /// Plans that begin with ways round what was tried as often as is allowed.
  void addDetours(std::vector<CostedPlan>& plans);
  /// Where each plan begins, so that what was tried there counts.
  void tellSituations(std::vector<CostedPlan>& plans);
  Event performPolicy(const RequestPolicy& request);
  Event performAction();
  void costPlans(std::vector<CostedPlan>& plans);

  /// The part of a goal that is believed least, with the probability that it holds.
  struct Doubt
  {
    reasoner::Literal literal;
    double probability = 1.0;  ///< 0: not entailed
    std::string reason;        ///< why it is believed
  };
  [[nodiscard]] Doubt doubtOf(const reasoner::Formula& formula, bool negated);
  /// By what the low level last believed of the fluent; 0 where it remembers nothing.
  [[nodiscard]] double rememberedProbability(const reasoner::Literal& literal) const;
  /// A goal that only a default or doubtful refutations entail is no knowledge: plans to an action
  /// whose low level finds out, as the first actions of a plan for the contrary. Empty when the
  /// goal is known or nothing can tell.
  [[nodiscard]] std::vector<CostedPlan> plansToConfirmGoal();
  /// Index of the first step whose zoom has the fluent among what is assumed; the number of steps
  /// when there is none.
  [[nodiscard]] std::size_t stepThatChecks(const reasoner::Plan& plan, const std::string& fluent);
  /// By what the low level remembers; they exclude each other. Shape [hypotheses], sums to 1.
  [[nodiscard]] std::vector<double> hypothesisProbabilities(
      const std::vector<std::vector<std::string>>& hypotheses) const;
  /// An exogenous action that is possible in the task's start would change the fluent.
  /// Of the task's start. @throws nothing
  [[nodiscard]] std::string situationOf(const std::string& action) const;
  [[nodiscard]] bool mayHaveChanged(const std::string& fluent) const;
  void allowForChange(const refinement::Zoom& zoom, refinement::InitialKnowledge& knowledge) const;
  /// @return what is wrong with those that were left out
  std::vector<std::string> takeInSightings(const std::vector<Sighting>& sightings);
  [[nodiscard]] bool concernsPlan(const std::vector<std::string>& constants) const;
  [[nodiscard]] std::optional<Noticed> noticedOf(const std::string& fluent,
                                                 const refinement::Distribution& values);
  /// The task's assessment, with what was noticed by the way.
  [[nodiscard]] Assessment assessed();
  /// What was observed, as literals of the high level.
  [[nodiscard]] std::vector<std::string> literalsSeen(
      const std::map<std::string, std::string>& observed) const;
  /// Those that did not hold when the task began and are none of its effects.
  [[nodiscard]] std::vector<std::string> changesAmong(
      const std::vector<std::string>& seen, const std::vector<std::string>& effects) const;
  /// Asks for the policy of the task at its present belief.
  SolvedPolicy solvePolicy(const std::string& action);
  Event performRecords(const std::vector<reasoner::Record>& records);
  Event performDiagnosis();
  /// Nothing where the reasoner's limit of time ends it.
  [[nodiscard]] std::optional<reasoner::Diagnosis> diagnosisInTime();
  Event performReopen();
  /// Indices of the records obs(f = v, false, k) by value v, since the fluent was last known to
  /// have a value: observed or told, or the only one with which an action that happened could
  /// happen.
  using Refutations = std::map<std::string, std::vector<std::size_t>>;
  [[nodiscard]] Refutations openRefutations(const std::string& fluent) const;
  /// The action that happened could do so with one value of the fluent alone.
  [[nodiscard]] bool settledBy(const reasoner::Record& happened, const std::string& fluent) const;
  /// Of the records' being right, independent errors assumed.
  [[nodiscard]] double logOddsOf(const std::vector<std::size_t>& records) const;
  /// Marks plans that rest on a value which was refuted: only a change that nobody saw, since then,
  /// makes it possible.
  void markRefuted(std::vector<CostedPlan>& plans);
  /// What may be given up together, with the log odds of its being right.
  [[nodiscard]] std::vector<reasoner::Retraction> retractable();
  /// -log of the prior odds of what the history without these records has to assume: exceptions to
  /// defaults and exogenous actions. Leaves that history with the reasoner.
  [[nodiscard]] double surpriseWithout(const std::vector<std::size_t>& records);
  /// What the records say, whenever they say so.
  [[nodiscard]] std::string sayingOf(const reasoner::Retraction& retraction) const;
  /// Indices into the history; none when no record is doubtful. Leaves another history with the
  /// reasoner.
  [[nodiscard]] std::vector<std::size_t> recordsToGiveUp();
  void apply(const Event& event);
  /// @param narration  called when somebody wants it
  void report(EventKind kind, const std::function<Narration()>& narration);
  void publish();
  void publishBelief();
  void note(const Input& input);
  /// @param decision  called when somebody wants it
  void note(const std::function<ReportedDecision()>& decision);
  [[nodiscard]] LowLevelResult execute(const LowLevelAction& action);
  void refreshFacts();
  void takeInTold();
  [[nodiscard]] std::string believedValue(const std::string& fluent) const;
  [[nodiscard]] std::optional<Event> interruption();
  [[nodiscard]] Event afterObservation(const LowLevelAction& action, bool explained);
  /// What was taken back of one statement.
  struct GivenUp
  {
    int times = 0;
    double log_odds = 0.0;  ///< of the records that said so, in sum
  };
  struct Believed
  {
    int step;
    std::vector<reasoner::Literal> entailed;
    std::map<std::vector<std::string>, std::vector<reasoner::Literal>> states;  // by hypothesis
  };
  /// What is entailed now, but for values that are excluded, and states that were asked for.
  [[nodiscard]] Believed& believedNow();
  /// The history is another one.
  void forgetAnswers();
  /// What is entailed now, and what is assumed where nothing is.
  [[nodiscard]] const std::vector<reasoner::Literal>& believedState(
      const std::vector<std::string>& hypothesis);
  [[nodiscard]] std::vector<reasoner::Literal> withAssumed(
      std::vector<reasoner::Literal> state, const std::vector<std::string>& hypothesis);
  [[nodiscard]] Support supportOf(const std::string& literal);
  [[nodiscard]] Support supportOf(const std::string& literal, int step);
  [[nodiscard]] Support findSupport(const std::string& literal, int step);
  /// Of what is entailed now when every other value of a fluent was looked for in vain: those
  /// records are the reason, no proof is needed.
  [[nodiscard]] std::optional<Support> supportByElimination(const std::string& literal) const;
  [[nodiscard]] bool isUnexpected(const reasoner::Record& record);
  [[nodiscard]] std::optional<std::string> happened(const std::vector<std::string>& changed) const;
  void addToHistory(const std::vector<reasoner::Record>& records);
  /// Sums up what is earlier than the history window, if there is enough of it.
  /// @return how many steps were summed up
  int sumUpHistory();

  const refinement::LowLevelDomain& domain_;
  const Narrator& narrator_;
  HighLevelReasoner& reasoner_;
  PolicyServer& policies_;
  LowLevelExecutor& executor_;
  MissionObserver& observer_;
  const Interest interest_;
  Clock clock_;
  DriverConfig config_;
  RuleInterpreter high_level_laws_;

  std::shared_ptr<PlanCosts> costs_;

  Knowledge knowledge_;
  State state_;
  Decision decision_;
  std::unique_ptr<LowLevelTask> task_;  // of the current high-level action
  std::string policy_id_;
  std::string ll_action_;                      // under execution
  std::vector<reasoner::Literal> task_state_;  // s1 of the task
  std::vector<std::string> surprises_;         // texts, until the diagnosis
  std::vector<std::string> surprised_fluents_;
  std::vector<std::string> exceptions_;      // the minimal explanation in force
  std::map<std::string, GivenUp> given_up_;  // statements that were taken back in this mission
  /// What the history without some records had to assume when that was last looked at, by what the
  /// records say: about the least that it has to assume now, with more observed.
  std::map<std::string, double> surprises_without_;
  std::vector<ExplainedFact> facts_;
  std::map<std::pair<std::string, int>, Support> supports_;  // of the present history
  std::optional<Believed> believed_;                         // of the present history
  reasoner::GroundLiterals literals_;
  std::map<std::string, std::string> expected_by_default_;  // default that once gave a literal
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
