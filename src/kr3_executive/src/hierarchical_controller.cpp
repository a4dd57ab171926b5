#include "hierarchical_controller.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <kr3_common/error.hpp>

#include "search_order.hpp"

namespace kr3::executive
{
namespace
{

using refinement::kElsewhere;
using refinement::StateId;

/// What success is worth to a lower task: little more than trying, much more than a mission takes.
constexpr double kLeastWorth_s = 30.0;
constexpr double kMostWorth_s = 20000.0;

/// To a step of a geometric scale, so that few different tasks are solved.
double rounded(double seconds)
{
  constexpr double kStep = 1.5;
  return std::pow(kStep, std::round(std::log(seconds) / std::log(kStep)));
}

/// A probability that stands for those near it, for the same reason.
double representativeOf(double probability)
{
  constexpr double kStep = 1.0;  // of the log-odds
  const double bounded = std::clamp(probability, 1e-4, 1.0 - 1e-4);
  const double steps = std::round(std::log(bounded / (1.0 - bounded)) / kStep);
  return 1.0 / (1.0 + std::exp(-steps * kStep));
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
                                               const std::shared_ptr<BaselineCache>& cache)
  : policies_(policies), config_(config)
{
  auto& kept = cache->coarse[keyOf(start.task(), reasoner::toString(goal), start.states())];
  if (!kept)
  {
    kept = std::make_shared<CoarsePlan>(start, goal, policies, config.budget,
                                        config.limits.threshold, options.option_samples);
  }
  plan_ = kept;
}

std::string HierarchicalController::highLevelAction() const
{
  return active_ ? active_->text : std::string();
}

std::string HierarchicalController::description() const
{
  return "hierarchy: " + std::to_string(plan_->space().actions().size()) +
         " high-level actions over " + std::to_string(plan_->space().fluents().size()) + " fluents";
}

std::optional<HierarchicalController::Choice> HierarchicalController::choose(
    const DomainBelief& belief)
{
  std::vector<StateId> states;
  std::vector<double> probability;
  for (const auto& [state, mass] : plan_->coarse(belief))
  {
    states.push_back(state);
    probability.push_back(mass);
  }
  if (states.empty())
    return std::nullopt;
  const auto likeliest = static_cast<std::size_t>(
      std::max_element(probability.begin(), probability.end()) - probability.begin());
  const auto stepOf = [&](StateId state, const std::optional<Route>& route,
                          std::optional<double> found_s) -> std::optional<Choice> {
    if (!route || route->steps.empty() || idle_.count({state, route->steps.front().action}) != 0)
      return std::nullopt;
    const std::size_t action = route->steps.front().action;
    return Choice{state, action, plan_->option(state, action).on_hidden ? found_s : std::nullopt};
  };
  if (probability[likeliest] > config_.limits.threshold)
    return stepOf(states[likeliest], plan_->goalFrom(states[likeliest]), std::nullopt);
  const ProspectOf prospect = [&](std::size_t from,
                                  std::size_t hypothesis) -> std::optional<Prospect> {
    const auto state = plan_->combined(static_cast<StateId>(from), states[hypothesis]);
    if (!state)
      return std::nullopt;
    const auto& test = plan_->testFrom(*state);
    if (!test || test->steps.empty() || idle_.count({*state, test->steps.front().action}) != 0)
      return std::nullopt;
    StateId at = *state;
    double way_s = 0.0;
    for (std::size_t i = 0; i + 1 < test->steps.size(); ++i)
    {
      way_s += test->steps[i].cost_s;
      at = test->steps[i].next;
    }
    const OptionModel& option = plan_->option(at, test->steps.back().action);
    const auto& rest = plan_->goalFrom(test->steps.back().next);
    if (!rest)
      return std::nullopt;
    return Prospect{way_s + option.failure_s, option.success_s - option.failure_s + rest->cost_s,
                    option.detection, at};
  };
  const auto first = firstToTest(probability, states[likeliest], prospect, {});
  if (!first)
    return stepOf(states[likeliest], plan_->goalFrom(states[likeliest]), std::nullopt);
  const auto state = plan_->combined(states[likeliest], states[*first]);
  double best_rate = 0.0;  // of the other hypotheses: probability found a second
  for (std::size_t other = 0; other < states.size(); ++other)
  {
    const auto found = other == *first ? std::nullopt : prospect(*state, other);
    if (found)
      best_rate = std::max(best_rate, probability[other] * found->detection / found->test_s);
  }
  return stepOf(*state, plan_->testFrom(*state),
                rounded(std::clamp(1.0 / std::max(best_rate, 1e-9), kLeastWorth_s, kMostWorth_s)));
}

refinement::InitialKnowledge HierarchicalController::knowledgeFor(const Choice& choice,
                                                                  const DomainBelief& belief,
                                                                  bool representative) const
{
  refinement::InitialKnowledge knowledge;
  const auto& domain = belief.task().domain();
  const auto& fluents = belief.task().space().fluents();
  for (std::size_t i = 0; i < fluents.size(); ++i)
  {
    refinement::Distribution values = belief.task().fineMarginal(belief.states(), i);
    const std::string whole = coarseFluent(domain, fluents[i].name);
    const auto coarse = plan_->space().findFluent(whole);
    const auto& hidden = plan_->hidden();
    const bool open = coarse && std::find(hidden.begin(), hidden.end(), *coarse) != hidden.end();
    if (!open || whole != fluents[i].name)
    {
      knowledge.fine[fluents[i].name] = std::move(values);
      continue;
    }
    const std::string& supposed = plan_->space().value(choice.state, *coarse);
    const auto components = domain.components(supposed);
    double inside = 0.0;
    for (const auto& component : components)
      inside += values.count(component) != 0 ? values.at(component) : 0.0;
    const double mass = representative || inside <= 0.0 ? representativeOf(inside) : inside;
    refinement::Distribution local;
    if (inside > 1.0 - 1e-9)
      local = std::move(values);
    else
    {
      for (const auto& component : components)
      {
        const double share = values.count(component) != 0 ? values.at(component) : 0.0;
        local[component] =
            representative || inside <= 0.0 ? mass / static_cast<double>(components.size()) : share;
      }
      const bool boolean = fluents[i].values == std::vector<std::string>{"false", "true"};
      local[boolean ? (supposed == "true" ? "false" : "true") : kElsewhere] = 1.0 - mass;
    }
    knowledge.fine[fluents[i].name] = std::move(local);
  }
  return knowledge;
}

bool HierarchicalController::begin(const Choice& choice, const DomainBelief& belief,
                                   const std::atomic<bool>& cancel)
{
  try
  {
    const auto actual = knowledgeFor(choice, belief, false);
    // One policy serves all beliefs that differ in what was seen before.
    const auto solved = plan_->task(choice.state, choice.action, knowledgeFor(choice, belief, true),
                                    choice.found_s);
    const std::string policy = policies_.solve(solved.model(), config_.budget, cancel).id;
    active_.emplace(Active{
        plan_->actionText(choice.action),
        LowLevelTask(belief.task().domain(),
                     plan_->task(choice.state, choice.action, actual, choice.found_s), actual),
        policy});
  }
  catch (const FailedPrecondition&)  // nothing to do there, or impossible
  {
    return false;
  }
  ++num_begun_;
  return true;
}

std::optional<std::size_t> HierarchicalController::next(const DomainBelief& belief,
                                                        const std::atomic<bool>& cancel)
{
  for (;;)
  {
    if (cancel)
      throw Cancelled("planning was cancelled");
    if (!active_)
    {
      const auto choice = choose(belief);
      if (!choice)
        return std::nullopt;
      // Until something is done, nothing is begun twice.
      idle_.insert({choice->state, choice->action});
      if (!begin(*choice, belief, cancel))
        continue;
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
    if (active_->task.isFinish(chosen))
    {
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
