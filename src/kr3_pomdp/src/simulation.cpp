#include "kr3_pomdp/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <kr3_common/error.hpp>

namespace kr3::pomdp
{

namespace
{

/// Uniform in [0, 1), the same with every standard library.
double uniform(std::mt19937_64& random)
{
  return static_cast<double>(random() >> 11) * 0x1.0p-53;
}

std::size_t sampleRow(const SparseRow& row, std::mt19937_64& random)
{
  double u = uniform(random);
  const SparseEntry* last = row.begin();
  for (const SparseEntry& entry : row)
  {
    last = &entry;
    u -= entry.probability;
    if (u < 0.0)
    {
      break;
    }
  }
  return last->index;
}

std::size_t sampleStart(const std::vector<InitialOutcome>& starts, std::mt19937_64& random)
{
  std::size_t i = 0;
  for (double u = starts.size() > 1 ? uniform(random) : 0.0; i + 1 < starts.size(); ++i)
  {
    u -= starts[i].probability;
    if (u < 0.0)
    {
      break;
    }
  }
  return i;
}

/// States that no action leaves and that earn nothing: a trial there is over.
std::vector<bool> finishedStates(const Model& model)
{
  std::vector<bool> finished(model.numStates(), true);
  for (std::size_t a = 0; a < model.numActions(); ++a)
  {
    for (std::size_t s = 0; s < model.numStates(); ++s)
    {
      const SparseRow row = model.transitions(a, s);
      finished[s] =
          finished[s] && model.reward(a, s) == 0.0 && row.size() == 1 && row.begin()->index == s;
    }
  }
  return finished;
}

}  // namespace

SampledStep sampleStep(const Model& model, std::size_t state, std::size_t action,
                       std::mt19937_64& random)
{
  if (state >= model.numStates() || action >= model.numActions())
  {
    throw InvalidArgument("state " + std::to_string(state) + " of " +
                          std::to_string(model.numStates()) + ", action " + std::to_string(action) +
                          " of " + std::to_string(model.numActions()));
  }
  const std::size_t next = sampleRow(model.transitions(action, state), random);
  return {next, sampleRow(model.observations(action, next), random)};
}

std::size_t sampleState(const Belief& belief, std::mt19937_64& random)
{
  double u = uniform(random);
  std::size_t last = 0;
  for (std::size_t s = 0; s < belief.size(); ++s)
  {
    if (belief[s] > 0.0)
    {
      last = s;
      u -= belief[s];
      if (u < 0.0)
      {
        break;
      }
    }
  }
  return last;
}

Evaluation evaluate(const Model& model, const Policy& policy, const EvaluationLimits& limits,
                    std::uint64_t seed)
{
  if (policy.numStates() != model.numStates() || policy.maxAction() >= model.numActions())
  {
    throw InvalidArgument("a policy over " + std::to_string(policy.numStates()) +
                          " states with actions up to " + std::to_string(policy.maxAction()) +
                          ", expected " + std::to_string(model.numStates()) + " states and " +
                          std::to_string(model.numActions()) + " actions");
  }
  if (limits.trials == 0)
  {
    throw InvalidArgument("0 trials, expected at least 1");
  }
  std::mt19937_64 random(seed);
  const std::vector<bool> finished = finishedStates(model);
  const std::vector<InitialOutcome> starts = model.initialOutcomes();
  double mean = 0.0;
  double squares = 0.0;  // sum of squared deviations (Welford)
  double steps = 0.0;
  for (std::uint64_t trial = 0; trial < limits.trials; ++trial)
  {
    const std::size_t start = sampleStart(starts, random);
    Belief belief = starts[start].belief;
    std::size_t state = sampleState(belief, random);
    double total = 0.0;
    double weight = 1.0;
    for (std::uint64_t step = 0;
         step < limits.max_steps && weight > limits.truncation && !finished[state]; ++step)
    {
      const std::size_t action = policy.actionAt(belief);
      total += weight * model.reward(action, state);
      const SampledStep sampled = sampleStep(model, state, action, random);
      belief = updated(model, belief, action, sampled.observation).posterior;
      state = sampled.next_state;
      weight *= model.discount();
      steps += 1.0;
    }
    const double deviation = total - mean;
    mean += deviation / static_cast<double>(trial + 1);
    squares += deviation * (total - mean);
  }
  const auto n = static_cast<double>(limits.trials);
  const double error = limits.trials > 1 ? std::sqrt(squares / (n - 1.0) / n) : 0.0;
  return {mean, error, 1.96 * error, limits.trials, steps / n};
}

}  // namespace kr3::pomdp
