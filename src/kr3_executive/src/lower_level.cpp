#include "lower_level.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <utility>

#include <kr3_pomdp/model_builder.hpp>
#include <kr3_pomdp/simulation.hpp>

namespace kr3::executive
{
namespace
{

using refinement::PomdpTask;
using refinement::StateId;

constexpr std::size_t kMaxSteps = 60;  // of a simulated run
constexpr std::size_t kMaxDraws = 200;
constexpr double kLeastDoubt = 1e-9;
/// Bounds between what is told of the odds that an action is possible: factors by which they grew.
constexpr double kBounds[] = {1.0 / 300, 1.0 / 30, 1.0 / 5, 1.0 / 1.5, 1.5, 5.0, 30.0};

double totalOf(const CoarseBelief& belief)
{
  double total = 0.0;
  for (const auto& entry : belief)
    total += entry.second;
  return total;
}

/// The coarse state that a physical state of a task is one of, if all it does not tell of is as in
/// another.
std::optional<StateId> overwritten(const PomdpTask& task, std::size_t state, CoarsePlan& plan,
                                   StateId other)
{
  std::vector<double> point(task.model().numStates(), 0.0);
  point[state] = 1.0;
  const pomdp::Belief belief(std::move(point));
  const std::vector<std::string> told = task.coarseFluents();
  std::vector<std::string> values;
  for (std::size_t i = 0; i < plan.space().fluents().size(); ++i)
  {
    const auto& fluent = plan.space().fluents()[i];
    values.push_back(plan.space().value(other, i));
    if (std::find(told.begin(), told.end(), fluent.name) == told.end())
      continue;
    for (const auto& [value, probability] : task.coarseMarginal(belief, fluent.name))
    {
      if (probability > 0.5 &&
          std::find(fluent.values.begin(), fluent.values.end(), value) != fluent.values.end())
        values.back() = value;
    }
  }
  return plan.space().find(values);
}

/// The values of what is known at the start of a mission, in a state.
std::vector<std::string> knownPart(CoarsePlan& plan, StateId state)
{
  std::vector<std::string> values;
  for (std::size_t i = 0; i < plan.space().fluents().size(); ++i)
  {
    if (std::find(plan.hidden().begin(), plan.hidden().end(), i) == plan.hidden().end())
      values.push_back(plan.space().value(state, i));
  }
  return values;
}

/// Seconds that the next action saves or costs in a physical state of a task against the mean over
/// all that its coarse state leaves open.
double savedSeconds(const PomdpTask& task, std::size_t state, const CoarsePlan& plan,
                    StateId coarse, const EndingLine& line)
{
  if (!line.next)
    return 0.0;
  std::vector<double> point(task.model().numStates(), 0.0);
  point[state] = 1.0;
  const pomdp::Belief belief(std::move(point));
  const auto nowhere = [](const std::string&) { return std::string(); };
  const auto where = [&](const std::string& fluent) {
    const auto& fluents = task.fluents();
    const bool told = std::any_of(fluents.begin(), fluents.end(),
                                  [&](const auto& known) { return known.name == fluent; });
    if (!told)
      return std::string();
    const auto values = task.fineMarginal(belief, fluent);
    return std::max_element(values.begin(), values.end(),
                            [](const auto& a, const auto& b) { return a.second < b.second; })
        ->first;
  };
  return plan.costFrom(coarse, *line.next, nowhere) - plan.costFrom(coarse, *line.next, where);
}

/// A physical state with the part of the task's states that are alike in what is known.
struct Place
{
  StateId coarse = 0;
  bool possible = false;
  std::vector<std::string> known;
};

/// What the start becomes in each part of the task's states that are alike in what is known.
struct Parts
{
  std::vector<std::optional<Place>> places;  ///< of each state; none: not physical
  std::map<std::vector<std::string>, CoarseStart> starts;
};

Parts partsOf(const PomdpTask& task, CoarsePlan& plan, const CoarseStart& start)
{
  Parts parts;
  parts.places.resize(task.model().numStates());
  for (std::size_t state = 0; state < task.model().numStates(); ++state)
  {
    if (task.kind(state) != PomdpTask::StateKind::kPhysical)
      continue;
    const bool possible = !task.isHopeless(state);
    CoarseBelief after;
    for (const auto& [other, probability] : possible ? start.possible : start.impossible)
    {
      if (const auto coarse = overwritten(task, state, plan, other))
        after[*coarse] += probability;
    }
    if (after.empty())
      after[start.supposed] = 1.0;
    Place place{after.begin()->first, possible, knownPart(plan, after.begin()->first)};
    CoarseStart& part = parts.starts[place.known];
    part.supposed = place.coarse;
    (possible ? part.possible : part.impossible) = std::move(after);
    parts.places[state] = std::move(place);
  }
  return parts;
}

/// Without those that are nowhere greater than another.
std::vector<std::vector<double>> undominated(std::vector<std::vector<double>> all)
{
  std::vector<std::vector<double>> kept;
  for (std::size_t i = 0; i < all.size(); ++i)
  {
    bool needed = true;
    for (std::size_t j = 0; j < all.size() && needed; ++j)
    {
      const bool covers = std::equal(all[i].begin(), all[i].end(), all[j].begin(),
                                     [](double a, double b) { return a <= b; });
      needed = !(covers && j != i && (all[i] != all[j] || j < i));
    }
    if (needed)
      kept.push_back(all[i]);
  }
  return kept;
}

/// What each way of ending is worth in each state of the task. What is known is known to the policy
/// too, so that a way may stand for another line in each part.
std::vector<std::vector<double>> worthOfEnding(const PomdpTask& task, CoarsePlan& plan,
                                               const CoarseStart& start, const EndingsOf& endings,
                                               double outside)
{
  Parts parts = partsOf(task, plan, start);
  const std::vector<std::string> unchanged = knownPart(plan, start.supposed);
  std::map<std::vector<std::string>, std::vector<EndingLine>> lines;
  std::size_t ways = 0;
  for (auto& [known, part] : parts.starts)
  {
    lines[known] = known == unchanged ? endings(start, true) : endings(part, false);
    ways = std::max(ways, lines[known].size());
  }
  std::vector<std::vector<double>> worth(ways, std::vector<double>(task.model().numStates(), 0.0));
  for (std::size_t state = 0; state < task.model().numStates(); ++state)
  {
    const auto& place = parts.places[state];
    for (std::size_t i = 0; i < ways; ++i)
    {
      if (!place)
      {
        worth[i][state] = task.kind(state) == PomdpTask::StateKind::kBoundary ? outside : 0.0;
        continue;
      }
      const auto& of_part = lines.at(place->known);
      const EndingLine& line = of_part[std::min(i, of_part.size() - 1)];
      worth[i][state] = (place->possible ? line.if_possible : line.if_impossible) +
                        savedSeconds(task, state, plan, place->coarse, line);
    }
  }
  return undominated(std::move(worth));
}

double oddsOfPossible(const PomdpTask& task, const pomdp::Belief& belief)
{
  const double hopeless =
      std::clamp(task.hopelessProbability(belief), kLeastDoubt, 1.0 - kLeastDoubt);
  return (1.0 - hopeless) / hopeless;
}

std::size_t toldOf(double factor)
{
  const auto* const bound = std::upper_bound(std::begin(kBounds), std::end(kBounds), factor);
  return 1 + static_cast<std::size_t>(bound - std::begin(kBounds));
}

struct Run
{
  bool was_possible = false;
  double cost = 0.0;      // discounted
  double discount = 1.0;  // of what follows, but for one step
  double possible = 0.0;  // probability at the end, if both were equally likely at first
  double success = 0.0;   // likewise
  std::size_t told = 0;
};

Run simulatedRun(const LowerProblem& problem, PolicyServer& policies, const std::string& policy,
                 double threshold, double discount, bool possible, std::mt19937_64& random)
{
  const PomdpTask& task = problem.begun.pomdp();
  pomdp::Belief belief = problem.begun.belief();
  std::size_t truth = pomdp::sampleState(belief, random);
  for (std::size_t draw = 0; draw < kMaxDraws && task.isHopeless(truth) == possible; ++draw)
    truth = pomdp::sampleState(belief, random);
  const double prior_odds = oddsOfPossible(task, belief);
  Run run;
  run.was_possible = !task.isHopeless(truth);
  double factor = 1.0;
  std::size_t step = 0;
  for (; step < kMaxSteps && task.successProbability(belief) <= threshold; ++step)
  {
    const std::size_t chosen = policies.actionAt(policy, belief);
    if (chosen >= task.finishAction())
      break;
    run.cost -= factor * task.model().reward(chosen, truth);
    factor *= discount;
    const auto sampled = pomdp::sampleStep(task.model(), truth, chosen, random);
    truth = sampled.next_state;
    belief = pomdp::updated(task.model(), belief, chosen, sampled.observation).posterior;
  }
  run.discount = step == 0 ? 1.0 : factor / discount;
  const double odds = oddsOfPossible(task, belief) / prior_odds;
  run.possible = odds / (1.0 + odds);
  const double success = task.successProbability(belief);
  const double left = std::max(1.0 - task.hopelessProbability(belief), kLeastDoubt);
  run.success = run.possible * std::min(1.0, success / left);
  run.told = success > threshold ? OptionOutcomes::kSucceeded : toldOf(odds);
  return run;
}

void add(OptionOutcomes::Case& to, const Run& run, double share, double success)
{
  to.succeeded[run.told] += success * run.discount;
  to.unchanged[run.told] += (share - success) * run.discount;
}

void scale(OptionOutcomes::Case& what, double total)
{
  const double factor = 1.0 / std::max(total, kLeastDoubt);
  for (auto* weights : {&what.succeeded, &what.unchanged})
  {
    for (double& weight : *weights)
      weight *= factor;
  }
}

}  // namespace

double CoarseStart::probability() const
{
  return totalOf(possible) / (totalOf(possible) + totalOf(impossible));
}

CoarseBelief CoarseStart::at(double probability) const
{
  CoarseBelief result;
  const double share = impossible.empty() ? 1.0 : possible.empty() ? 0.0 : probability;
  for (const auto& [state, weight] : possible)
    result[state] += share * weight / totalOf(possible);
  for (const auto& [state, weight] : impossible)
    result[state] += (1.0 - share) * weight / totalOf(impossible);
  return result;
}

CoarseStart coarseStart(CoarsePlan& plan, const CoarseBelief& belief, StateId supposed,
                        std::size_t action)
{
  CoarseStart start;
  start.supposed = supposed;
  for (const auto& [state, probability] : belief)
    (plan.space().executable(state, action) ? start.possible : start.impossible)[state] =
        probability;
  if (start.possible.empty())
    start.possible[supposed] = 1.0;
  return start;
}

pomdp::Model withEndings(const PomdpTask& task, CoarsePlan& plan, const CoarseStart& start,
                         const EndingsOf& endings, double outside)
{
  const pomdp::Model& model = task.model();
  const auto worth = worthOfEnding(task, plan, start, endings, outside);
  std::vector<std::string> states;
  for (std::size_t state = 0; state < model.numStates(); ++state)
    states.push_back(model.stateName(state));
  std::vector<std::string> actions;
  for (std::size_t action = 0; action < task.finishAction(); ++action)
    actions.push_back(model.actionName(action));
  for (std::size_t i = 0; i < worth.size(); ++i)
    actions.push_back(model.actionName(task.finishAction()) + "." + std::to_string(i));
  std::vector<std::string> observations;
  for (std::size_t observation = 0; observation < model.numObservations(); ++observation)
    observations.push_back(model.observationName(observation));
  pomdp::ModelBuilder builder(std::move(states), std::move(actions), std::move(observations));
  builder.setDiscount(model.discount());
  builder.setInitialBelief(model.initialBelief().probabilities());
  for (std::size_t action = 0; action < task.finishAction() + worth.size(); ++action)
  {
    const std::size_t original = std::min(action, task.finishAction());
    for (std::size_t state = 0; state < model.numStates(); ++state)
    {
      for (const auto& entry : model.transitions(original, state))
        builder.setTransition(action, state, entry.index, entry.probability);
      for (const auto& entry : model.observations(original, state))
        builder.setObservation(action, state, entry.index, entry.probability);
      builder.setReward(action, state,
                        action < task.finishAction() ? model.reward(action, state)
                                                     : worth[action - task.finishAction()][state]);
    }
  }
  return builder.build();
}

OptionOutcomes simulatedOutcomes(const LowerProblem& problem, PolicyServer& policies,
                                 const std::string& policy, const OptionTrials& trials,
                                 double discount)
{
  std::mt19937_64 random(trials.seed);
  OptionOutcomes outcomes;
  double possible = 0.0;
  double impossible = 0.0;
  double runs_possible = 0.0;
  double runs_impossible = 0.0;
  for (std::size_t i = 0; i < trials.samples; ++i)
  {
    const Run run =
        simulatedRun(problem, policies, policy, trials.threshold, discount, i % 2 == 1, random);
    add(outcomes.possible, run, run.possible, run.success);
    add(outcomes.impossible, run, 1.0 - run.possible, 0.0);
    possible += run.possible;
    impossible += 1.0 - run.possible;
    // What an action costs may depend on what is true but not told.
    (run.was_possible ? outcomes.possible : outcomes.impossible).cost += run.cost;
    (run.was_possible ? runs_possible : runs_impossible) += 1.0;
  }
  outcomes.possible.cost /= std::max(1.0, runs_possible);
  outcomes.impossible.cost /= std::max(1.0, runs_impossible);
  scale(outcomes.possible, possible);
  scale(outcomes.impossible, impossible);
  return outcomes;
}

}  // namespace kr3::executive
