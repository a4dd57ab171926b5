#pragma once

#include <cstddef>
#include <vector>

#include "kr3_pomdp/model.hpp"
#include "kr3_pomdp/policy.hpp"

namespace kr3::pomdp
{

/// What to solve exactly, and when to give up.
struct ExactLimits
{
  std::size_t horizon = 0;  ///< steps; 0 = for ever
  /// Without a horizon: stop when the value is known to be this near the optimum at every belief.
  double precision = 1e-6;
  std::size_t max_vectors = 20000;  ///< of any one set before it is pruned
  double time_s = 0.0;              ///< wall time; 0 = no limit
};

/// The optimal value function, as the maximum of alpha vectors over all states.
struct ExactSolution
{
  /// With a horizon: element k is for k + 1 steps to go, shape [horizon]. Else one for all steps.
  std::vector<Policy> stages;
  /// The value at any belief is at most the optimum, and at most this much below it. With a horizon
  /// only what pruning loses; rounding of single sums (1e-15 of the values) is not counted.
  double error;
  std::size_t iterations;  ///< of value iteration

  /// With all steps to go.
  /// @throws InvalidArgument  belief of another size
  [[nodiscard]] double valueAt(const Belief& belief) const { return stages.back().valueAt(belief); }
};

/// The optimal value at the start: of the initial belief, or its expectation over the model's
/// initial outcomes.
[[nodiscard]] double startValue(const Model& model, const ExactSolution& solution);

/// Solves a small model exactly at every belief, by value iteration with incremental pruning: the
/// oracle that bounds are tested with. Its work grows exponentially with the horizon in the worst
/// case; models of ten states and a few actions and observations are what it is for.
///
/// @throws InvalidArgument    a precision that is not finite and positive, a time that is negative
/// or
///                            not finite, or a discount of 1 without a horizon
/// @throws ResourceExhausted  more vectors than allowed
/// @throws DeadlineExceeded   the time ran out
/// Sources: Cassandra, Littman and Zhang (1997), incremental pruning; Puterman (1994), Sec. 6.3,
/// the bound from the Bellman residual.
[[nodiscard]] ExactSolution solveExactly(const Model& model, const ExactLimits& limits);

}  // namespace kr3::pomdp
