#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "optimum.hpp"
#include "solver.hpp"

namespace kr3::reasoner
{

/// A history in a solver of its own. Private to the package.
struct SolvedHistory
{
  SolvedHistory(const HistoryProgram& program, const std::vector<CheckedRecord>& records,
                int current_step, const UnrolledHistory::Mode& mode,
                const std::vector<std::string>& arguments, AtomComponents* components = nullptr);

  /// With minimal explanations only. Where the optimum was searched for, the price is bounded and
  /// minimised: the bound alone says as much, but to show that nothing else costs as little is a
  /// matter of counting then, and the cores that prove a price minimal count.
  SolvedHistory(const HistoryProgram& program, const std::vector<CheckedRecord>& records,
                int current_step, const Optimum& optimum,
                const std::vector<std::string>& arguments);

  [[nodiscard]] bool isConsistent() { return is_constant || solver.isSatisfiable(); }

  /// Calls visit(model) for each model that differs in these literals, until it returns false. The
  /// solver is to be made with "--project=project".
  void forEachModel(const std::vector<SolverLiteral>& literals,
                    const std::function<bool(const Clingo::Model&)>& visit);

  Solver solver;
  std::unique_ptr<UnrolledHistory> history;
  bool is_constant = false;  ///< nothing is left to solve
  bool minimises = false;    ///< models before the optimum is proven are no answers
};

[[nodiscard]] std::vector<SolverLiteral> literalsOf(const std::vector<AssumedLiteral>& assumptions);

/// Of a literal of the solver, or a constant.
[[nodiscard]] bool isTrue(SolverLiteral literal, const Clingo::Model& model);

/// What a model assumes, sorted.
[[nodiscard]] std::vector<Clingo::Symbol> assumedIn(const Clingo::Model& model,
                                                    const UnrolledHistory& history);

}  // namespace kr3::reasoner
