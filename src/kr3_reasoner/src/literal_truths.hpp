#pragma once

#include <unordered_map>
#include <vector>

#include "rule_sink.hpp"
#include "solver.hpp"

namespace kr3::reasoner
{

/// Which literals are true in all and in some of the answer sets of a solver's program. Constants
/// need no solving.
class LiteralTruths
{
public:
  LiteralTruths() = default;

  /// @param literals  those that will be asked about; when the program has no answer set, no atom
  /// is
  ///                  true in any
  LiteralTruths(Solver& solver, const std::vector<SolverLiteral>& literals);

  [[nodiscard]] bool inAll(SolverLiteral literal) const;
  [[nodiscard]] bool inSome(SolverLiteral literal) const { return !inAll(-literal); }

private:
  struct Truth
  {
    bool in_all = false;
    bool in_some = false;
  };
  std::unordered_map<SolverLiteral, Truth> truths_;  // by atom
};

}  // namespace kr3::reasoner
