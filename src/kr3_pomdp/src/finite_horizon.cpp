#include "kr3_pomdp/finite_horizon.hpp"

#include <algorithm>
#include <istream>
#include <numeric>
#include <ostream>
#include <sstream>
#include <utility>

#include <kr3_common/error.hpp>

namespace kr3::pomdp
{

namespace
{

constexpr const char* kMagic = "kr3_horizon_policy";
constexpr int kVersion = 1;
constexpr std::size_t kMaxStates = 1U << 24;
/// The value of a plan where it says nothing.
constexpr double kNoValue = -1e300;

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

/// The vectors of a policy for overHorizon(), by step.
std::vector<std::vector<AlphaVector>> byStep(const Policy& staged, std::size_t horizon,
                                             std::size_t num_states)
{
  std::vector<std::vector<AlphaVector>> result(horizon);
  for (AlphaVector& vector : staged.alphaVectors())
  {
    if (vector.states.empty())
    {
      for (std::size_t step = 0; step < horizon; ++step)
      {
        const auto first = vector.values.begin() + static_cast<std::ptrdiff_t>(step * num_states);
        std::vector<double> values(first, first + static_cast<std::ptrdiff_t>(num_states));
        if (std::any_of(values.begin(), values.end(), [](double v) { return v > kNoValue; }))
        {
          result[step].push_back({vector.action, {}, std::move(values)});
        }
      }
      continue;
    }
    const std::size_t step = vector.states.front() / num_states;
    if (step != vector.states.back() / num_states)
    {
      throw InvalidArgument("a vector over states of steps " + std::to_string(step) + " and " +
                            std::to_string(vector.states.back() / num_states) +
                            ", expected one step");
    }
    if (step < horizon)
    {
      for (std::uint32_t& s : vector.states)
      {
        s -= static_cast<std::uint32_t>(step * num_states);
      }
      if (vector.states.size() == num_states)
      {
        vector.states.clear();
      }
      result[step].push_back(std::move(vector));
    }
  }
  return result;
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

HorizonPolicy::HorizonPolicy(std::vector<Policy> steps) : steps_(std::move(steps))
{
  if (steps_.empty())
  {
    throw InvalidArgument("a policy for no steps, expected at least one");
  }
  for (const Policy& step : steps_)
  {
    if (step.numStates() != numStates())
    {
      throw InvalidArgument("policies of " + std::to_string(numStates()) + " and " +
                            std::to_string(step.numStates()) + " states for steps of one run");
    }
  }
}

HorizonPolicy::HorizonPolicy(const Policy& staged, std::size_t horizon)
{
  if (horizon == 0 || staged.numStates() <= horizon || (staged.numStates() - 1) % horizon != 0)
  {
    throw InvalidArgument("a policy over " + std::to_string(staged.numStates()) +
                          " states, expected some states for each of " + std::to_string(horizon) +
                          " steps, and one");
  }
  const std::size_t num_states = (staged.numStates() - 1) / horizon;
  for (const std::vector<AlphaVector>& vectors : byStep(staged, horizon, num_states))
  {
    steps_.emplace_back(num_states, vectors);
  }
}

HorizonPolicy::HorizonPolicy(const ExactSolution& solution)
  : HorizonPolicy(std::vector<Policy>(solution.stages.rbegin(), solution.stages.rend()))
{
}

Policy::Choice HorizonPolicy::bestAt(const Belief& belief, std::size_t step) const
{
  if (step >= horizon())
  {
    throw InvalidArgument("step " + std::to_string(step) + " of " + std::to_string(horizon()));
  }
  return steps_[step].bestAt(belief);
}

Policy HorizonPolicy::staged() const
{
  const std::size_t num_states = numStates();
  const std::size_t num_staged = num_states * horizon() + 1;
  // A policy has a vector over all states; no belief is spread over several steps, so it is not
  // used.
  std::vector<AlphaVector> vectors{{0, {}, std::vector<double>(num_staged, kNoValue)}};
  vectors.front().values.back() = 0.0;
  for (std::size_t step = 0; step < horizon(); ++step)
  {
    for (AlphaVector& vector : steps_[step].alphaVectors())
    {
      if (vector.states.empty())
      {
        vector.states.resize(num_states);
        std::iota(vector.states.begin(), vector.states.end(), 0U);
      }
      for (std::uint32_t& s : vector.states)
      {
        s += static_cast<std::uint32_t>(step * num_states);
      }
      vectors.push_back(std::move(vector));
    }
  }
  return Policy(num_staged, vectors);
}

void HorizonPolicy::write(std::ostream& out) const
{
  out << kMagic << ' ' << kVersion << "\nhorizon " << horizon() << '\n';
  staged().write(out);
}

HorizonPolicy HorizonPolicy::read(std::istream& in, const std::string& name)
{
  const auto header = [&](const std::string& key, int line_number) {
    std::string line;
    std::getline(in, line);
    std::istringstream words(line);
    std::string found;
    std::string rest;
    std::size_t value = 0;
    if (!(words >> found >> value) || found != key || words >> rest)
    {
      throw InvalidArgument(name + ":" + std::to_string(line_number) + ": found '" + line +
                            "', expected '" + key + "' and a number");
    }
    return value;
  };
  const std::size_t version = header(kMagic, 1);
  if (version != static_cast<std::size_t>(kVersion))
  {
    throw InvalidArgument(name + ":1: version " + std::to_string(version) + ", expected " +
                          std::to_string(kVersion));
  }
  const std::size_t horizon = header("horizon", 2);
  const Policy staged = Policy::read(in, name + " after line 2");
  try
  {
    return HorizonPolicy(staged, horizon);
  }
  catch (const InvalidArgument& e)
  {
    throw InvalidArgument(name + ": " + e.what());
  }
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
