#include "hierarchical_controller.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include <kr3_common/error.hpp>

#include "upper_level.hpp"

namespace kr3::executive
{
namespace
{

using refinement::StateId;

/// Belief that no further look can better.
constexpr double kCertain = 1.0 - 1e-9;
/// How often the same may be chosen in the same state without news.
constexpr int kMostTries = 3;
/// Change of a probability that counts as news.
constexpr double kNews = 1e-6;
/// What success is worth to a lower task: little more than trying, much more than a mission takes.
constexpr double kLeastWorth_s = 30.0;
constexpr double kMostWorth_s = 20000.0;

/// To a step of a geometric scale, so that few different tasks are solved.
double rounded(double seconds)
{
  constexpr double kStep = 1.5;
  return std::pow(kStep, std::round(std::log(seconds) / std::log(kStep)));
}

std::size_t numberOf(const refinement::DomainTask& task, const LowLevelAction& wanted)
{
  const auto& actions = task.space().actions();
  const auto found = std::find_if(actions.begin(), actions.end(), [&](const auto& action) {
    return action.symbol == wanted.symbol && action.arguments == wanted.arguments;
  });
  if (found == actions.end())
    throw InternalError("the domain's task has no action " + wanted.text);
  return static_cast<std::size_t>(found - actions.begin());
}

}  // namespace

HierarchicalController::HierarchicalController(const DomainBelief& start,
                                               const reasoner::Formula& goal,
                                               PolicyServer& policies, const DriverConfig& config,
                                               const BaselineOptions& options,
                                               const std::shared_ptr<BaselineCache>& cache,
                                               const std::atomic<bool>& cancel)
  : policies_(policies)
  , config_(config)
  , goal_(goal)
  , objective_(objectiveFor(start.task().domain(), start.task().models()))
{
  const std::string key = keyOf(start.task(), reasoner::toString(goal), start.states());
  auto& kept = cache->coarse[key];
  if (!kept)
  {
    kept = std::make_shared<CoarsePlan>(start, goal, policies, config.budget,
                                        config.limits.threshold, options.option_samples);
  }
  plan_ = kept;
  const auto solved = cache->coarse_policies.find(key);
  if (solved != cache->coarse_policies.end())
  {
    policy_ = solved->second;
    return;
  }
  try
  {
    UpperLevelOptions upper;
    upper.limits.max_rows = options.max_rows;
    upper.limits.solver.precision = options.budget.precision;
    upper.limits.solver.time_s = options.budget.time_s;
    upper.limits.solver.max_backups = options.budget.max_backups;
    upper.lower = config.budget;
    upper.threshold = config.limits.threshold;
    upper.samples = options.option_samples;
    policy_ = solvedUpperLevel(*plan_, plan_->coarse(start), objective_, policies, upper, cancel);
  }
  catch (const ResourceExhausted&)  // then without
  {
  }
  cache->coarse_policies[key] = policy_;
}

std::string HierarchicalController::highLevelAction() const
{
  return active_ ? active_->text : std::string();
}

std::string HierarchicalController::description() const
{
  std::string text = "hierarchy: " + std::to_string(plan_->space().actions().size()) +
                     " high-level actions over " + std::to_string(plan_->space().fluents().size()) +
                     " fluents";
  if (!policy_)
    return text + ", too large above to be solved";
  char bounds[64];
  std::snprintf(bounds, sizeof bounds, "[%.1f, %.1f]", policy_->lower(), policy_->upper());
  return text + ", " + std::to_string(policy_->numStates()) + " states above, value in " + bounds;
}

bool HierarchicalController::isSolved() const
{
  return policy_ && policy_->isGood();
}

std::optional<HierarchicalController::Choice> HierarchicalController::choose(
    const DomainBelief& belief)
{
  const CoarseBelief coarse = plan_->coarse(belief);
  if (coarse.empty())
    return std::nullopt;
  if (!isSolved())
    return choiceByOrder(coarse);
  return solvedChoice(coarse);
}

std::optional<HierarchicalController::Choice> HierarchicalController::solvedChoice(
    const CoarseBelief& belief) const
{
  for (const CoarseChoice& chosen : policy_->ranked(belief))
  {
    if (chosen.is_finish)
      return std::nullopt;
    const StateId* supposed = nullptr;
    double highest = 0.0;
    for (const auto& [state, probability] : belief)
    {
      if (probability > highest && plan_->space().executable(state, chosen.action))
      {
        highest = probability;
        supposed = &state;
      }
    }
    if (supposed == nullptr || idle_.count({*supposed, chosen.action}) != 0 ||
        isSpent(tries_, *supposed, chosen.action))
      continue;
    Choice choice{*supposed, chosen.action, std::nullopt, false, false};
    if (plan_->option(*supposed, chosen.action).on_hidden)
    {
      choice.objective = LowerObjective{0.0, objective_.discount};
      choice.is_paid = true;
    }
    return choice;
  }
  return std::nullopt;
}

std::optional<HierarchicalController::Choice> HierarchicalController::choiceByOrder(
    const CoarseBelief& belief)
{
  const Hypotheses all = hypothesesOf(belief);
  const auto& [states, probability, likeliest] = all;
  const auto stepOf = [&](StateId state, const std::optional<Route>& route,
                          std::optional<double> found_s) -> std::optional<Choice> {
    if (!route || route->steps.empty() || isIdle(state, *route))
      return std::nullopt;
    const std::size_t action = route->steps.front().action;
    Choice choice{state, action, std::nullopt, false, false};
    if (found_s && plan_->option(state, action).on_hidden)
      choice.objective = plan_->worthSeconds(*found_s);
    return choice;
  };
  if (probability[likeliest] > config_.limits.threshold && !plan_->holdsGoal(states[likeliest]))
    return stepOf(states[likeliest], plan_->goalFrom(states[likeliest]), std::nullopt);
  const ProspectOf prospect = prospectsOf(states);
  const auto first = orderOfTests(probability, states[likeliest], prospect, {});
  if (!first)
    return stepOf(states[likeliest], plan_->goalFrom(states[likeliest]), std::nullopt);
  const auto state = plan_->combined(states[likeliest], states[first->order.front()]);
  auto choice =
      stepOf(*state, plan_->testFrom(*state), worthOfFinding(all, *state, first->order.front()));
  if (choice)
    choice->is_look = plan_->holdsGoal(states[first->order.front()]);
  return choice;
}

ProspectOf HierarchicalController::prospectsOf(const std::vector<StateId>& states) const
{
  return [this, &states](std::size_t from, std::size_t hypothesis) -> std::optional<Prospect> {
    const auto state = plan_->combined(static_cast<StateId>(from), states[hypothesis]);
    if (!state)
      return std::nullopt;
    const auto& test = plan_->testFrom(*state);
    if (!test || test->steps.empty() || isIdle(*state, *test))
      return std::nullopt;
    StateId at = *state;
    double way_s = 0.0;
    for (std::size_t i = 0; i + 1 < test->steps.size(); ++i)
    {
      way_s += test->steps[i].cost_s;
      at = test->steps[i].next;
    }
    const OptionModel& option = plan_->option(at, test->steps.back().action);
    if (plan_->holdsGoal(*state))  // then it is enough to know that
    {
      const LookModel& look = option.look;
      return Prospect{way_s + look.where_impossible.seconds,
                      look.where_possible.seconds - look.where_impossible.seconds, look.detection,
                      at};
    }
    const auto& rest = plan_->goalFrom(test->steps.back().next);
    if (!rest)
      return std::nullopt;
    return Prospect{way_s + option.failure.seconds,
                    option.success.seconds - option.failure.seconds + rest->cost_s,
                    option.detection, at};
  };
}

bool HierarchicalController::isSpent(const Counts& counts, StateId from, std::size_t action)
{
  const auto count = counts.find({from, action});
  return count != counts.end() && count->second >= kMostTries;
}

bool HierarchicalController::isIdle(StateId from, const Route& route) const
{
  if (idle_.count({from, route.steps.front().action}) != 0)
    return true;
  StateId at = from;
  for (const auto& step : route.steps)
  {
    if (isSpent(fruitless_, at, step.action))
      return true;
    at = step.next;
  }
  return false;
}

void HierarchicalController::noticeNews(const CoarseBelief& belief)
{
  std::map<std::vector<std::string>, double> known;
  for (const auto& [state, probability] : belief)
  {
    std::vector<std::string> values;
    for (const std::size_t fluent : plan_->hidden())
      values.push_back(plan_->space().value(state, fluent));
    known[std::move(values)] += probability;
  }
  const bool as_before =
      known.size() == known_.size() &&
      std::equal(known.begin(), known.end(), known_.begin(), [](const auto& a, const auto& b) {
        return a.first == b.first && std::abs(a.second - b.second) < kNews;
      });
  if (as_before)
    return;
  known_ = std::move(known);
  fruitless_.clear();
  tries_.clear();
}

double HierarchicalController::worthOfFinding(const Hypotheses& all, StateId from,
                                              std::size_t hypothesis) const
{
  const ProspectOf prospect = prospectsOf(all.states);
  double best_rate = 0.0;  // of the other hypotheses: probability found a second
  for (std::size_t other = 0; other < all.states.size(); ++other)
  {
    const auto found = other == hypothesis ? std::nullopt : prospect(from, other);
    if (found)
      best_rate = std::max(best_rate, all.probability[other] * found->detection / found->test_s);
  }
  return rounded(std::clamp(1.0 / std::max(best_rate, 1e-9), kLeastWorth_s, kMostWorth_s));
}

bool HierarchicalController::isWorthSearching(const CoarseBelief& belief, double achieved) const
{
  const auto [states, probability, likeliest] = hypothesesOf(belief);
  const auto first = orderOfTests(probability, states[likeliest], prospectsOf(states), {});
  return first && endWorth(objective_, achieved) < objective_.success - first->expected_s;
}

bool HierarchicalController::isOver(const DomainBelief& belief)
{
  const CoarseBelief coarse = plan_->coarse(belief);
  const double achieved = belief.probability(goal_);
  if (coarse.empty() || achieved > kCertain)
    return true;
  if (isSolved())  // what is under way ends by itself
    return false;
  bool is_over = achieved > config_.limits.threshold;
  bool looks_on = false;
  if (is_over && isWorthSearching(coarse, achieved))
  {
    is_over = false;
    looks_on = true;
  }
  if (active_ && active_->looking && active_->done > 0 && !looks_on)
    active_.reset();
  return is_over;
}

std::optional<std::size_t> HierarchicalController::next(const DomainBelief& belief,
                                                        const std::atomic<bool>& cancel)
{
  for (;;)
  {
    if (cancel)
      throw Cancelled("planning was cancelled");
    if (isOver(belief))
      return std::nullopt;
    if (!active_)
    {
      noticeNews(plan_->coarse(belief));
      const auto choice = choose(belief);
      if (!choice)
        return std::nullopt;
      // Until something is done, nothing is begun twice.
      idle_.insert({choice->state, choice->action});
      begun_from_ = {choice->state, choice->action};
      ++tries_[begun_from_];
      if (!begin(*choice, belief, cancel))
      {
        ++fruitless_[begun_from_];
        continue;
      }
    }
    std::size_t chosen = 0;
    try
    {
      chosen = policies_.actionAt(active_->policy_id, active_->task.belief());
    }
    catch (const NotFound&)  // the server was restarted: begin again
    {
      active_.reset();
      idle_.clear();
      continue;
    }
    if (chosen >= active_->task.pomdp().finishAction())
    {
      if (active_->done == 0)
        ++fruitless_[begun_from_];
      active_.reset();
      continue;
    }
    active_->chosen = chosen;
    return numberOf(belief.task(), active_->task.action(chosen));
  }
}

void HierarchicalController::observed(const std::vector<std::string>& observation)
{
  idle_.clear();
  ++active_->done;
  const bool explained = active_->task.update(active_->chosen, observation);
  const Assessment assessment = active_->task.assess();
  const double threshold = config_.limits.threshold;
  if (!explained || assessment.achieved > threshold ||
      active_->done >= config_.limits.max_ll_actions)
    active_.reset();
}

}  // namespace kr3::executive
