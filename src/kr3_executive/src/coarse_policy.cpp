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

// Observations of the upper level.
constexpr std::size_t kNothing = 0;
constexpr std::size_t kYes = 1;
constexpr std::size_t kNo = 2;

/// What is paid in the course of `effort`, discounted step by step.
double discountedCost(const OptionEffort& effort, double discount)
{
  if (discount >= 1.0)
    return effort.seconds;
  return effort.seconds / effort.steps * (1.0 - std::pow(discount, effort.steps)) /
         (1.0 - discount);
}

OptionEffort mixed(const OptionEffort& a, const OptionEffort& b, double share)
{
  return {share * a.seconds + (1.0 - share) * b.seconds, share * a.steps + (1.0 - share) * b.steps};
}

}  // namespace

CoarsePolicy::CoarsePolicy(CoarsePlan& plan, const CoarseBelief& start, const Objective& objective,
                           const Limits& limits, const std::atomic<bool>& cancel)
{
  enumerate(plan, start, limits.max_rows);
  findOptions(plan);
  const pomdp::Model model = build(plan, start, objective);
  pomdp::SolveResult solved = pomdp::solve(
      model, limits.solver, [&cancel](const pomdp::SolverProgress&) { return !cancel; });
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

void CoarsePolicy::findOptions(CoarsePlan& plan)
{
  for (std::size_t action = 0; action < results_.size(); ++action)
  {
    if (!results_[action].empty())
      actions_.push_back({CoarseChoice::Kind::kCarryOut, action, 0.0});
  }
  for (std::size_t action = 0; action < results_.size(); ++action)
  {
    const bool hidden = std::any_of(
        results_[action].begin(), results_[action].end(),
        [&](const auto& entry) { return plan.option(states_[entry.first], action).on_hidden; });
    if (hidden)
      actions_.push_back({CoarseChoice::Kind::kLook, action, 0.0});
  }
}

pomdp::Model CoarsePolicy::build(CoarsePlan& plan, const CoarseBelief& start,
                                 const Objective& objective) const
{
  std::vector<std::string> state_names;
  for (std::size_t i = 0; i < states_.size(); ++i)
    state_names.push_back("s" + std::to_string(i));
  state_names.emplace_back("done");
  std::vector<std::string> action_names;
  for (const CoarseChoice& choice : actions_)
    action_names.push_back((choice.kind == CoarseChoice::Kind::kLook ? "look" : "do") +
                           std::to_string(choice.action));
  action_names.emplace_back("finish");
  pomdp::ModelBuilder builder(std::move(state_names), std::move(action_names),
                              {"nothing", "yes", "no"});
  const double discount = objective.discount;
  builder.setDiscount(discount);
  const std::size_t done = states_.size();
  std::vector<double> belief(done + 1, 0.0);
  double total = 0.0;
  for (const auto& entry : start)
    total += entry.second;
  for (const auto& [state, probability] : start)
    belief[number_.at(state)] = probability / total;
  builder.setInitialBelief(std::move(belief));

  for (std::size_t a = 0; a < actions_.size(); ++a)
  {
    const std::size_t action = actions_[a].action;
    const bool look = actions_[a].kind == CoarseChoice::Kind::kLook;
    std::vector<bool> arrived(done, false);
    for (const auto& entry : results_[action])
      arrived[entry.second] = true;
    for (std::size_t state = 0; state < done; ++state)
    {
      const auto result = results_[action].find(state);
      const bool possible = result != results_[action].end();
      const OptionModel option = plan.optionWhereHidden(states_[state], action);
      OptionEffort effort =
          possible ? mixed(option.success, option.failure, option.detection) : option.failure;
      if (look)
        effort = possible ? option.look.where_possible : option.look.where_impossible;
      const double goes_on = std::pow(discount, std::max(1.0, effort.steps) - 1.0);
      const double succeeds = possible && !look ? option.detection : 0.0;
      if (succeeds > 0.0)
        builder.addTransition(a, state, result->second, goes_on * succeeds);
      if (succeeds < 1.0)
        builder.addTransition(a, state, state, goes_on * (1.0 - succeeds));
      if (goes_on < 1.0)
        builder.addTransition(a, state, done, 1.0 - goes_on);
      builder.setReward(a, state, -discountedCost(effort, discount));
      const double yes = !look      ? (arrived[state] ? 1.0 : 0.0)
                         : possible ? option.look.detection
                                    : option.look.false_alarm;
      builder.addObservation(a, state, kYes, yes);
      builder.addObservation(a, state, kNo, 1.0 - yes);
    }
    builder.setTransition(a, done, done, 1.0);
    builder.setObservation(a, done, kNothing, 1.0);
  }
  const std::size_t finish = actions_.size();
  for (std::size_t state = 0; state <= done; ++state)
  {
    builder.setTransition(finish, state, done, 1.0);
    builder.setObservation(finish, state, kNothing, 1.0);
    if (state < done)
      builder.setReward(finish, state,
                        plan.holdsGoal(states_[state])  ? objective.success
                        : plan.goalFrom(states_[state]) ? objective.wrong_finish
                                                        : objective.given_up);
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

std::optional<CoarseChoice> CoarsePolicy::choose(const CoarseBelief& belief) const
{
  const auto at = dense(belief);
  if (!at)
    return std::nullopt;
  const auto best = policy_->bestAt(*at);
  CoarseChoice choice;
  if (best.action < actions_.size())
    choice = actions_[best.action];
  choice.value = best.value;
  return choice;
}

}  // namespace kr3::executive
