#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include <clingo.hh>

#include "atom_components.hpp"
#include "ground_program.hpp"

namespace kr3::reasoner
{

/// A literal of a clingo program, or a constant; its negation is its arithmetic negative.
using SolverLiteral = Clingo::literal_t;
constexpr SolverLiteral kTrueLiteral = std::numeric_limits<SolverLiteral>::max();
constexpr SolverLiteral kFalseLiteral = -kTrueLiteral;

[[nodiscard]] constexpr bool isConstant(SolverLiteral literal)
{
  return literal == kTrueLiteral || literal == kFalseLiteral;
}

class Solver;

/// Writes ground rules into a clingo control, or into a program that is kept; constants are
/// simplified away. Open only between two solver calls, as the backend it writes to. Private to the
/// package.
class RuleSink
{
public:
  using Body = std::vector<SolverLiteral>;

  /// @param components  if not null, learns which atoms hang together
  explicit RuleSink(Clingo::Control& control, AtomComponents* components = nullptr)
    : backend_(control.backend()), components_(components)
  {
  }

  /// The same; the solver's control is only made when something is written.
  explicit RuleSink(Solver& solver, AtomComponents* components = nullptr)
    : solver_(&solver), components_(components)
  {
  }

  /// Into a program without rules so far, without a solver.
  explicit RuleSink(GroundProgram& program, AtomComponents* components = nullptr)
    : program_(&program), components_(components)
  {
  }

  /// Counts only: for finding out whether everything is constant, or what hangs together.
  explicit RuleSink(AtomComponents* components = nullptr) : components_(components) {}

  [[nodiscard]] SolverLiteral newAtom();

  /// An atom that may be true or false as it likes.
  [[nodiscard]] SolverLiteral newChoice();

  /// `head :- body`, or `{ head } :- body`. The head is an atom.
  void rule(bool choice, SolverLiteral head, Body body);

  /// `:- body`
  void constraint(Body body);

  /// A literal that is true exactly when all of these are; it is new unless one of them will do.
  [[nodiscard]] SolverLiteral conjunction(Body body);

  /// A literal that is true exactly when one of these is.
  [[nodiscard]] SolverLiteral disjunction(const Body& literals);

  /// `head :- bound <= sum of weights`, or a constraint when there is no head. Open literals only.
  void weightRule(bool choice, const std::vector<Clingo::atom_t>& head, int bound,
                  const std::vector<Clingo::WeightedLiteral>& body);

  /// At least one, and at most one, of these is true.
  void atLeastOne(Body literals);
  void atMostOne(const Body& literals);

  void minimize(int priority, const std::vector<Clingo::WeightedLiteral>& literals);

  /// No answer set, whatever else is said.
  void contradiction() { constraint({}); }

  /// `head_1 ; ... ; head_n :- body`. Open literals only.
  void disjunctiveRule(const Body& heads, const Body& body);

  /// How much was written: zero of both means that everything is constant.
  [[nodiscard]] std::size_t numAtoms() const { return num_atoms_; }
  [[nodiscard]] std::size_t numRules() const { return num_rules_; }
  /// How many constraints are violated whatever else is true.
  [[nodiscard]] std::size_t numContradictions() const { return num_contradictions_; }

private:
  void note(const Body& literals);

  /// Drops what is true. @return false when something is false
  [[nodiscard]] static bool simplify(Body& body);

  /// @return nullptr when nothing is written into a control
  [[nodiscard]] Clingo::Backend* backend();

  void write(bool choice, GroundProgram::Range<Clingo::atom_t> head, const Body& body);

  Solver* solver_ = nullptr;
  std::optional<Clingo::Backend> backend_;
  GroundProgram* program_ = nullptr;
  AtomComponents* components_ = nullptr;
  std::size_t num_atoms_ = 0;
  std::size_t num_rules_ = 0;
  std::size_t num_contradictions_ = 0;
};

}  // namespace kr3::reasoner
