#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include <kr3_pomdp/model.hpp>
#include <kr3_pomdp/policy.hpp>
#include <kr3_pomdp/solver.hpp>

#include "coarse_plan.hpp"
#include "flat_model.hpp"

namespace kr3::executive
{

/// A belief over states of the high level.
using CoarseBelief = std::map<refinement::StateId, double>;

/// What the upper level does at a belief.
struct CoarseChoice
{
  enum class Kind : std::uint8_t
  {
    kCarryOut,  ///< the high-level action
    kLook,      ///< begin it, to find out whether it is possible
    kFinish,
  };
  Kind kind = Kind::kFinish;
  std::size_t action = 0;  ///< of the high level
  double value = 0.0;      ///< expected reward from here on
};

/// The upper level of the hierarchy as a POMDP that is solved ahead.
///
/// States are those of the high level, with `done`. An action takes as long, and succeeds as often,
/// as its low-level policy was simulated to (OptionModel); each whose possibility is hidden comes
/// twice, once to be carried out and once to look only. Time passes as on the low level: after an
/// option of k low-level steps the discount is that of k steps, by a transition to `done`.
///
/// Source: Sutton, Precup and Singh (1999), options; the discount of a semi-Markov process.
class CoarsePolicy
{
public:
  struct Limits
  {
    std::size_t max_rows = 400000;  ///< of actions times states
    pomdp::SolverLimits solver;
  };

  /// @param plan  must outlive the policy
  /// @throws ResourceExhausted  the model is larger than that
  CoarsePolicy(CoarsePlan& plan, const CoarseBelief& start, const Objective& objective,
               const Limits& limits, const std::atomic<bool>& cancel);

  /// @return nothing when the belief is not over the model's states
  [[nodiscard]] std::optional<CoarseChoice> choose(const CoarseBelief& belief) const;

  /// Bounds of the model's value at the start.
  [[nodiscard]] double lower() const { return lower_; }
  [[nodiscard]] double upper() const { return upper_; }
  [[nodiscard]] std::size_t numStates() const { return states_.size(); }

private:
  [[nodiscard]] std::optional<pomdp::Belief> dense(const CoarseBelief& belief) const;
  void enumerate(CoarsePlan& plan, const CoarseBelief& start, std::size_t max_rows);
  void findOptions(CoarsePlan& plan);
  [[nodiscard]] pomdp::Model build(CoarsePlan& plan, const CoarseBelief& start,
                                   const Objective& objective) const;

  std::vector<refinement::StateId> states_;
  std::unordered_map<refinement::StateId, std::size_t> number_;
  std::vector<CoarseChoice> actions_;  ///< of the model, without `finish`
  /// Of each high-level action where it is possible: the state that follows.
  std::vector<std::unordered_map<std::size_t, std::size_t>> results_;
  std::optional<pomdp::Policy> policy_;
  double lower_ = 0.0;
  double upper_ = 0.0;
};

}  // namespace kr3::executive
