#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include <clingo.hh>

#include "kr3_reasoner/transition_system.hpp"
#include "partial_evaluator.hpp"
#include "search_limit.hpp"
#include "step_program.hpp"
#include "symbol_text.hpp"

namespace kr3::reasoner
{

/// The values of all fluents at one step, as literals of a solver's program: the first numValues()
/// entries; what else lasts from step to step follows.
using StateLiterals = std::vector<SolverLiteral>;

/// A price of an action in a state in which the literal is true.
struct ActionPrice
{
  long cost_milli;
  SolverLiteral literal;
};

/// What a description says of one state and of one transition, grounded once and for all steps.
///
/// Its rules are grounded for one generic step (groundStep, or groundStepText where only clingo
/// can) and then instantiated step by step. Private to the package; not thread-safe.
class Dynamics
{
public:
  /// @param exogenous  whether exogenous actions are part of it; they cost time
  /// @param limit      of the grounding
  Dynamics(const Description& description, bool exogenous, const SearchLimit& limit = {});

  struct Action
  {
    std::string name;  ///< `move(rob1, office)`
    std::vector<std::string> arguments;
    Clingo::Symbol symbol;
    bool exogenous;
    GroundProgram::AtomId occurs;
    GroundProgram::AtomId impossible;  ///< 0: no rule forbids it
  };

  [[nodiscard]] const std::vector<GroundFluent>& fluents() const { return fluents_; }
  [[nodiscard]] const std::vector<Action>& actions() const { return actions_; }

  /// Where the values of a fluent begin in StateLiterals. The value `true` of a defined fluent is
  /// an atom, and `false` its negation.
  [[nodiscard]] std::size_t firstValue(std::size_t fluent) const { return first_value_[fluent]; }
  [[nodiscard]] std::size_t numValues() const { return num_values_; }

  /// Number of a ground fluent or action (with `exogenous`), or -1.
  [[nodiscard]] int fluentNumber(const std::string& name) const;
  [[nodiscard]] int fluentNumber(Clingo::Symbol symbol) const;
  [[nodiscard]] int actionNumber(const std::string& name) const;

  /// Place of `fluent = value` in StateLiterals, or -1 when there is no such value.
  [[nodiscard]] int valueIndex(int fluent, const std::string& value) const;

  /// A state at the first step.
  ///
  /// @param known  shape [numValues()]: constants where a value is known to hold or not to, kOpen
  ///               elsewhere and for defined fluents
  [[nodiscard]] StateLiterals initialState(const StateLiterals& known, RuleSink& sink);

  /// For each action the literal of its being impossible in a state.
  /// @param wanted  numbers of the actions that are asked for; the others are left out
  [[nodiscard]] std::vector<SolverLiteral> impossible(const StateLiterals& state,
                                                      const std::vector<int>& wanted,
                                                      RuleSink& sink);

  /// By action: the prices that may be named for it, the largest first; it costs the first that is
  /// true, and 1 when there is none.
  [[nodiscard]] std::vector<std::vector<ActionPrice>> prices(const StateLiterals& state,
                                                             RuleSink& sink);

  /// The state after a transition.
  /// @param occurs  shape [actions().size()]: literals; that what is impossible does not occur is
  ///                the caller's business
  [[nodiscard]] StateLiterals successor(const StateLiterals& state,
                                        const std::vector<SolverLiteral>& occurs, RuleSink& sink);

private:
  void numberFluents();
  void numberActions(const Description& description, bool exogenous);
  void buildPrograms(StepProgram rules);
  [[nodiscard]] StateLiterals read(const std::vector<SolverLiteral>& values) const;
  void write(const StateLiterals& state, std::vector<SolverLiteral>& values) const;

  std::vector<GroundFluent> fluents_;
  std::vector<std::size_t> first_value_;
  std::vector<Action> actions_;
  std::unordered_map<std::string, int> fluent_numbers_;
  std::unordered_map<Clingo::Symbol, int> fluent_symbols_;
  std::unordered_map<std::string, int> action_numbers_;
  std::size_t num_values_ = 0;
  // Atoms of `fluent = value` before and after a transition, 0 where there is none.
  std::vector<GroundProgram::AtomId> before_;
  std::vector<GroundProgram::AtomId> now_;
  std::vector<std::vector<StepProgram::Price>> prices_;  // by action
  std::vector<PartialEvaluator> programs_;               // see the enumeration in the source
};

}  // namespace kr3::reasoner
