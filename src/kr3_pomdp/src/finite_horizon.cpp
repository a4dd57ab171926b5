#include "kr3_pomdp/finite_horizon.hpp"

#include <string>
#include <utility>
#include <vector>

#include <kr3_common/error.hpp>

namespace kr3::pomdp
{

namespace
{

constexpr std::size_t kMaxStates = 1U << 24;

template <typename NameOf>
std::vector<std::string> names(std::size_t count, const NameOf& name_of)
{
  std::vector<std::string> result;
  result.reserve(count);
  for (std::size_t i = 0; i < count; ++i)
  {
    result.push_back(name_of(i));
  }
  return result;
}

/// T and O of all steps; after the last one comes the state `over`.
void appendRows(const Model& model, std::size_t action, std::size_t horizon,
                SharedRowsBuilder& transitions, SharedRowsBuilder& observations)
{
  const std::size_t num_states = model.numStates();
  const auto over = static_cast<std::uint32_t>(num_states * horizon);
  std::vector<SparseEntry> row;
  for (std::size_t step = 0; step < horizon; ++step)
  {
    const auto shift = static_cast<std::uint32_t>((step + 1) * num_states);
    for (std::size_t s = 0; s < num_states; ++s)
    {
      row.clear();
      for (const SparseEntry& next : model.transitions(action, s))
      {
        row.push_back({next.index + shift, next.probability});
      }
      if (step + 1 == horizon)
      {
        row.assign(1, {over, 1.0});
      }
      transitions.append(row);
      const SparseRow seen = model.observations(action, s);
      observations.append({seen.begin(), seen.end()});
    }
  }
  transitions.append({{over, 1.0}});
  observations.append({{0, 1.0}});
}

}  // namespace

Model overHorizon(const Model& model, std::size_t horizon)
{
  if (horizon == 0)
  {
    throw InvalidArgument("a horizon of 0 steps, expected at least 1");
  }
  const std::size_t num_states = model.numStates();
  if (horizon > (kMaxStates - 1) / num_states)
  {
    throw ResourceExhausted(std::to_string(horizon) + " steps of " + std::to_string(num_states) +
                            " states, expected at most " + std::to_string(kMaxStates) +
                            " states in all");
  }
  ModelParts parts;
  parts.states = names(num_states * horizon, [&](std::size_t s) {
    return model.stateName(s % num_states) + "@" + std::to_string(s / num_states);
  });
  parts.states.emplace_back("over");
  parts.actions = names(model.numActions(), [&](std::size_t a) { return model.actionName(a); });
  parts.observations =
      names(model.numObservations(), [&](std::size_t o) { return model.observationName(o); });
  parts.discount = model.discount();
  parts.initial_belief = model.initialBelief().probabilities();
  parts.initial_belief.resize(parts.states.size(), 0.0);
  parts.initial_labels = model.initialLabels();
  if (!parts.initial_labels.empty())
  {
    parts.initial_labels.resize(parts.states.size(), 0);
  }
  SharedRowsBuilder transitions;
  SharedRowsBuilder observations;
  for (std::size_t a = 0; a < model.numActions(); ++a)
  {
    appendRows(model, a, horizon, transitions, observations);
    for (std::size_t step = 0; step < horizon; ++step)
    {
      parts.rewards.insert(parts.rewards.end(), model.rewards(a), model.rewards(a) + num_states);
    }
    parts.rewards.push_back(0.0);
  }
  parts.transitions = transitions.take();
  parts.observation_rows = observations.take();
  return Model(std::move(parts));
}

HorizonResult solveOver(const Model& model, std::size_t horizon, const SolverLimits& limits,
                        const ProgressCallback& keep_going)
{
  SolveResult result = solve(overHorizon(model, horizon), limits, keep_going);
  HorizonPolicy policy(result.policy, horizon);
  return {std::move(policy), std::move(result)};
}

Evaluation evaluate(const Model& model, const HorizonPolicy& policy, const EvaluationLimits& limits,
                    std::uint64_t seed)
{
  if (policy.numStates() != model.numStates())
  {
    throw InvalidArgument("a policy over " + std::to_string(policy.numStates()) +
                          " states, expected " + std::to_string(model.numStates()));
  }
  EvaluationLimits over_horizon = limits;
  over_horizon.truncation = 0.0;
  over_horizon.max_steps = policy.horizon();
  return evaluate(overHorizon(model, policy.horizon()), policy.staged(), over_horizon, seed);
}

}  // namespace kr3::pomdp
