#include "oracles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <kr3_common/error.hpp>

namespace kr3::pomdp::test
{

namespace
{

double probabilityOf(const SparseRow& row, std::size_t index)
{
  for (const SparseEntry& entry : row)
  {
    if (entry.index == index)
    {
      return entry.probability;
    }
  }
  return 0.0;
}

}  // namespace

double scaleOf(const Model& model)
{
  double greatest = 1e-3;
  for (std::size_t a = 0; a < model.numActions(); ++a)
  {
    for (std::size_t s = 0; s < model.numStates(); ++s)
    {
      greatest = std::max(greatest, std::abs(model.reward(a, s)));
    }
  }
  return greatest / (1.0 - model.discount());
}

std::optional<ExactSolution> exactSolutionOf(const Model& model)
{
  ExactLimits limits;
  limits.precision = 1e-5 * scaleOf(model);
  limits.max_vectors = 1500;
  try
  {
    return solveExactly(model, limits);
  }
  catch (const ResourceExhausted&)
  {
    return std::nullopt;
  }
}

double bestValueOver(const Model& model, const Belief& belief, int horizon)
{
  if (horizon == 0)
  {
    return 0.0;
  }
  double best = -std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < model.numActions(); ++a)
  {
    const double value = valueAhead(model, belief, a, [&](const Belief& next) {
      return bestValueOver(model, next, horizon - 1);
    });
    best = std::max(best, value);
  }
  return best;
}

std::vector<std::vector<double>> allPlans(const Model& model, int horizon)
{
  if (horizon == 0)
  {
    return {std::vector<double>(model.numStates(), 0.0)};
  }
  const std::vector<std::vector<double>> rest = allPlans(model, horizon - 1);
  std::vector<std::vector<double>> plans;
  for (std::size_t a = 0; a < model.numActions(); ++a)
  {
    std::vector<std::size_t> choice(model.numObservations(), 0);  // which plan after which outcome
    for (bool more = true; more;)
    {
      std::vector<double> values(model.numStates());
      for (std::size_t s = 0; s < values.size(); ++s)
      {
        values[s] = model.reward(a, s);
        for (const SparseEntry& next : model.transitions(a, s))
        {
          for (const SparseEntry& seen : model.observations(a, next.index))
          {
            values[s] += model.discount() * next.probability * seen.probability *
                         rest[choice[seen.index]][next.index];
          }
        }
      }
      plans.push_back(std::move(values));
      std::size_t digit = 0;
      while (digit < choice.size() && ++choice[digit] == rest.size())
      {
        choice[digit++] = 0;
      }
      more = digit < choice.size();
    }
  }
  return plans;
}

std::vector<double> jointOver(const Model& model, const std::vector<ActionAndObservation>& steps)
{
  std::vector<double> joint(model.numStates(), 0.0);
  std::vector<std::size_t> path(steps.size() + 1, 0);  // one state before and after each step
  for (bool more = true; more;)
  {
    double probability = model.initialBelief()[path.front()];
    for (std::size_t i = 0; i < steps.size(); ++i)
    {
      probability *=
          probabilityOf(model.transitions(steps[i].action, path[i]), path[i + 1]) *
          probabilityOf(model.observations(steps[i].action, path[i + 1]), steps[i].observation);
    }
    joint[path.back()] += probability;
    std::size_t digit = 0;
    while (digit < path.size() && ++path[digit] == model.numStates())
    {
      path[digit++] = 0;
    }
    more = digit < path.size();
  }
  return joint;
}

}  // namespace kr3::pomdp::test
