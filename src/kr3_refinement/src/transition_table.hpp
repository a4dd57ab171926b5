#pragma once

#include <cstddef>
#include <optional>
#include <unordered_map>
#include <vector>

#include <kr3_pomdp/model.hpp>

#include "kr3_refinement/low_level_domain.hpp"
#include "kr3_refinement/models.hpp"
#include "semantics.hpp"

namespace kr3::refinement
{

/// How one action turns out in one state.
struct Outcomes
{
  bool executable = false;
  double seconds = 0.0;                  ///< what it costs; of an impossible one, impossible_s
  std::vector<pomdp::SparseEntry> next;  ///< by ascending state; sums to 1
};

/// What every ground action does in every state, and what that costs. States are numbered as
/// given; the boundary, where outcomes go that leave the zoom, is the next number. An action that
/// is impossible in a state leaves it as it is.
///
/// Source: docs/refinement.md. An immutable value.
class TransitionTable
{
public:
  /// @throws InternalError  an action leads to a state that is not among `states`
  TransitionTable(const LowLevelDomain& domain, const Models& models, const Semantics& semantics,
                  const std::vector<Values>& states, const std::vector<GroundAction>& actions);

  [[nodiscard]] std::size_t numStates() const { return num_states_; }
  [[nodiscard]] std::size_t boundary() const { return num_states_; }
  [[nodiscard]] std::size_t numActions() const { return outcomes_.size(); }

  [[nodiscard]] const Outcomes& outcomes(std::size_t action, std::size_t state) const
  {
    return outcomes_[action][state];
  }

  /// The action is carried out in some state and leads to this one.
  [[nodiscard]] std::vector<bool> arrivals(std::size_t action) const;

  /// States from which some sequence of actions may lead to one of `targets`, these included.
  /// @param targets  shape [numStates() + 1], the boundary last
  /// @return the same shape
  [[nodiscard]] std::vector<bool> canReach(const std::vector<bool>& targets) const;

private:
  std::size_t num_states_;
  std::vector<std::vector<Outcomes>> outcomes_;  // [action][state]
};

}  // namespace kr3::refinement
