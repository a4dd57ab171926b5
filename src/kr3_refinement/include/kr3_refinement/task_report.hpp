#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "kr3_refinement/pomdp_task.hpp"

namespace kr3::refinement
{

/// What is odd about a generated POMDP, by name. Lists are empty when all is well.
struct TaskReport
{
  std::size_t num_states = 0;     ///< physical ones
  std::size_t num_reachable = 0;  ///< of them, from the initial belief

  /// Rows of T and O, and the initial belief, that do not sum to 1 or have an entry outside [0, 1]:
  /// "T of search(rob1, c1, tb1) in loc(rob1)=c1,...: 0.98".
  std::vector<std::string> bad_rows;

  /// States that no sequence of actions leads to from the initial belief.
  std::vector<std::string> unreachable_states;

  /// Actions that cannot be carried out in any reachable state, as in the language.
  std::vector<std::string> impossible_actions;

  /// Observations that no action gives in any reachable state.
  std::vector<std::string> impossible_observations;

  /// Actions that are impossible in a reachable state and yet tell something of it, since the same
  /// state is where they lead from others: O(o | a, s') cannot tell the two apart. "peek(rob1) in
  /// lit=true"
  std::vector<std::string> misleading_observations;

  /// No reachable state has the high-level action's effects, so all that is left is giving up.
  bool unachievable = false;

  /// The model is a POMDP that can be used: no bad rows, not unachievable.
  [[nodiscard]] bool usable() const { return bad_rows.empty() && !unachievable; }

  /// For people: a line for each kind, saying how many there are and naming up to `max_names`.
  [[nodiscard]] std::string text(std::size_t max_names = 5) const;
};

/// What is wrong with a row of probabilities: "0.98 in all", "-0.1 among them"; empty when nothing.
[[nodiscard]] std::string rowProblem(const pomdp::SparseRow& row);

/// Checks a generated POMDP (docs/refinement.md): probabilities sum to 1, and what of it never
/// comes about is named.
[[nodiscard]] TaskReport validate(const PomdpTask& task);

}  // namespace kr3::refinement
