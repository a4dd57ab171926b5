#pragma once

// A generated POMDP beside the abstract world: what each shows, and how to compare it.

#include <algorithm>
#include <functional>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <kr3_common/error.hpp>
#include <kr3_pomdp/belief.hpp>
#include <kr3_pomdp/simulation.hpp>
#include <kr3_pomdp/solver.hpp>
#include <kr3_refinement/pomdp_task.hpp>

#include "comparison_statistics.hpp"
#include "kr3_executive/abstract_world.hpp"
#include "kr3_executive/low_level_task.hpp"

namespace kr3::executive::test
{

using refinement::InitialKnowledge;
using refinement::LowLevelDomain;
using refinement::Models;
using refinement::PomdpTask;

/// One start of the world, with its probability.
struct Start
{
  double probability = 1.0;
  FluentValues coarse;
  FluentValues fine;
};

/// A high-level action in a state, with what is known, told in two ways: to the generator as
/// knowledge, to the world as starts.
struct Case
{
  std::string name;
  const LowLevelDomain* domain = nullptr;
  const Models* models = nullptr;
  std::vector<std::string> state;
  std::string action;
  InitialKnowledge knowledge;
  std::vector<Start> starts;

  [[nodiscard]] PomdpTask task(const Models& numbers) const
  {
    std::vector<reasoner::Literal> literals;
    for (const std::string& literal : state)
      literals.push_back(reasoner::parseGroundLiteral(literal, domain->highLevel()));
    const auto zoom = refinement::zoom(*domain, literals,
                                       reasoner::parseGroundAction(action, domain->highLevel()));
    return refinement::generatePomdp(*domain, numbers, zoom, knowledge);
  }
};

/// What one step shows: the observation and the coarse state after it.
inline std::string shown(const std::string& observation, const std::string& state)
{
  return observation + " | " + state;
}

inline const std::string kLeft = "boundary";

/// The coarse state of a task's state, "loc(rob1)=office, ...".
inline std::string coarseState(const PomdpTask& task, const LowLevelDomain& domain,
                               std::size_t state)
{
  if (task.kind(state) != PomdpTask::StateKind::kPhysical)
    return kLeft;
  std::map<std::string, std::string> values;
  for (std::size_t f = 0; f < task.fluents().size(); ++f)
  {
    const auto& fluent = task.fluents()[f];
    std::string& whole = values[coarseFluent(domain, fluent.name)];
    if (whole != "true")
      whole = domain.coarse(fluent.values[static_cast<std::size_t>(task.physicalState(state)[f])]);
  }
  std::string text;
  for (const auto& [fluent, value] : values)
    text += (text.empty() ? "" : ", ") + fluent + "=" + value;
  return text;
}

/// The world, seen as the task names things.
class WorldView
{
public:
  WorldView(const Case& c, const PomdpTask& task, std::uint64_t seed)
    : case_(c), task_(task), world_(*c.domain, *c.models, seed), random_(seed + 1)
  {
  }

  void reset()
  {
    double left = std::uniform_real_distribution<double>(0.0, 1.0)(random_);
    const Start* chosen = &case_.starts.back();
    for (const Start& start : case_.starts)
    {
      left -= start.probability;
      if (left < 0.0)
      {
        chosen = &start;
        break;
      }
    }
    world_.reset(chosen->coarse, chosen->fine);
    before_ = fine();
  }

  /// @return what is observed, by the model's name for it
  std::string execute(std::size_t action)
  {
    before_ = fine();
    const LowLevelAction executed{task_.actionText(action), task_.actionSymbol(action),
                                  task_.actionArguments(action)};
    const LowLevelResult result = world_.execute(executed, Disturbance{});
    std::string name;
    for (std::size_t i = 0; i < result.observation.size(); ++i)
    {
      const std::string& told = result.observation[i];
      const bool known =
          told == "true" || told == "false" || task_.zoom().constants.count(told) > 0;
      name += (i == 0 ? "" : ",") + (known ? told : refinement::kOutside);
    }
    return name.empty() ? refinement::kNoObservation : name;
  }

  /// The coarse state, or `boundary` when the last action took something out of the zoom.
  [[nodiscard]] std::string state() const
  {
    const FluentValues now = fine();
    std::map<std::string, std::string> values;
    for (const auto& [fluent, value] : now)
    {
      if (value == refinement::kElsewhere && before_.at(fluent) != value)
        return kLeft;
      std::string& whole = values[coarseFluent(*case_.domain, fluent)];
      if (whole != "true")
        whole = case_.domain->coarse(value);
    }
    std::string text;
    for (const auto& [fluent, value] : values)
      text += (text.empty() ? "" : ", ") + fluent + "=" + value;
    return text;
  }

private:
  /// The task's fluents; what is outside the zoom is elsewhere.
  [[nodiscard]] FluentValues fine() const
  {
    FluentValues result;
    for (const auto& fluent : task_.fluents())
    {
      const auto held = world_.fine().find(fluent.name);
      const std::string value = held == world_.fine().end() ? "false" : held->second;
      const bool inside =
          std::find(fluent.values.begin(), fluent.values.end(), value) != fluent.values.end();
      result[fluent.name] = inside ? value : refinement::kElsewhere;
    }
    return result;
  }

  const Case& case_;
  const PomdpTask& task_;
  AbstractWorld world_;
  std::mt19937_64 random_;
  FluentValues before_;
};

/// Distribution of (observation, coarse state) at each step of a sequence, exactly: T and O of the
/// model, without conditioning. Mass that has left the zoom stays `boundary`.
inline std::vector<Counts> predicted(const PomdpTask& task, const LowLevelDomain& domain,
                                     const std::vector<std::size_t>& actions)
{
  const pomdp::Model& model = task.model();
  std::vector<double> mass(model.numStates(), 0.0);
  for (std::size_t s = 0; s < mass.size(); ++s)
    mass[s] = model.initialBelief()[s];
  std::vector<Counts> steps;
  double gone = 0.0;
  for (const std::size_t action : actions)
  {
    std::vector<double> next(mass.size(), 0.0);
    for (std::size_t s = 0; s < mass.size(); ++s)
    {
      for (const auto& entry : model.transitions(action, s))
        next[entry.index] += mass[s] * entry.probability;
    }
    Counts& step = steps.emplace_back();
    if (gone > 0.0)
      step[kLeft] = gone;
    for (std::size_t s = 0; s < mass.size(); ++s)
    {
      for (const auto& entry : model.observations(action, s))
      {
        if (next[s] > 0.0)
          step[shown(model.observationName(entry.index), coarseState(task, domain, s))] +=
              next[s] * entry.probability;
      }
    }
    gone += next[task.boundaryState()];
    next[task.boundaryState()] = 0.0;
    mass = std::move(next);
  }
  return steps;
}

/// The same, counted in the world.
inline std::vector<Counts> counted(const Case& c, const PomdpTask& task,
                                   const std::vector<std::size_t>& actions, int trials,
                                   std::uint64_t seed)
{
  std::vector<Counts> steps(actions.size());
  WorldView world(c, task, seed);
  for (int trial = 0; trial < trials; ++trial)
  {
    world.reset();
    bool left = false;
    for (std::size_t step = 0; step < actions.size(); ++step)
    {
      if (left)
      {
        steps[step][kLeft] += 1.0;
        continue;
      }
      const std::string observation = world.execute(actions[step]);
      const std::string state = world.state();
      left = state == kLeft;
      steps[step][shown(observation, state)] += 1.0;
    }
  }
  return steps;
}

/// A random sequence: each action is one that can be carried out with some probability, except now
/// and then.
inline std::vector<std::size_t> randomActions(const PomdpTask& task, std::size_t length,
                                              std::mt19937_64& random)
{
  const pomdp::Model& model = task.model();
  std::size_t state = pomdp::sampleState(model.initialBelief(), random);
  std::vector<std::size_t> actions;
  while (actions.size() < length)
  {
    const std::size_t action =
        std::uniform_int_distribution<std::size_t>(0, task.finishAction() - 1)(random);
    const bool any = std::uniform_int_distribution<int>(0, 9)(random) == 0;
    if (any || task.isExecutable(action, state) || state == task.boundaryState())
    {
      actions.push_back(action);
      state = pomdp::sampleStep(model, state, action, random).next_state;
    }
  }
  return actions;
}

/// What the world shows under some sequences of actions.
struct Sample
{
  std::vector<std::vector<std::size_t>> sequences;
  std::vector<std::vector<Counts>> counts;  // [sequence][step]
  int trials = 0;
};

inline Sample sampled(const Case& c, int sequences, int trials, std::uint64_t seed)
{
  const PomdpTask task = c.task(*c.models);
  std::mt19937_64 random(seed);
  Sample sample;
  sample.trials = trials;
  for (int sequence = 0; sequence < sequences; ++sequence)
  {
    sample.sequences.push_back(randomActions(task, 4, random));
    sample.counts.push_back(counted(c, task, sample.sequences.back(), trials, random()));
  }
  return sample;
}

/// Open-loop sequences: the world's counts against a model's probabilities.
inline Comparison compareSequences(const Case& c, const Models& numbers, const Sample& sample)
{
  const PomdpTask task = c.task(numbers);
  Comparison comparison;
  for (std::size_t i = 0; i < sample.sequences.size(); ++i)
  {
    const std::vector<std::size_t>& actions = sample.sequences[i];
    const std::vector<Counts> model = predicted(task, *c.domain, actions);
    for (std::size_t step = 0; step < actions.size(); ++step)
    {
      comparison.add(fitP(sample.counts[i][step], model[step], sample.trials),
                     task.actionText(actions[step]) + " at step " + std::to_string(step));
    }
  }
  return comparison;
}

/// What a policy meets, step by step, and the end of it.
struct Run
{
  std::vector<std::string> steps;
  std::string story;  // all observations
};

/// Lets a policy act on its belief. @param act  executes an action: the observation, then the state
inline Run policyRun(const PomdpTask& task, const pomdp::Policy& policy, std::size_t length,
                     const std::function<std::pair<std::string, std::string>(std::size_t)>& act)
{
  const pomdp::Model& model = task.model();
  pomdp::Belief belief = model.initialBelief();
  Run run;
  while (run.steps.size() < length)
  {
    const std::size_t action = policy.actionAt(belief);
    if (action == task.finishAction())
      break;
    const auto [observation, state] = act(action);
    run.steps.push_back(task.actionText(action) + ": " + shown(observation, state));
    run.story += observation + ";";
    if (state == kLeft)
      break;
    const auto index = model.findObservation(observation);
    if (!index)
    {
      run.steps.back() = "an observation that the model does not have: " + observation;
      break;
    }
    try
    {
      belief = pomdp::updated(model, belief, action, *index).posterior;
    }
    catch (const FailedPrecondition&)
    {
      run.steps.back() = "an observation that the belief excludes: " + observation;
      break;
    }
  }
  run.steps.resize(length, "ended");
  return run;
}

/// A policy acting in the model and in the world: two samples.
inline Comparison comparePolicy(const Case& c, const Models& numbers, int trials,
                                std::uint64_t seed)
{
  constexpr std::size_t kLength = 8;
  const PomdpTask task = c.task(numbers);
  const pomdp::Model& model = task.model();
  pomdp::SolverLimits limits;
  limits.time_s = 0.0;
  limits.max_backups = 300;
  const pomdp::Policy policy = pomdp::solve(model, limits).policy;
  std::vector<Counts> in_model(kLength + 1);
  std::vector<Counts> in_world(kLength + 1);
  const auto add = [&](const Run& run, std::vector<Counts>& counts) {
    for (std::size_t step = 0; step < kLength; ++step)
      counts[step][run.steps[step]] += 1.0;
    counts[kLength][run.story] += 1.0;
  };
  std::mt19937_64 random(seed);
  WorldView world(c, task, random());
  for (int trial = 0; trial < trials; ++trial)
  {
    std::size_t state = pomdp::sampleState(model.initialBelief(), random);
    add(policyRun(
            task, policy, kLength,
            [&](std::size_t action) {
      const pomdp::SampledStep step = pomdp::sampleStep(model, state, action, random);
      state = step.next_state;
      return std::make_pair(model.observationName(step.observation),
                            coarseState(task, *c.domain, state));
            }),
        in_model);
    world.reset();
    add(policyRun(
            task, policy, kLength,
            [&](std::size_t action) {
      std::string observation = world.execute(action);
      return std::make_pair(std::move(observation), world.state());
            }),
        in_world);
  }
  Comparison comparison;
  for (std::size_t step = 0; step <= kLength; ++step)
    comparison.add(sameP(in_model[step], in_world[step]), "step " + std::to_string(step));
  return comparison;
}

}  // namespace kr3::executive::test
