#pragma once

#include <optional>
#include <vector>

#include "kr3_pomdp/exact_solver.hpp"
#include "kr3_pomdp/model.hpp"

/// Slow answers from the definitions, to hold fast ones against.
namespace kr3::pomdp::test
{

/// A bound of the absolute values, not 0.
[[nodiscard]] double scaleOf(const Model& model);

/// The exact solution to within 1e-5 of scaleOf(), or none where it needs many vectors.
[[nodiscard]] std::optional<ExactSolution> exactSolutionOf(const Model& model);

/// The value of the best plan over `horizon` steps from a belief: tries every action and outcome.
[[nodiscard]] double bestValueOver(const Model& model, const Belief& belief, int horizon);

/// What `action` earns at a belief, if `value` (Belief -> double) is earned from the next belief
/// on.
template <typename Value>
[[nodiscard]] double valueAhead(const Model& model, const Belief& belief, std::size_t action,
                                const Value& value)
{
  double sum = 0.0;
  for (std::size_t s = 0; s < model.numStates(); ++s)
  {
    sum += belief[s] * model.reward(action, s);
  }
  const std::vector<double> chances = observationProbabilities(model, belief, action);
  for (std::size_t o = 0; o < chances.size(); ++o)
  {
    if (chances[o] > 0.0)
    {
      sum += model.discount() * chances[o] * value(updated(model, belief, action, o).posterior);
    }
  }
  return sum;
}

/// The values of every conditional plan over `horizon` steps, shape [plans][num_states].
[[nodiscard]] std::vector<std::vector<double>> allPlans(const Model& model, int horizon);

/// Bayes' rule by summing over all sequences of states: the belief after actions and observations.
/// @param steps  action and observation, one after the other
/// @return not normalised: the sum is the probability of the observations
struct ActionAndObservation
{
  std::size_t action;
  std::size_t observation;
};
[[nodiscard]] std::vector<double> jointOver(const Model& model,
                                            const std::vector<ActionAndObservation>& steps);

}  // namespace kr3::pomdp::test
