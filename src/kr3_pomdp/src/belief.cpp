#include "kr3_pomdp/belief.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include <kr3_common/error.hpp>

#include "kr3_pomdp/model.hpp"

namespace kr3::pomdp
{

namespace
{

constexpr double kSumTolerance = 1e-6;

void checkShapes(const Model& model, const Belief& belief, std::size_t action)
{
  if (belief.size() != model.numStates())
  {
    throw InvalidArgument("belief over " + std::to_string(belief.size()) + " states, expected " +
                          std::to_string(model.numStates()));
  }
  if (action >= model.numActions())
  {
    throw InvalidArgument("action " + std::to_string(action) + " of " +
                          std::to_string(model.numActions()));
  }
}

/// sum_s T(s' | s, a) b(s), shape [num_states].
std::vector<double> predicted(const Model& model, const Belief& belief, std::size_t action)
{
  std::vector<double> prediction(model.numStates(), 0.0);
  for (std::size_t state = 0; state < belief.size(); ++state)
  {
    if (belief[state] == 0.0)
    {
      continue;
    }
    for (const SparseEntry& entry : model.transitions(action, state))
    {
      prediction[entry.index] += entry.probability * belief[state];
    }
  }
  return prediction;
}

}  // namespace

Belief::Belief(std::vector<double> probabilities) : probabilities_(std::move(probabilities))
{
  if (probabilities_.empty())
  {
    throw InvalidArgument("a belief over no states");
  }
  for (std::size_t state = 0; state < probabilities_.size(); ++state)
  {
    const double p = probabilities_[state];
    if (!std::isfinite(p) || p < 0.0)
    {
      throw InvalidArgument("belief in state " + std::to_string(state) + " is " +
                            std::to_string(p) + ", expected a probability");
    }
  }
  const double sum = std::accumulate(probabilities_.begin(), probabilities_.end(), 0.0);
  if (std::abs(sum - 1.0) > kSumTolerance)
  {
    throw InvalidArgument("belief sums to " + std::to_string(sum) + ", expected 1");
  }
  if (std::abs(sum - 1.0) > 1e-12)  // keep what is already exact to the last bits
  {
    for (double& p : probabilities_)
    {
      p /= sum;
    }
  }
}

BeliefUpdate updated(const Model& model, const Belief& belief, std::size_t action,
                     std::size_t observation)
{
  checkShapes(model, belief, action);
  if (observation >= model.numObservations())
  {
    throw InvalidArgument("observation " + std::to_string(observation) + " of " +
                          std::to_string(model.numObservations()));
  }
  std::vector<double> posterior = predicted(model, belief, action);
  double total = 0.0;
  for (std::size_t state = 0; state < posterior.size(); ++state)
  {
    if (posterior[state] == 0.0)
    {
      continue;
    }
    double likelihood = 0.0;
    for (const SparseEntry& entry : model.observations(action, state))
    {
      if (entry.index == observation)
      {
        likelihood = entry.probability;
      }
    }
    posterior[state] *= likelihood;
    total += posterior[state];
  }
  if (!(total > 0.0))
  {
    throw FailedPrecondition("observation '" + model.observationName(observation) +
                             "' is impossible after action '" + model.actionName(action) +
                             "' at this belief");
  }
  for (double& p : posterior)
  {
    p /= total;
  }
  return {Belief(std::move(posterior)), std::min(total, 1.0)};
}

std::vector<double> observationProbabilities(const Model& model, const Belief& belief,
                                             std::size_t action)
{
  checkShapes(model, belief, action);
  const std::vector<double> prediction = predicted(model, belief, action);
  std::vector<double> probabilities(model.numObservations(), 0.0);
  for (std::size_t state = 0; state < prediction.size(); ++state)
  {
    if (prediction[state] == 0.0)
    {
      continue;
    }
    for (const SparseEntry& entry : model.observations(action, state))
    {
      probabilities[entry.index] += entry.probability * prediction[state];
    }
  }
  return probabilities;
}

}  // namespace kr3::pomdp
