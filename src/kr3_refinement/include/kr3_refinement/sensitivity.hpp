#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <kr3_pomdp/solver.hpp>

#include "kr3_refinement/pomdp_task.hpp"

namespace kr3::refinement
{

/// What a task is worth from one initial belief.
struct SensitivityPoint
{
  std::string start;  ///< the value that is certain where the belief is inside the zoom; empty:
                      ///< spread over the values as in the task
  double probability = 0.0;  ///< that the fluent has a value inside the zoom
  double lower = 0.0;        ///< bounds of what the best policy for this belief earns
  double upper = 0.0;
  std::size_t first_action = 0;  ///< of the policy found for this belief
  /// What the policy for the task's own belief earns at least, when this one is true; the two are
  /// equal where it does not matter which belief the robot was given.
  double nominal_policy = 0.0;
};

/// The first action is of one kind up to one probability and of another from another on.
struct FirstActionChange
{
  double below = 0.0;
  double above = 0.0;
  std::size_t from = 0;
  std::size_t to = 0;
};

/// How much a task rests on the initial belief that it was given (docs/refinement.md).
struct SensitivityReport
{
  std::string fluent;
  double nominal = 0.0;  ///< probability of a value inside the zoom in the task itself

  /// The weight of the hypothesis: mass inside the zoom against `elsewhere`, spread as in the task.
  /// Empty when the task gives one of the two no mass.
  std::vector<SensitivityPoint> by_mass;
  std::vector<FirstActionChange> changes;

  /// The spread inside the zoom: all of its mass on one value, with the task's weight. The value of
  /// a POMDP is convex in the belief, so no other spread is worth more than the best of these.
  std::vector<SensitivityPoint> by_value;

  /// A table for people.
  [[nodiscard]] std::string text(const PomdpTask& task) const;
};

struct SensitivityOptions
{
  std::vector<double> masses = {0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95};
  int bisections = 5;  ///< by which the place of each change of the first action is narrowed
  pomdp::SolverLimits limits;  ///< for each belief
};

/// Solves a task again for other beliefs about one hidden fluent; all else stays as it is.
///
/// @param fluent  a fine ground fluent of the task, "loc(tb1)"
/// @throws NotFound            the task has no such fluent
/// @throws FailedPrecondition  it is known at the start
/// @throws InvalidArgument     a mass outside [0, 1], or fewer than no bisections
[[nodiscard]] SensitivityReport sensitivity(const PomdpTask& task, const std::string& fluent,
                                            const SensitivityOptions& options = {});

}  // namespace kr3::refinement
