#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "kr3_pomdp/model.hpp"
#include "kr3_pomdp/policy.hpp"

namespace kr3::pomdp
{

/// One sampled step of the world.
struct SampledStep
{
  std::size_t next_state;
  std::size_t observation;
};

/// @throws InvalidArgument  state or action out of range
[[nodiscard]] SampledStep sampleStep(const Model& model, std::size_t state, std::size_t action,
                                     std::mt19937_64& random);

[[nodiscard]] std::size_t sampleState(const Belief& belief, std::mt19937_64& random);

/// States from which nothing is earned any more, whatever is done, shape [num_states]: there a trial
/// is over. The greatest set of states without rewards that no action leaves.
[[nodiscard]] std::vector<bool> finishedStates(const Model& model);

struct EvaluationLimits
{
  std::uint64_t trials = 1000;
  /// A trial ends when the discounted rest is below this part of what was possible at its start.
  double truncation = 1e-3;
  std::uint64_t max_steps = 10000;
  int num_threads = 1;  ///< >= 1; the result is the same for any number
};

/// Discounted return of a policy over simulated trials from the initial belief.
struct Evaluation
{
  double mean;
  double standard_error;
  double half_width_95;  ///< the mean is within this of the true value with 95 % confidence
  std::uint64_t trials;
  double mean_steps;
  double finished;  ///< part of the trials that came to a state where all is over
};

/// Simulates trials in blocks, each with random numbers of its own, so that neither the number of
/// threads nor their pace shows in the result.
///
/// @throws InvalidArgument  a policy for another number of states or with an action that the model
///                          lacks; no trials, no threads, a truncation that is negative or no
///                          number
[[nodiscard]] Evaluation evaluate(const Model& model, const Policy& policy,
                                  const EvaluationLimits& limits, std::uint64_t seed);

}  // namespace kr3::pomdp
