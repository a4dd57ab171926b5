#pragma once

#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "kr3_reasoner/transition_system.hpp"
#include "models.hpp"
#include "solve_watch.hpp"
#include "unrolled_history.hpp"

namespace kr3::reasoner
{

/// The ground actions of each step, sorted.
using PlanSteps = std::vector<std::vector<std::string>>;

/// Values of the open fluents, in their order: the fluent and its value.
using OpenValues = std::vector<std::pair<std::string, std::string>>;

class DomainKnowledge;

/// What a plan is looked for in. All must outlive the search.
struct PlanningProblem
{
  DomainKnowledge& domain;
  const Description& description;  ///< of the domain
  const HistoryProgram& program;
  const std::vector<CheckedRecord>& records;
  int now;  ///< the current step
  Optimum optimum;
  const Consequences& consequences;
};

/// What is minimized when a plan is proposed; each then the next.
enum class PlanQuality
{
  kNone,                ///< any plan of the given length, where only one action is possible a step
  kFewestActions,       ///< of the plans of the given length
  kLeastCost,           ///< of the plans of the given length, then the fewest actions
  kLeastCostAnyLength,  ///< of all plans up to the given length, then the fewest steps
};

/// A plan in one model of the history.
struct Proposal
{
  PlanSteps steps;
  OpenValues state;     ///< of that model, at the current step
  long cost_milli = 0;  ///< of its actions there, in thousandths
  std::size_t num_actions = 0;
};

/// A plan of growing length and its goal, as one program that is solved many times. Private to the
/// package.
///
/// It starts after a history, or from any state: then the state is assumed when a question begins,
/// and what was grounded serves for further questions.
///
/// `pl(A, t)`: the plan has A at t. It occurs unless an earlier action turned out impossible, so
/// that what a plan does in a model in which it fails can be looked at too.
class PlanProgram
{
public:
  /// Where plans start.
  enum class Start
  {
    kAfterHistory,  ///< of the problem that it is made for; for one question
    kAnyState       ///< for problems with the same domain
  };

  /// @param problem  must outlive the question, its domain the program
  PlanProgram(const PlanningProblem& problem, Formula goal, PlanQuality quality, Start start);

  /// Begins a question. @param problem, limit  must last until it ends
  void begin(const PlanningProblem& problem, const SearchLimit& limit);

  /// Ends it. @return whether the program may serve for another question
  bool end();

  /// The ground fluents, not defined ones, that the history leaves open at the current step.
  [[nodiscard]] const std::vector<GroundFluent>& openFluents() const { return open_; }
  [[nodiscard]] std::string literalText(const std::pair<std::string, std::string>& value) const;

  /// Whether the goal is false now in some model.
  [[nodiscard]] bool goalMayBeFalse();

  /// Whether the program starts from the possible states and no others. If it does not, it starts
  /// from those that agree with all that is known.
  [[nodiscard]] bool isExact() const { return is_exact_; }

  /// Whether the goal is true, or false, in all states that plans start from.
  [[nodiscard]] bool isDecided() const;

  /// Whether the plan can be executed and reaches the goal from every state that agrees with what
  /// is known and with the hypothesis: nothing is left to luck. Needs no solver.
  [[nodiscard]] bool surelyWorks(const PlanSteps& steps, const OpenValues& hypothesis = {});

  /// Whether it fails in each of these states. Needs no solver.
  [[nodiscard]] bool surelyFails(const PlanSteps& steps, const OpenValues& hypothesis);

  /// Whether the goal is false in each of these states. Needs no solver.
  [[nodiscard]] bool surelyOpen(const OpenValues& hypothesis);

  /// The values that an open fluent may have. @param fluent  as in OpenValues
  [[nodiscard]] std::vector<std::string> possibleValues(const std::string& fluent) const;

  /// Makes plans of this length possible; lengths grow.
  void extendTo(int length);

  /// Whether a model is left that no hypothesis covers.
  bool isUncovered();

  /// A plan of the length in some model that no hypothesis covers.
  std::optional<Proposal> propose(int length);

  /// Another plan of the same quality as `like` under a hypothesis, none of `but`.
  std::optional<Proposal> proposeAnother(const Proposal& like, const OpenValues& hypothesis,
                                         const std::vector<PlanSteps>& but);

  /// The state of a model that agrees with the hypothesis in which the plan fails: an action turns
  /// out impossible, or the goal is missed.
  std::optional<OpenValues> failure(const PlanSteps& steps, const OpenValues& hypothesis);

  /// The state of a model that agrees with the hypothesis in which the plan costs more.
  std::optional<OpenValues> dearer(const PlanSteps& steps, const OpenValues& hypothesis,
                                   long cost_milli);

  /// The state of a model that agrees with the hypothesis in which the first `step` steps lead to a
  /// state from which the next one leads nowhere.
  /// @param fluents  on the values of which that depends
  /// @throws ResourceExhausted  more than kMaxStates combinations of values
  std::optional<OpenValues> stuck(const PlanSteps& steps, std::size_t step,
                                  const OpenValues& hypothesis,
                                  const std::vector<GroundFluent>& fluents);

  /// The cost of the plan in the model in which it is largest, in thousandths.
  long largestCost(const PlanSteps& steps, const OpenValues& hypothesis, long at_least);

  /// Leaves the models of a hypothesis out of further proposals, or a plan out of those of a
  /// length.
  void cover(const OpenValues& hypothesis);
  /// The same for several hypotheses, none of them empty.
  void coverAll(const std::vector<OpenValues>& hypotheses);
  void forbid(const PlanSteps& steps, int length);

  static constexpr int kMaxStates = 2000;

private:
  using Assumptions = std::vector<SolverLiteral>;

  /// What one step of the plan adds. All by the number of the action.
  struct Step
  {
    std::vector<SolverLiteral> planned;
    std::vector<std::vector<ActionPrice>> prices;
    SolverLiteral busy = kFalseLiteral;
  };

  /// A price that is paid for an action of the plan when `literal` is true.
  struct Payment
  {
    int step;
    long cost_milli;
    SolverLiteral literal;
  };

  /// The state that plans start from, with a hypothesis: constants for what is known then.
  [[nodiscard]] StateLiterals startUnder(const OpenValues& hypothesis);
  void findOpenFluents();
  void findTests(const Formula& goal);
  [[nodiscard]] bool tests(const Dynamics::Action& action, const Literal& condition,
                           const Atom& pattern, const GroundFluent& fluent) const;
  [[nodiscard]] SolverLiteral goalAt(const Formula& goal, const StateLiterals& state,
                                     RuleSink& sink) const;
  [[nodiscard]] SolverLiteral literalIn(const Literal& literal, const StateLiterals& state) const;
  void addStep(RuleSink& sink);
  [[nodiscard]] std::vector<SolverLiteral> addActions(const StateLiterals& before, RuleSink& sink);
  void addPayments(const StateLiterals& before, RuleSink& sink);
  void addQuery(RuleSink& sink);
  void addQuality(RuleSink& sink) const;

  void checkLimit() const;
  [[nodiscard]] SolverLiteral newGuard();
  void addConstraint(std::vector<SolverLiteral> literals);
  [[nodiscard]] Assumptions fixed(const PlanSteps& steps, std::size_t upto) const;
  void assume(Assumptions& assumptions, const OpenValues& values) const;
  [[nodiscard]] SolverLiteral valueAt(const GroundFluent& fluent, const std::string& value,
                                      std::size_t step) const;
  bool solve(const Assumptions& assumptions, bool optimize = false);
  void read(const Clingo::Model& model);
  std::optional<Proposal> proposal(Assumptions assumptions, int length);
  [[nodiscard]] SolverLiteral costsMore(long cost_milli, int length);
  [[nodiscard]] SolverLiteral hasMoreActions(std::size_t number, int length);
  [[nodiscard]] SolverLiteral sumAbove(long bound,
                                       const std::vector<Clingo::WeightedLiteral>& weighted);

  const PlanningProblem* problem_;  // of the question
  Formula goal_;
  PlanQuality quality_;
  Solver solver_;
  std::unique_ptr<SolveWatch> watch_;  // while there is a question
  Start start_kind_;
  std::unique_ptr<UnrolledHistory> history_;  // if plans start after one that is not constant
  Dynamics& dynamics_;
  StateLiterals start_;       // the current state: constants for what is known
  Assumptions start_values_;  // what is known, when the program starts from any state
  bool is_exact_ = true;
  bool has_costs_ = false;
  std::vector<int> agent_actions_;
  std::vector<char> tests_;  // by action: whether it tests an open fluent of the goal
  std::vector<GroundFluent> open_;
  std::vector<int> open_numbers_;
  std::unordered_map<std::string, std::size_t> open_index_;

  // By step of the plan; states_ has one more.
  std::vector<StateLiterals> states_;
  std::vector<Step> steps_;
  std::vector<Payment> payments_;
  std::vector<SolverLiteral> fails_;    // by length
  std::vector<SolverLiteral> queries_;  // by length
  SolverLiteral goal_now_ = kFalseLiteral;
  SolverLiteral broken_ = kFalseLiteral;
  SolverLiteral tested_ = kFalseLiteral;
  SolverLiteral searching_ = kFalseLiteral;  // guard of what a question adds
  bool has_additions_ = false;               // behind that guard
  int num_guards_ = 0;
  std::optional<bool> is_uncovered_;  // nothing: has to be asked

  // The last model.
  OpenValues state_;
  PlanSteps planned_;
  std::vector<Payment> paid_;
  std::vector<SolverLiteral> watched_;  // literals whose truth is read, too
  std::vector<char> watched_truths_;
};

}  // namespace kr3::reasoner
