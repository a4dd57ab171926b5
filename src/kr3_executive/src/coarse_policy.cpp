#include "coarse_policy.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <kr3_common/error.hpp>
#include <kr3_pomdp/model_builder.hpp>

namespace kr3::executive
{
namespace
{

using refinement::StateId;

// Observations of the upper level: nothing, else 1 + what OptionOutcomes says is told.
constexpr std::size_t kNothing = 0;

/// Gap of the bounds that is good enough, as a part of what a mission can win or lose.
constexpr double kGoodGap = 0.05;
/// And as a part of the value that may be possible: on a large floor, where little more than ending
/// is worth a long search, a policy of value 0 may be within the gap above, and wanders about.
constexpr double kMostMissed = 0.5;

/// In a cost: nothing is known of where the robot is, but its state of the high level.
std::string anywhere(const std::string& /*fluent*/)
{
  return {};
}

double sumOf(const std::vector<double>& weights)
{
  double sum = 0.0;
  for (const double weight : weights)
    sum += weight;
  return sum;
}

}  // namespace

CoarsePolicy::CoarsePolicy(CoarsePlan& plan, const CoarseBelief& start, const Objective& objective,
                           std::size_t variants, const OutcomesOf& outcomes, const Limits& limits,
                           const std::atomic<bool>& cancel)
  : objective_(objective)
{
  enumerate(plan, start, limits.max_rows);
  findChoices(plan, variants);
  model_ = build(plan, start, outcomes);
  pomdp::SolveResult solved = pomdp::solve(
      *model_, limits.solver, [&cancel](const pomdp::SolverProgress&) { return !cancel; });
  if (cancel)
    throw Cancelled("planning was cancelled");
  lower_ = solved.lower;
  upper_ = solved.upper;
  policy_ = std::move(solved.policy);
}

void CoarsePolicy::enumerate(CoarsePlan& plan, const CoarseBelief& start, std::size_t max_rows)
{
  const auto add = [this](StateId state) {
    const auto [entry, is_new] = number_.emplace(state, states_.size());
    if (is_new)
      states_.push_back(state);
    return entry->second;
  };
  for (const auto& entry : start)
    add(entry.first);
  const std::size_t num_actions = plan.space().actions().size();
  results_.resize(num_actions);
  for (std::size_t next = 0; next < states_.size(); ++next)
  {
    if (states_.size() * (num_actions + 1) > max_rows)
      throw ResourceExhausted("the upper level has more than " + std::to_string(max_rows) +
                              " rows of T (actions times states)");
    for (std::size_t action = 0; action < num_actions; ++action)
    {
      if (const auto result = plan.resultOf(states_[next], action))
        results_[action].emplace(next, add(*result));
    }
  }
}

void CoarsePolicy::findChoices(CoarsePlan& plan, std::size_t variants)
{
  for (std::size_t action = 0; action < results_.size(); ++action)
  {
    if (results_[action].empty())
      continue;
    const bool hidden = std::any_of(
        results_[action].begin(), results_[action].end(),
        [&](const auto& entry) { return plan.option(states_[entry.first], action).on_hidden; });
    for (std::size_t variant = 0; variant < (hidden ? variants : 1); ++variant)
      choices_.push_back({false, action, variant, 0.0});
  }
}

pomdp::Model CoarsePolicy::build(CoarsePlan& plan, const CoarseBelief& start,
                                 const OutcomesOf& outcomes) const
{
  std::vector<std::string> state_names;
  for (std::size_t i = 0; i < states_.size(); ++i)
    state_names.push_back("s" + std::to_string(i));
  state_names.emplace_back("done");
  std::vector<std::string> action_names;
  for (const CoarseChoice& choice : choices_)
    action_names.push_back(std::to_string(choice.action) + "." + std::to_string(choice.variant));
  action_names.emplace_back("finish");
  std::vector<std::string> observation_names{"nothing"};
  for (std::size_t told = 0; told < OptionOutcomes::kNumTold; ++told)
    observation_names.push_back("told" + std::to_string(told));
  pomdp::ModelBuilder builder(std::move(state_names), std::move(action_names),
                              std::move(observation_names));
  builder.setDiscount(objective_.discount);
  const std::size_t done = states_.size();
  std::vector<double> belief(done + 1, 0.0);
  double total = 0.0;
  for (const auto& entry : start)
    total += entry.second;
  for (const auto& [state, probability] : start)
    belief[number_.at(state)] = probability / total;
  builder.setInitialBelief(std::move(belief));

  for (std::size_t a = 0; a < choices_.size(); ++a)
  {
    const std::size_t action = choices_[a].action;
    // What is told in each state that the action can end in.
    std::vector<std::vector<double>> told(done, std::vector<double>(OptionOutcomes::kNumTold, 0.0));
    const auto tell = [&](std::size_t state, const std::vector<double>& weights) {
      for (std::size_t i = 0; i < weights.size(); ++i)
        told[state][i] += weights[i];
    };
    for (std::size_t state = 0; state < done; ++state)
    {
      const auto result = results_[action].find(state);
      const bool possible = result != results_[action].end();
      const auto supposed = plan.supposedFor(states_[state], action);
      if (!supposed)
      {
        // Never begun: were it allowed, failing would tell for nothing what the state is.
        builder.setTransition(a, state, done, 1.0);
        builder.setReward(a, state, objective_.wrong_finish);
        continue;
      }
      const OptionModel& option = plan.option(*supposed, action);
      if (!option.on_hidden)
      {
        builder.setTransition(a, state, possible ? result->second : state, 1.0);
        builder.setReward(a, state, -plan.costFrom(*supposed, action, anywhere));
        continue;
      }
      const OptionOutcomes& all = outcomes(*supposed, action, choices_[a].variant);
      const OptionOutcomes::Case& of = possible ? all.possible : all.impossible;
      const double succeeds = possible ? sumOf(of.succeeded) : 0.0;
      const double stays = sumOf(of.unchanged);
      if (possible)
      {
        builder.addTransition(a, state, result->second, succeeds);
        tell(result->second, of.succeeded);
      }
      builder.addTransition(a, state, state, stays);
      tell(state, of.unchanged);
      builder.addTransition(a, state, done, std::max(0.0, 1.0 - succeeds - stays));
      builder.setReward(a, state, -of.cost);
    }
    builder.setTransition(a, done, done, 1.0);
    builder.setObservation(a, done, kNothing, 1.0);
    for (std::size_t state = 0; state < done; ++state)
    {
      const double weight = sumOf(told[state]);
      if (!(weight > 0.0))
        builder.setObservation(a, state, kNothing, 1.0);
      for (std::size_t i = 0; weight > 0.0 && i < told[state].size(); ++i)
        builder.setObservation(a, state, 1 + i, told[state][i] / weight);
    }
  }
  const std::size_t finish = choices_.size();
  for (std::size_t state = 0; state <= done; ++state)
  {
    builder.setTransition(finish, state, done, 1.0);
    builder.setObservation(finish, state, kNothing, 1.0);
    if (state < done)
      builder.setReward(finish, state,
                        plan.holdsGoal(states_[state])  ? objective_.success
                        : plan.goalFrom(states_[state]) ? objective_.wrong_finish
                                                        : objective_.given_up);
  }
  return builder.build();
}

std::optional<pomdp::Belief> CoarsePolicy::dense(const CoarseBelief& belief) const
{
  std::vector<double> probabilities(states_.size() + 1, 0.0);
  double total = 0.0;
  for (const auto& [state, probability] : belief)
  {
    const auto found = number_.find(state);
    if (found == number_.end())
      return std::nullopt;
    probabilities[found->second] = probability;
    total += probability;
  }
  if (!(total > 0.0))
    return std::nullopt;
  for (double& probability : probabilities)
    probability /= total;
  return pomdp::Belief(std::move(probabilities));
}

bool CoarsePolicy::isGood() const
{
  const double gap = upper_ - lower_;
  return gap <= kGoodGap * objective_.stake() && gap <= kMostMissed * std::abs(upper_);
}

std::optional<double> CoarsePolicy::value(const CoarseBelief& belief) const
{
  const auto at = dense(belief);
  return at ? std::optional(policy_->valueAt(*at)) : std::nullopt;
}

double CoarsePolicy::actionValue(const pomdp::Belief& belief, std::size_t action) const
{
  const std::size_t num_states = model_->numStates();
  std::vector<std::vector<double>> after(model_->numObservations());
  double reward = 0.0;
  for (std::size_t state = 0; state < num_states; ++state)
  {
    if (belief[state] <= 0.0)
      continue;
    reward += belief[state] * model_->reward(action, state);
    for (const auto& next : model_->transitions(action, state))
    {
      for (const auto& seen : model_->observations(action, next.index))
      {
        auto& weights = after[seen.index];
        weights.resize(num_states, 0.0);
        weights[next.index] += belief[state] * next.probability * seen.probability;
      }
    }
  }
  for (auto& weights : after)
  {
    const double total = sumOf(weights);
    if (!(total > 0.0))
      continue;
    for (double& weight : weights)
      weight /= total;
    reward += model_->discount() * total * policy_->valueAt(pomdp::Belief(std::move(weights)));
  }
  return reward;
}

std::vector<CoarseChoice> CoarsePolicy::ranked(const CoarseBelief& belief) const
{
  const auto at = dense(belief);
  if (!at)
    return {};
  std::vector<CoarseChoice> result;
  for (std::size_t a = 0; a <= choices_.size(); ++a)
  {
    CoarseChoice choice = a < choices_.size() ? choices_[a] : CoarseChoice{};
    choice.value = actionValue(*at, a);
    result.push_back(choice);
  }
  std::stable_sort(result.begin(), result.end(),
                   [](const auto& x, const auto& y) { return x.value > y.value; });
  std::vector<CoarseChoice> distinct;
  for (const CoarseChoice& choice : result)
  {
    if (std::none_of(distinct.begin(), distinct.end(), [&](const CoarseChoice& other) {
          return other.is_finish == choice.is_finish && other.action == choice.action;
        }))
      distinct.push_back(choice);
  }
  return distinct;
}

}  // namespace kr3::executive
