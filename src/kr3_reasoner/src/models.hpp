#pragma once

#include <memory>
#include <string>
#include <vector>

#include "history_program.hpp"
#include "literal_truths.hpp"
#include "optimum.hpp"

namespace kr3::reasoner
{

/// What holds in all and in some of the models with minimal explanations, at every step of a
/// history.
class Consequences
{
public:
  Consequences(const Description& description, const HistoryProgram& program,
               const std::vector<CheckedRecord>& records, int current_step, const Optimum& optimum);

  [[nodiscard]] bool inAll(const Literal& literal, int step) const;
  [[nodiscard]] bool inSome(const Literal& literal, int step) const;

  /// The state of another solver's program for the same history, with constants where a value holds
  /// in all or in no models.
  [[nodiscard]] StateLiterals known(int step, StateLiterals state) const;

  /// The history, with literals of a solver that is gone: of interest are constants.
  [[nodiscard]] const UnrolledHistory& history() const { return *history_; }

private:
  std::shared_ptr<UnrolledHistory> history_;  // with the optimum, when it is constant
  LiteralTruths truths_;
};

/// One model: what it assumes, its atoms `h(F, V, t)` and `occ(A, t)`; the first and last sorted.
struct SymbolicModel
{
  std::vector<Clingo::Symbol> assumed;
  std::vector<Clingo::Symbol> holds;
  std::vector<Clingo::Symbol> occurs;
};

/// The models with minimal explanations, each once.
/// @param limit  the largest number, 0 for all
[[nodiscard]] std::vector<SymbolicModel> modelsOf(const HistoryProgram& program,
                                                  const std::vector<CheckedRecord>& records,
                                                  int current_step, const Optimum& optimum,
                                                  std::size_t limit);

/// Indices of a minimal set of records that are inconsistent together.
[[nodiscard]] std::vector<std::size_t> minimalConflict(const HistoryProgram& program,
                                                       const std::vector<CheckedRecord>& records,
                                                       int current_step);

}  // namespace kr3::reasoner
