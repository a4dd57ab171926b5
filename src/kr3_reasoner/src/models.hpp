#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "history_program.hpp"
#include "literal_truths.hpp"
#include "unrolled_history.hpp"

namespace kr3::reasoner
{

/// The explanation level of a history: which kinds of assumption it takes, their minimal price, and
/// what minimal explanations assume.
struct Optimum
{
  Assumable assumable;
  PriceByPart price;
  int level = 0;  ///< how many kinds of assumption did not suffice, see findOptimum
  /// Nothing: not known, so that all that is assumable may be assumed.
  std::optional<SettledAssumptions> settled = std::nullopt;
  /// The history, when all of it is constant, so that it need not be unrolled again; or nullptr.
  std::shared_ptr<UnrolledHistory> constant_history = nullptr;
};

/// All that may be assumed, with exogenous actions or without; no record is wrong.
[[nodiscard]] Optimum anyPrice(bool exogenous);

/// Where to begin with the kinds of assumption, when a history is explained in independent parts:
/// all parts take the first level that explains every one.
struct ExplanationStart
{
  int level = 0;
  bool uncertain = false;  ///< another part has a record of confidence below 1
};

/// The kinds of assumption that are tried, one level after the other.
/// @param uncertain_otherwise  there are uncertain records elsewhere
[[nodiscard]] std::vector<Assumable> assumableLevels(const std::vector<CheckedRecord>& records,
                                                     int current_step, bool exogenous_first,
                                                     bool uncertain_otherwise = false);

/// The minimal price of explaining a history, or nothing when it is inconsistent. Exceptions to
/// defaults come first (and exogenous actions, if the options say so); if they do not explain,
/// exogenous actions; then retracted records.
[[nodiscard]] std::optional<Optimum> findOptimum(const HistoryProgram& program,
                                                 const std::vector<CheckedRecord>& records,
                                                 int current_step, bool exogenous_first,
                                                 const ExplanationStart& start = {});

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

/// The minimal explanations, each a sorted list of the X that are assumed at a price.
[[nodiscard]] std::vector<std::vector<Clingo::Symbol>> explanationsOf(
    const HistoryProgram& program, const std::vector<CheckedRecord>& records, int current_step,
    const Optimum& optimum);

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
