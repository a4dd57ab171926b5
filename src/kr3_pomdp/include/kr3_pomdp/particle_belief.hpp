#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include "kr3_pomdp/online_planner.hpp"

namespace kr3::pomdp
{

struct ParticleOptions
{
  std::size_t num_particles = 1000;
  /// Without the model's observation probabilities: samples drawn for an update, per particle.
  std::size_t tries = 100;
};

/// A belief as samples of equal weight, for models from which one can only sample. Where a flat
/// Model exists, the exact Belief is better.
///
/// Invariant: at least one sample.
class ParticleBelief
{
public:
  /// @throws InvalidArgument  no states
  explicit ParticleBelief(std::vector<std::uint64_t> states);

  [[nodiscard]] const std::vector<std::uint64_t>& states() const { return states_; }

  /// The state at a number in [0, 1).
  [[nodiscard]] std::function<std::uint64_t(double)> sampler() const;

private:
  std::vector<std::uint64_t> states_;
};

/// The belief after an action and an observation, approximately.
///
/// If the model gives the probabilities of observations, every particle is moved, weighted and
/// drawn again in proportion (low-variance resampling); otherwise particles are moved until enough
/// of them made the observation. If none agrees, the particles are drawn anew with the model's
/// `perturbed` (which makes the filter approximate, but lets it recover), if it has one.
///
/// @throws InvalidArgument     an option out of range
/// @throws FailedPrecondition  no particle agrees with the observation, not even perturbed
/// Source: Silver and Veness (2010), Sec. 3.2; Thrun, Burgard, Fox (2005), Sec. 4.3.
[[nodiscard]] ParticleBelief updated(const GenerativeModel& model, const ParticleBelief& belief,
                                     std::size_t action, std::uint64_t observation,
                                     const ParticleOptions& options, std::mt19937_64& random);

}  // namespace kr3::pomdp
