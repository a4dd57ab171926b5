#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "history_program.hpp"
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
  /// What one of the minimal explanations assumes, sorted; if settled.
  std::vector<Clingo::Symbol> explanation = {};
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

}  // namespace kr3::reasoner
