#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include "kr3_pomdp/exact_solver.hpp"
#include "kr3_pomdp/model.hpp"
#include "kr3_pomdp/policy.hpp"
#include "kr3_pomdp/simulation.hpp"
#include "kr3_pomdp/solver.hpp"

namespace kr3::pomdp
{

/// The model cut off after `horizon` steps: its states are those of `model` with the number of
/// steps done, "state@step", number step * num_states + state, and one after the last step. The
/// step is known at all times, so solve() works on the states of one step at a time. Any discount.
///
/// It holds the transitions once for each step.
/// @param horizon  >= 1
/// @throws InvalidArgument  no steps; ResourceExhausted  more than 2^24 states
[[nodiscard]] Model overHorizon(const Model& model, std::size_t horizon);

/// What to do at each step of a run of fixed length: one policy for each step.
///
/// An immutable value; safe to use from several threads.
class HorizonPolicy
{
public:
  /// @param steps  policies over the same states, for the first step to the last
  /// @throws InvalidArgument  none, or for different numbers of states
  explicit HorizonPolicy(std::vector<Policy> steps);
  /// From a policy for overHorizon(model, horizon).
  /// @throws InvalidArgument  a policy for another number of states
  HorizonPolicy(const Policy& staged, std::size_t horizon);
  /// From an exact solution with a horizon.
  explicit HorizonPolicy(const ExactSolution& solution);

  [[nodiscard]] std::size_t horizon() const { return steps_.size(); }
  [[nodiscard]] std::size_t numStates() const { return steps_.front().numStates(); }
  /// The policy of a step, from 0.
  [[nodiscard]] const Policy& at(std::size_t step) const { return steps_.at(step); }

  /// @param step  steps done, below horizon()
  /// @throws InvalidArgument  a step out of range, a belief of another size
  [[nodiscard]] Policy::Choice bestAt(const Belief& belief, std::size_t step) const;

  /// The same policy for overHorizon(model, horizon()), for simulation there.
  [[nodiscard]] Policy staged() const;

  /// Text: a line `kr3_horizon_policy 1`, a line `horizon H`, and staged() as Policy::write() has
  /// it.
  void write(std::ostream& out) const;
  /// @param name  of the input, for messages
  /// @throws InvalidArgument  malformed; the message says where
  [[nodiscard]] static HorizonPolicy read(std::istream& in, const std::string& name);

private:
  std::vector<Policy> steps_;
};

struct HorizonResult
{
  HorizonPolicy policy;
  SolveResult result;  ///< its policy is for overHorizon(model, horizon)
};

/// Solves a model over a number of steps, with bounds; see solve().
///
/// @param horizon  steps, >= 1
/// @throws as solve() and overHorizon()
[[nodiscard]] HorizonResult solveOver(const Model& model, std::size_t horizon,
                                      const SolverLimits& limits,
                                      const ProgressCallback& keep_going = {});

/// Simulates a policy over its horizon; see evaluate() for a policy without.
[[nodiscard]] Evaluation evaluate(const Model& model, const HorizonPolicy& policy,
                                  const EvaluationLimits& limits, std::uint64_t seed);

}  // namespace kr3::pomdp
