#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "laws.hpp"
#include "models.hpp"

namespace kr3::reasoner
{

/// One minimal explanation with one closure of what is known initially: what the models that have
/// both agree on.
struct InitialWorld
{
  std::vector<Clingo::Symbol> assumed;         ///< the X of `ab(X)`, sorted
  std::unordered_set<Clingo::Symbol> closure;  ///< `c(F, V)`: F = V is known; `cn(F, V)`: F != V is

  /// Whether a ground literal is in the closure.
  [[nodiscard]] bool knows(const Literal& literal) const;
};

/// A history on one solver, in which records, ground defaults and laws can be taken away for a
/// question. Private to the package; not thread-safe.
class HistoryCheck
{
public:
  /// @param program  its options and limit are taken over
  HistoryCheck(const Description& description, const HistoryProgram& program,
               const std::vector<CheckedRecord>& records, int current_step);

  [[nodiscard]] const Laws& laws() const { return laws_; }

  /// All records, ground defaults and laws.
  [[nodiscard]] Cited all() const;

  /// When questions have to end from now on.
  void limitTo(const SearchLimit& limit) { solver_->limitTo(limit); }

  /// Whether what is kept entails a literal (Zhang et al. 2014, Definition 3). False when it is
  /// inconsistent.
  [[nodiscard]] bool entail(const Cited& kept, const Literal& literal, int step);

  /// The same without what is known of the first step of a history that was progressed.
  [[nodiscard]] bool entailWithoutBeginning(const Cited& kept, const Literal& literal, int step);

  [[nodiscard]] int firstStep() const { return program_.firstStep(); }

  /// The initial worlds of what is kept; empty when it is inconsistent or when there are more than
  /// `limit`.
  [[nodiscard]] std::vector<InitialWorld> worlds(const Cited& kept, std::size_t limit);

private:
  void choose(const Cited& kept);
  void allow(const Assumable& assumable);
  void set(const Clingo::Symbol& external, bool value);
  /// Leaves what is kept, and what the first level of assumptions that explains them
  /// may assume; the least price of that. Nothing when they are inconsistent.
  [[nodiscard]] std::optional<std::vector<std::int64_t>> minimalExplanation(const Cited& kept);
  /// The least price under the assumptions, as clingo's cost; nothing without a model.
  std::optional<std::vector<std::int64_t>> leastCost();
  bool hasModel(const std::vector<std::int64_t>& cost,
                const std::vector<Clingo::literal_t>& assumptions);
  void bound(const std::vector<std::int64_t>* cost);

  const Description& description_;
  Laws laws_;
  const Description switchable_;
  HistoryProgram program_;
  std::size_t num_records_;
  std::vector<Assumable> levels_;
  std::unique_ptr<Solver> solver_;
  std::unordered_map<std::string, std::vector<Clingo::Symbol>> defaults_;  // by ground name
  std::unordered_map<Clingo::Symbol, bool> externals_;                     // as they are set
};

}  // namespace kr3::reasoner
