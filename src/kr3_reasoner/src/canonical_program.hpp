#pragma once

#include <cstddef>
#include <vector>

#include "local_table.hpp"

namespace kr3::reasoner
{

/// A local program with its atoms, values, assumptions and rules in an order of their own: programs
/// that are equal but for names and order mostly become equal. Private to the package.
///
/// Atoms are told apart by what the rules say of them, as colour refinement tells the nodes of a
/// graph apart (McKay, Piperno, *Practical graph isomorphism II*, 2014, section 2). Where that does
/// not suffice their first order decides, so that equal programs may be taken to be different, but
/// never the other way round.
class CanonicalProgram
{
public:
  /// @throws Cancelled, DeadlineExceeded  the limit was reached
  explicit CanonicalProgram(const LocalProgram& original, const SearchLimit& limit = {});

  [[nodiscard]] const LocalProgram& program() const { return program_; }

  /// A table of this program, its rows in any order, as one of the original.
  [[nodiscard]] LocalTable original(const LocalTable& table) const;

private:
  void takeFluents(const LocalProgram& original, const std::vector<Clingo::atom_t>& numbers);
  void takeAssumptions(const LocalProgram& original, const std::vector<Clingo::atom_t>& numbers);
  void takeRules(const LocalProgram& original, const std::vector<Clingo::atom_t>& numbers);

  LocalProgram program_;
  std::vector<std::vector<std::size_t>> values_;  // by fluent: the original's, of each value
  std::vector<std::size_t> assumptions_;          // the original's
};

}  // namespace kr3::reasoner
