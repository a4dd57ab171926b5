#pragma once

#include "kr3_pomdp/solver.hpp"

namespace kr3::pomdp
{

/// Parts of the solver that can be left out, to measure what each is worth; bounds stay sound
/// without them. At least one kind of trials is kept.
struct SolverParts
{
  bool classes = true;           ///< what the robot always knows is found, and splits the states
  bool informed_vectors = true;  ///< the upper bound starts from vectors, not from corner values
  bool noise_free_bound = true;  ///< upper bounds of searches, from sensors without noise
  bool belief_grid = true;       ///< value iteration over a grid of beliefs, for upper bounds
  bool sampled_trials = true;    ///< trials that follow the policy found so far
  bool upper_trials = true;      ///< trials that follow the upper bound
};

/// As solve(), with only these parts.
/// @throws InvalidArgument  as solve(); no trials
[[nodiscard]] SolveResult solveWith(const Model& model, const SolverLimits& limits,
                                    const SolverParts& parts,
                                    const ProgressCallback& keep_going = {},
                                    const Policy* first = nullptr);

}  // namespace kr3::pomdp
