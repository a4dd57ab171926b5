#pragma once

#include <cstddef>
#include <cstdint>
#include <random>

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

struct EvaluationLimits
{
  std::uint64_t trials = 1000;
  /// A trial ends when the discounted rest is below this part of what was possible at its start.
  double truncation = 1e-3;
  std::uint64_t max_steps = 10000;
};

/// Discounted return of a policy over simulated trials from the initial belief.
struct Evaluation
{
  double mean;
  double standard_error;
  double half_width_95;  ///< the mean is within this of the true value with 95 % confidence
  std::uint64_t trials;
  double mean_steps;
};

/// @throws InvalidArgument  a policy for another number of states or with an action that the model
///                          lacks; no trials
[[nodiscard]] Evaluation evaluate(const Model& model, const Policy& policy,
                                  const EvaluationLimits& limits, std::uint64_t seed);

}  // namespace kr3::pomdp
