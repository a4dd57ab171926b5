#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include "dynamics.hpp"
#include "history_program.hpp"
#include "rule_sink.hpp"

namespace kr3::reasoner
{

/// Something that an explanation may assume, as a literal of the solver's program.
struct AssumedLiteral
{
  Clingo::Symbol what;    ///< `no(F,V)`, `yes(F,V)`, `exo(A,I)`, `fail(A,I)` or `wrong(R)`
  SolverLiteral literal;  ///< that it is assumed and has to be paid for
  int price;
  bool is_retraction;
};

/// What is known of the assumptions in minimal explanations: kTrueLiteral, in all; kOpen, in some.
/// Assumptions that are in none are left out.
using SettledAssumptions = std::unordered_map<Clingo::Symbol, SolverLiteral>;

/// What an explanation costs, part by part: assumptions that hang together are one part, and parts
/// that do not hang together have their least prices each for itself.
struct PriceByPart
{
  std::vector<Price> parts = {Price{}};  ///< the first has what is in no other
  std::unordered_map<Clingo::Symbol, std::size_t> part_of = {};

  [[nodiscard]] Price total() const;
  /// The part of what is assumed.
  [[nodiscard]] std::size_t partOf(Clingo::Symbol what) const;
};

/// A history as a path of states, written into a solver without grounding anything anew. It has the
/// answer sets of HistoryProgram's text. Private to the package.
class UnrolledHistory
{
public:
  struct Mode
  {
    Assumable assumable;
    const SettledAssumptions* settled = nullptr;  ///< if set, only these are assumed
    bool switchable = false;                      ///< records may be left out
  };

  /// @param program  keeps what was grounded; must outlive the unrolled history
  UnrolledHistory(const HistoryProgram& program, const std::vector<CheckedRecord>& records,
                  int current_step, Mode mode, RuleSink& sink);

  [[nodiscard]] Dynamics& dynamics() { return dynamics_; }
  [[nodiscard]] const Dynamics& dynamics() const { return dynamics_; }
  [[nodiscard]] int firstStep() const { return first_step_; }
  [[nodiscard]] int currentStep() const
  {
    return first_step_ + static_cast<int>(states_.size()) - 1;
  }
  [[nodiscard]] const StateLiterals& state(int step) const
  {
    return states_[static_cast<std::size_t>(step - first_step_)];
  }

  /// By action: the literal of its occurring between this step and the next.
  [[nodiscard]] const std::vector<SolverLiteral>& occurrences(int step) const
  {
    return occurrences_[static_cast<std::size_t>(step - first_step_)];
  }

  /// The literal of a ground literal of the language, statics included, at a step.
  [[nodiscard]] SolverLiteral literal(const Literal& literal, int step) const
  {
    return literalIn(literal, state(step));
  }

  /// The same in any state of these dynamics.
  [[nodiscard]] SolverLiteral literalIn(const Literal& literal, const StateLiterals& state) const;

  [[nodiscard]] const std::vector<AssumedLiteral>& assumptions() const { return assumptions_; }
  /// Assumptions have prices, so that it matters what they depend on.
  void useAssumptions(AtomComponents& components) const;

  /// By record: the literal of its being there and right.
  [[nodiscard]] const std::vector<SolverLiteral>& recorded() const { return holds_; }

  /// The literals of all atoms of the closure; none when the history was progressed.
  [[nodiscard]] const std::vector<SolverLiteral>& closureValues() const { return closure_values_; }

  /// Only explanations of which no part costs more than this. Nothing is open when the price is 0.
  void bound(const PriceByPart& price, RuleSink& sink) const;
  /// @return whether there is anything to minimise
  bool minimize(RuleSink& sink) const;

  /// If switchable: the literal of each record's being there.
  [[nodiscard]] const std::vector<SolverLiteral>& switches() const { return switches_; }

  /// Whether a default about a fluent fires.
  struct FiringDefault
  {
    Clingo::Symbol name;
    SolverLiteral literal;
  };
  [[nodiscard]] std::vector<FiringDefault> defaultsAbout(Clingo::Symbol fluent) const;

private:
  using Records = std::vector<CheckedRecord>;

  void addInitialState(const Records& records, RuleSink& sink);
  /// The initial state of a history that was progressed.
  void addBeginning(const Records& records, RuleSink& sink);
  void addComponent(const BeginningComponent& component, StateLiterals& known, RuleSink& sink);
  /// Whether these assumptions are all that a minimal explanation may and must make.
  [[nodiscard]] bool agrees(const BeginningComponent& component,
                            const std::vector<std::size_t>& explanation) const;
  void addTransition(const Records& records, int step, RuleSink& sink);
  void addObservation(const CheckedRecord& record, SolverLiteral holds, RuleSink& sink) const;
  [[nodiscard]] SolverLiteral retractable(const Records& records, std::size_t index,
                                          RuleSink& sink);
  [[nodiscard]] SolverLiteral failure(const CheckedRecord& attempt, SolverLiteral impossible,
                                      RuleSink& sink);
  /// A literal for what may be assumed: constant where that is settled.
  [[nodiscard]] SolverLiteral assume(Clingo::Symbol what, int price, bool is_retraction,
                                     RuleSink& sink);
  [[nodiscard]] SolverLiteral settled(Clingo::Symbol what) const;
  [[nodiscard]] bool staticHolds(const Literal& literal) const;

  const HistoryProgram& program_;
  Mode mode_;
  int first_step_;
  Dynamics& dynamics_;
  std::shared_ptr<Closure> closure_;
  std::vector<SolverLiteral> switches_;
  std::vector<SolverLiteral> holds_;  // by record: that it is there and not retracted
  std::vector<SolverLiteral> closure_values_;
  std::vector<StateLiterals> states_;
  std::vector<std::vector<SolverLiteral>> occurrences_;
  std::vector<AssumedLiteral> assumptions_;
};

}  // namespace kr3::reasoner
