#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include <clingo.hh>

#include "partial_evaluator.hpp"
#include "search_limit.hpp"

namespace kr3::reasoner
{

/// The closure of what is known initially (Zhang et al. 2014, Definition 1), grounded once for a
/// set of initial records, each of which may be left out later. Private to the package; not
/// thread-safe.
class Closure
{
public:
  using AtomId = GroundProgram::AtomId;

  /// @param rules       vocabulary and rules of the closure, as text
  /// @param statements  `init(F,V)` or `initn(F,V)` for each initial record, without repetition
  /// @param limit       of the grounding
  Closure(const std::string& rules, std::vector<std::string> statements,
          const SearchLimit& limit = {});

  /// `fluent = value`, or `!=`, may be in the closure.
  struct Entry
  {
    Clingo::Symbol fluent;
    Clingo::Symbol value;
    bool equal;
    AtomId atom;
  };

  /// The contrary of a default's head, which an explanation may assume.
  struct Exception
  {
    Clingo::Symbol what;  ///< `no(F,V)` or `yes(F,V)`
    int price;
    AtomId atom;
  };

  [[nodiscard]] const std::vector<std::string>& statements() const { return statements_; }
  [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }
  [[nodiscard]] const std::vector<Exception>& exceptions() const { return exceptions_; }

  /// Whether it was made for all of these statements.
  [[nodiscard]] bool covers(const std::vector<std::string>& statements) const;

  /// Values of a static.
  [[nodiscard]] const std::vector<Clingo::Symbol>& staticValues(Clingo::Symbol name) const;

  /// @param stated   by statement: the literal of its being recorded
  /// @param assumed  by exception: the literal of its being assumed
  /// @return the literals of all atoms
  [[nodiscard]] std::vector<SolverLiteral> instantiate(const std::vector<SolverLiteral>& stated,
                                                       const std::vector<SolverLiteral>& assumed,
                                                       RuleSink& sink);

  /// An instance of a default, with the atom of its firing.
  struct DefaultInstance
  {
    Clingo::Symbol name;
    AtomId fires;
  };

  /// The defaults whose heads are about a fluent.
  [[nodiscard]] const std::vector<DefaultInstance>& defaultsAbout(Clingo::Symbol fluent) const;

private:
  void readAtoms(const Clingo::SymbolicAtoms& atoms);

  std::vector<std::string> statements_;
  std::unordered_map<std::string, std::size_t> statement_numbers_;
  std::vector<AtomId> statement_atoms_;
  std::vector<Entry> entries_;
  std::vector<Exception> exceptions_;
  std::unordered_map<Clingo::Symbol, std::vector<Clingo::Symbol>> statics_;
  std::unordered_map<Clingo::Symbol, std::vector<DefaultInstance>> defaults_;  // by fluent
  std::vector<PartialEvaluator> program_;                                      // one
};

}  // namespace kr3::reasoner
