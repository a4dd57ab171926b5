#include "kr3_pomdp/particle_belief.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include <kr3_common/error.hpp>

namespace kr3::pomdp
{

namespace
{

double uniform(std::mt19937_64& random)
{
  return static_cast<double>(random() >> 11U) * 0x1.0p-53;
}

std::uint64_t drawn(const std::vector<std::uint64_t>& states, double u)
{
  const auto place = static_cast<std::size_t>(u * static_cast<double>(states.size()));
  return states[std::min(place, states.size() - 1)];
}

/// So many of the states, in proportion to their weights.
std::vector<std::uint64_t> resampled(const std::vector<std::uint64_t>& states,
                                     const std::vector<double>& weights, double total,
                                     std::size_t count, std::mt19937_64& random)
{
  std::vector<std::uint64_t> chosen;
  chosen.reserve(count);
  const double stride = total / static_cast<double>(count);
  double target = uniform(random) * stride;
  double sum = 0.0;
  for (std::size_t i = 0; i < states.size(); ++i)
  {
    sum += weights[i];
    for (; target < sum && chosen.size() < count; target += stride)
    {
      chosen.push_back(states[i]);
    }
  }
  while (chosen.size() < count)
  {
    chosen.push_back(chosen.back());  // rounding at the end of the sum
  }
  return chosen;
}

/// Particles of the next belief; none when nothing agrees with the observation.
/// @param source  gives the state to move
template <typename Source>
std::vector<std::uint64_t> moved(const GenerativeModel& model, std::size_t action,
                                 std::uint64_t observation, const ParticleOptions& options,
                                 std::mt19937_64& random, Source source)
{
  std::vector<std::uint64_t> states;
  std::vector<double> weights;
  double total = 0.0;
  const std::size_t tries = options.num_particles * options.tries;
  for (std::size_t i = 0; i < tries && states.size() < options.num_particles; ++i)
  {
    const GenerativeStep step = model.step(source(), action, uniform(random));
    const std::optional<double> probability =
        model.observationProbability(action, step.state, observation);
    if (probability || step.observation == observation)
    {
      states.push_back(step.state);
      weights.push_back(probability.value_or(1.0));
      total += weights.back();
    }
  }
  return total > 0.0 ? resampled(states, weights, total, options.num_particles, random)
                     : std::vector<std::uint64_t>();
}

}  // namespace

ParticleBelief::ParticleBelief(std::vector<std::uint64_t> states) : states_(std::move(states))
{
  if (states_.empty())
  {
    throw InvalidArgument("no particles, expected at least 1");
  }
}

std::function<std::uint64_t(double)> ParticleBelief::sampler() const
{
  return [states = states_](double random) { return drawn(states, random); };
}

ParticleBelief updated(const GenerativeModel& model, const ParticleBelief& belief,
                       std::size_t action, std::uint64_t observation,
                       const ParticleOptions& options, std::mt19937_64& random)
{
  if (action >= model.numActions() || options.num_particles == 0 || options.tries == 0)
  {
    throw InvalidArgument("action " + std::to_string(action) + " of " +
                          std::to_string(model.numActions()) + ", " +
                          std::to_string(options.num_particles) + " particles, " +
                          std::to_string(options.tries) + " tries, expected at least 1");
  }
  const std::vector<std::uint64_t>& states = belief.states();
  std::vector<std::uint64_t> next = moved(model, action, observation, options, random,
                                          [&] { return drawn(states, uniform(random)); });
  if (next.empty())
  {
    next = moved(model, action, observation, options, random, [&] {
      const std::uint64_t state = drawn(states, uniform(random));
      return model.perturbed(state, uniform(random)).value_or(state);
    });
  }
  if (next.empty())
  {
    throw FailedPrecondition("no particle agrees with the observation after action " +
                             std::to_string(action) + ": of " + std::to_string(states.size()) +
                             ", moved " + std::to_string(options.num_particles * options.tries) +
                             " times");
  }
  return ParticleBelief(std::move(next));
}

}  // namespace kr3::pomdp
