#include "kr3_pomdp/solver.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include <kr3_common/error.hpp>

#include "belief_graph.hpp"
#include "kr3_pomdp/start_value.hpp"
#include "paced_question.hpp"
#include "search_team.hpp"
#include "solver_parts.hpp"
#include "supervisor.hpp"

namespace kr3::pomdp
{

namespace
{

/// After its deadline, a run still improves the plan for all states for so long.
constexpr double kPatience_s = 0.005;

void check(const SolverLimits& limits, bool has_callback)
{
  const auto valid = [](double value) { return std::isfinite(value) && value >= 0.0; };
  if (!valid(limits.precision) || !valid(limits.time_s))
  {
    throw InvalidArgument("precision " + std::to_string(limits.precision) + " and time " +
                          std::to_string(limits.time_s) + " s, expected both finite and >= 0");
  }
  if (limits.num_threads < 1)
  {
    throw InvalidArgument(std::to_string(limits.num_threads) + " threads, expected at least 1");
  }
  if (limits.precision == 0.0 && limits.time_s == 0.0 && limits.max_backups == 0 && !has_callback)
  {
    throw InvalidArgument("no precision, time, backups or callback: the run would never end");
  }
}

/// The value of doing one action for ever, in all states of the model: the best one from the start.
AlphaVector blindVector(const Model& model, const std::function<bool()>& keep_going)
{
  AlphaVector best;
  double best_value = -std::numeric_limits<double>::infinity();
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < model.numActions(); ++a)
  {
    least =
        std::min(least, *std::min_element(model.rewards(a), model.rewards(a) + model.numStates()));
  }
  PacedQuestion paced(keep_going);
  for (std::size_t a = 0; a < model.numActions(); ++a)
  {
    std::vector<double> values(model.numStates(), least / (1.0 - model.discount()));
    for (int sweep = 0; sweep < 300 && paced(model.numStates()); ++sweep)
    {
      for (std::size_t s = 0; s < values.size(); ++s)
      {
        double sum = 0.0;
        for (const SparseEntry& next : model.transitions(a, s))
        {
          sum += next.probability * values[next.index];
        }
        values[s] = std::max(values[s], model.reward(a, s) + model.discount() * sum);
      }
    }
    double value = 0.0;
    for (std::size_t s = 0; s < values.size(); ++s)
    {
      value += model.initialBelief()[s] * values[s];
    }
    if (value > best_value)
    {
      best_value = value;
      best = {a, {}, values};
    }
  }
  return best;
}

/// The same from what is known of blind plans within each class.
AlphaVector blindVector(const ObservedModel& observed, const InformedVectors& blind)
{
  const Model& model = observed.model();
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < model.numActions(); ++a)
  {
    least =
        std::min(least, *std::min_element(model.rewards(a), model.rewards(a) + model.numStates()));
  }
  AlphaVector best;
  double best_value = -std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < model.numActions(); ++a)
  {
    std::vector<double> values(model.numStates(), least / (1.0 - model.discount()));
    for (std::size_t c = 0; c < blind.size(); ++c)
    {
      const std::vector<std::uint32_t>& states = observed.classes()[c].states;
      for (std::size_t i = 0; i < states.size(); ++i)
      {
        values[states[i]] = std::max(values[states[i]], blind[c][a][i]);
      }
    }
    const double value = std::inner_product(values.begin(), values.end(),
                                            model.initialBelief().probabilities().begin(), 0.0);
    if (value > best_value)
    {
      best_value = value;
      best = {a, {}, std::move(values)};
    }
  }
  return best;
}

/// Plans for all states of a model with discount 1: the base plan where that is one action, else
/// each action and then the base plan.
std::vector<AlphaVector> plansForAll(const Model& model, const UndiscountedBounds& first)
{
  if (first.base_action)
  {
    return {{*first.base_action, {}, first.lower}};
  }
  std::vector<AlphaVector> plans;
  for (std::size_t a = 0; a < model.numActions(); ++a)
  {
    plans.push_back({a, {}, thenBasePlan(model, first, a)});
  }
  return plans;
}

/// @param vectors  plans for all states
Policy policyOf(const BeliefGraph& graph, std::vector<AlphaVector> vectors)
{
  const ObservedModel& observed = graph.model();
  for (std::size_t c = 0; c < observed.classes().size(); ++c)
  {
    const VectorSet& set = graph.vectors()[c];
    const std::vector<std::uint32_t>& states = observed.classes()[c].states;
    const bool all = states.size() == observed.model().numStates();
    for (std::uint32_t i = 0; i < set.end(); ++i)
    {
      if (set.isAlive(i))
      {
        vectors.push_back({set.action(i),
                           all ? std::vector<std::uint32_t>{} : states,
                           {set.values(i), set.values(i) + states.size()}});
      }
    }
  }
  return Policy(observed.model().numStates(), vectors);
}

/// The vectors of a policy in each class whose states they all cover.
Findings findingsOf(const ObservedModel& observed, const Policy& policy)
{
  Findings findings;
  for (const AlphaVector& vector : policy.alphaVectors())
  {
    for (std::size_t c = 0; c < observed.classes().size(); ++c)
    {
      std::vector<double> values;
      for (const std::uint32_t state : observed.classes()[c].states)
      {
        const auto at = std::lower_bound(vector.states.begin(), vector.states.end(), state);
        if (vector.states.empty())
        {
          values.push_back(vector.values[state]);
        }
        else if (at != vector.states.end() && *at == state)
        {
          values.push_back(vector.values[static_cast<std::size_t>(at - vector.states.begin())]);
        }
      }
      if (values.size() == observed.classes()[c].states.size())
      {
        findings.vectors.push_back({static_cast<std::uint32_t>(c),
                                    static_cast<std::uint32_t>(vector.action), std::move(values)});
      }
    }
  }
  return findings;
}

/// Leaves of each class only its values in single states: every action gets the greatest.
void keepCorners(InformedVectors& informed)
{
  for (std::vector<std::vector<double>>& vectors : informed)
  {
    std::vector<double> corners = vectors.front();
    for (const std::vector<double>& vector : vectors)
    {
      std::transform(vector.begin(), vector.end(), corners.begin(), corners.begin(),
                     [](double value, double corner) { return std::max(value, corner); });
    }
    std::fill(vectors.begin(), vectors.end(), corners);
  }
}

/// Asked while a policy is made: yes, but not for long once a run had to stop.
std::function<bool()> patience(const Supervisor& supervisor)
{
  const double end_s = supervisor.elapsedSeconds();
  return [&supervisor, end_s] {
    return !supervisor.isUrgent() || supervisor.elapsedSeconds() < end_s + kPatience_s;
  };
}

/// What a run gives that was stopped before it knew anything of the model but its rewards.
SolveResult blindResult(const Model& model, const Supervisor& supervisor)
{
  double greatest = -std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < model.numActions(); ++a)
  {
    const double* rewards = model.rewards(a);
    greatest = std::max(greatest, *std::max_element(rewards, rewards + model.numStates()));
  }
  Policy policy(model.numStates(), {blindVector(model, patience(supervisor))});
  const double lower = startValue(model, policy);
  return {std::move(policy),
          lower,
          std::max(lower, greatest / (1.0 - model.discount())),
          0,
          supervisor.reason(),
          supervisor.elapsedSeconds(),
          supervisor.cpuSeconds(),
          0};
}

/// @throws Abandoned  it was stopped before there were bounds; not where the discount is 1
SolveResult solvePrepared(const Model& model, const SolverLimits& limits, const SolverParts& parts,
                          const Policy* first_policy, Supervisor& supervisor)
{
  const auto in_time = [&supervisor] { return supervisor.mayPrepare(); };
  const ObservedModel observed(
      model, parts.classes,
      model.discount() < 1.0 ? std::function<bool()>(in_time) : std::function<bool()>());
  const std::optional<UndiscountedBounds> first =
      model.discount() < 1.0 ? std::nullopt
                             : std::make_optional(undiscountedBounds(observed, in_time));
  const UndiscountedBounds* start = first ? &*first : nullptr;
  InformedVectors informed = informedBound(observed, in_time, start);
  const InformedVectors blind = blindBound(observed, in_time, start);
  const bool cut_short = supervisor.isUrgent();
  if (!parts.informed_vectors)
  {
    keepCorners(informed);
  }
  SearchTeam team(observed, std::move(informed), blind, limits, parts, supervisor);
  if (first_policy != nullptr)
  {
    team.take(findingsOf(observed, *first_policy));
  }
  team.run();
  std::vector<AlphaVector> for_all;
  if (first)
  {
    for_all = plansForAll(model, *first);
  }
  else
  {
    for_all.push_back(cut_short ? blindVector(model, patience(supervisor))
                                : blindVector(observed, blind));
  }
  Policy policy = policyOf(team.graph(), std::move(for_all));
  const double lower = startValue(model, policy);
  return {std::move(policy),
          lower,
          std::max(lower, team.upper()),
          supervisor.backups(),
          supervisor.reason(),
          supervisor.elapsedSeconds(),
          supervisor.cpuSeconds(),
          team.sizeInBytes()};
}

}  // namespace

SolveResult solve(const Model& model, const SolverLimits& limits,
                  const ProgressCallback& keep_going, const Policy* first)
{
  return solveWith(model, limits, {}, keep_going, first);
}

SolveResult solveWith(const Model& model, const SolverLimits& limits, const SolverParts& parts,
                      const ProgressCallback& keep_going, const Policy* first)
{
  check(limits, static_cast<bool>(keep_going));
  if (first != nullptr &&
      (first->numStates() != model.numStates() || first->maxAction() >= model.numActions()))
  {
    throw InvalidArgument("a first policy of " + std::to_string(first->numStates()) +
                          " states and actions up to " + std::to_string(first->maxAction()) +
                          ", expected " + std::to_string(model.numStates()) + " and up to " +
                          std::to_string(model.numActions() - 1));
  }
  if (!parts.sampled_trials && !parts.upper_trials)
  {
    throw InvalidArgument(
        "found no trials, expected sampled ones, ones of the upper bound or both");
  }
  Supervisor supervisor(limits, keep_going);
  try
  {
    return solvePrepared(model, limits, parts, first, supervisor);
  }
  catch (const Abandoned&)
  {
    return blindResult(model, supervisor);
  }
}

}  // namespace kr3::pomdp
