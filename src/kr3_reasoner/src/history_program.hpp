#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "assumable.hpp"
#include "beginning.hpp"
#include "closure.hpp"
#include "dynamics.hpp"
#include "encoding.hpp"
#include "history.hpp"
#include "kr3_reasoner/language.hpp"
#include "kr3_reasoner/reasoner.hpp"
#include "solver.hpp"

namespace kr3::reasoner
{

/// A description with a history as an answer set program.
///
/// Two layers (Zhang et al. 2014, Definitions 1 and 2): the closure `c(F, V)`, `cn(F, V)` (F = V is
/// known, F != V is known) of the initial records under defaults and constraints is founded; the
/// state `h(F, V, 0)` is any complete state that contains it. `ab(X)`: X is assumed. X is `no(F,
/// V)` (the contrary of a default's head F = V), `yes(F, V)` (of a head F != V), `exo(A, I)`,
/// `fail(A, I)` or `wrong(R)`, a record that is retracted.
///
/// A history that was progressed has a Beginning in place of the closure and the initial state.
class HistoryProgram
{
public:
  /// @param description  must outlive the program
  /// @param beginning    nullptr: step 0
  HistoryProgram(const Description& description, const ReasonerOptions& options,
                 std::shared_ptr<const Beginning> beginning = nullptr);

  [[nodiscard]] const Description& description() const { return description_; }
  [[nodiscard]] const ReasonerOptions& options() const { return options_; }

  /// When the question that the program is used for has to end.
  void limitTo(const SearchLimit& limit) { grounded_->limit = limit; }
  [[nodiscard]] const SearchLimit& limit() const { return grounded_->limit; }

  /// Where the history begins; nullptr: at step 0, with the closure.
  [[nodiscard]] const Beginning* beginning() const { return beginning_.get(); }
  [[nodiscard]] const std::shared_ptr<const Beginning>& sharedBeginning() const
  {
    return beginning_;
  }
  [[nodiscard]] int firstStep() const { return firstStepOf(beginning_.get()); }

  /// The same with another beginning. It shares what was grounded.
  [[nodiscard]] HistoryProgram beginningAt(std::shared_ptr<const Beginning> beginning) const;

  /// What is grounded once and kept; made when it is first asked for.
  [[nodiscard]] Dynamics& dynamics(bool exogenous) const;
  [[nodiscard]] std::shared_ptr<Closure> closureFor(
      const std::vector<CheckedRecord>& records) const;

  /// What a record says to the closure: `init(F,V)`, `initn(F,V)`, or nothing.
  [[nodiscard]] std::string initialStatement(const CheckedRecord& record) const;

  /// The program's parts that do not depend on the history.
  void addTo(Solver& solver) const;

  /// Adds and grounds records with everything up to `current_step`.
  /// @param switchable  each record r holds only while the external rec(r) is true, and the
  ///                    beginning only while `begun` is; which of its levels holds depends on
  ///                    `allowed(exogenous)` and `allowed(retraction)`
  void groundHistory(Solver& solver, const std::vector<CheckedRecord>& records, int current_step,
                     const Assumable& assumable, bool switchable = false) const;

  /// Restricts to explanations of at most this price.
  static void groundBound(Solver& solver, const Price& price);

  /// All of the program as text, its parts under `#program` headings.
  [[nodiscard]] std::string text(const std::vector<CheckedRecord>& records,
                                 const Assumable& assumable) const;

private:
  struct Grounded
  {
    SearchLimit limit;
    std::unique_ptr<Dynamics> dynamics;            // without exogenous actions
    std::unique_ptr<Dynamics> exogenous_dynamics;  // with them
    // Shared: a history that was unrolled keeps its closure when other records need another one.
    std::shared_ptr<Closure> closure;
  };

  [[nodiscard]] std::string closure() const;
  [[nodiscard]] std::string closureLiteral(const Literal& literal, const std::string& layer) const;
  [[nodiscard]] std::string closureBody(const Body& body, const std::string& layer) const;
  [[nodiscard]] std::string defaultRules(const Default& rule) const;
  [[nodiscard]] std::string constraintRules(const StateConstraint& constraint,
                                            const std::string& layer) const;
  [[nodiscard]] std::string exclusionRules(const StateConstraint& constraint) const;
  [[nodiscard]] std::string preferenceRules() const;
  [[nodiscard]] std::string weightRules() const;
  [[nodiscard]] std::string initialRules() const;
  [[nodiscard]] std::string beginningRules(const Assumable& assumable, bool switchable) const;
  [[nodiscard]] std::string recordRules(const std::vector<CheckedRecord>& records,
                                        const Assumable& assumable, bool switchable) const;

  const Description& description_;
  ReasonerOptions options_;
  Encoding encoding_;
  std::shared_ptr<const Beginning> beginning_;
  std::shared_ptr<Grounded> grounded_;
};

}  // namespace kr3::reasoner
