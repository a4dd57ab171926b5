#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

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

/// A history on one solver, in which records and ground defaults can be taken away for a question.
/// Private to the package; not thread-safe.
class HistoryCheck
{
public:
  HistoryCheck(const Description& description, const HistoryProgram& program,
               const std::vector<CheckedRecord>& records, int current_step, bool exogenous_first);

  /// When questions have to end from now on.
  void limitTo(const SearchLimit& limit) { solver_->limitTo(limit); }

  /// Whether these records entail a literal (Zhang et al. 2014, Definition 3). False when they are
  /// inconsistent.
  /// @param kept      for each record whether it is there
  /// @param defaults  ground names, "d1(tb1)", of the only defaults there; nullptr: all are
  [[nodiscard]] bool entail(const std::vector<bool>& kept, const std::set<std::string>* defaults,
                            const Literal& literal, int step);

  /// The ground names of all defaults.
  [[nodiscard]] std::set<std::string> defaultNames() const;

  /// The initial worlds of these records; empty when they are inconsistent or when there are more
  /// than `limit`.
  [[nodiscard]] std::vector<InitialWorld> worlds(const std::vector<bool>& kept,
                                                 const std::set<std::string>* defaults,
                                                 std::size_t limit);

private:
  void choose(const std::vector<bool>& kept, const std::set<std::string>* defaults);
  void allow(const Assumable& assumable);
  void set(const Clingo::Symbol& external, bool value);
  /// Leaves these records and defaults, and what the first level of assumptions that explains them
  /// may assume; the least price of that. Nothing when they are inconsistent.
  [[nodiscard]] std::optional<std::vector<std::int64_t>> minimalExplanation(
      const std::vector<bool>& kept, const std::set<std::string>* defaults);
  /// The least price under the assumptions, as clingo's cost; nothing without a model.
  std::optional<std::vector<std::int64_t>> leastCost();
  bool hasModel(const std::vector<std::int64_t>& cost,
                const std::vector<Clingo::literal_t>& assumptions);
  void bound(const std::vector<std::int64_t>* cost);

  const Description& description_;
  std::vector<Assumable> levels_;
  std::unique_ptr<Solver> solver_;
  std::unordered_map<std::string, std::vector<Clingo::Symbol>> defaults_;  // by ground name
  std::unordered_map<Clingo::Symbol, bool> externals_;                     // as they are set
};

}  // namespace kr3::reasoner
