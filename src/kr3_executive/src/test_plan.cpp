#include "test_plan.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "baseline_cache.hpp"

namespace kr3::executive
{
namespace
{

using refinement::StateId;

constexpr std::size_t kMaxNodes = 3000;

void addConstants(const reasoner::Formula& formula, const refinement::LowLevelDomain& domain,
                  std::set<std::string>& constants)
{
  for (const auto& operand : formula.operands)
    addConstants(operand, domain, constants);
  const auto add = [&](const std::string& constant) {
    constants.insert(constant);
    for (const auto& component : domain.components(constant))
      constants.insert(component);
  };
  if (formula.kind == reasoner::Formula::Kind::kLiteral)
  {
    for (const auto& argument : formula.literal.atom.arguments)
      add(argument.name);
    add(formula.literal.value.name);
  }
}

}  // namespace

std::vector<std::size_t> openFluents(const DomainBelief& belief)
{
  std::vector<std::size_t> open;
  const auto& space = belief.task().space();
  const StateId first = belief.states().begin()->first;
  for (std::size_t fluent = 0; fluent < space.fluents().size(); ++fluent)
  {
    const bool same =
        std::all_of(belief.states().begin(), belief.states().end(), [&](const auto& entry) {
          return space.value(entry.first, fluent) == space.value(first, fluent);
        });
    if (!same)
      open.push_back(fluent);
  }
  return open;
}

std::shared_ptr<TestPlan> testPlanFor(const DomainBelief& start, const reasoner::Formula& goal,
                                      BaselineCache& cache)
{
  auto& kept = cache.tests[keyOf(start.task(), reasoner::toString(goal), start.states())];
  if (!kept)
  {
    kept = std::make_shared<TestPlan>(start.task(), goal, openFluents(start));
    for (const auto& entry : start.states())
      static_cast<void>(kept->parts(entry.first));  // numbers them
  }
  return kept;
}

TestPlan::TestPlan(refinement::DomainTask& task, reasoner::Formula goal,
                   std::vector<std::size_t> hidden)
  : task_(task), goal_(std::move(goal))
{
  for (const std::size_t fluent : hidden)
  {
    bool sensed = false;
    for (std::size_t action = 0; action < task.numActions(); ++action)
    {
      const auto& laws = task.space().observations(action);
      sensed = sensed || std::any_of(laws.begin(), laws.end(), [&](const auto& law) {
                 return law.fluent == fluent && !law.caused;
               });
    }
    if (sensed)
      hidden_.push_back(fluent);
  }
  std::set<std::string> everywhere;
  addConstants(goal_, task.domain(), everywhere);
  for (const auto& action : task.space().actions())
  {
    for (const auto& argument : action.arguments)
    {
      if (!task.domain().map().find(argument))
        everywhere.insert(argument);
    }
  }
  for (std::size_t action = 0; action < task.numActions(); ++action)
  {
    std::vector<std::string> needed;
    for (const auto& argument : task.space().actions()[action].arguments)
    {
      if (everywhere.count(argument) == 0 &&
          std::find(needed.begin(), needed.end(), argument) == needed.end())
        needed.push_back(argument);
    }
    if (needed.empty())
      always_.push_back(action);
    else
      about_[needed.front()].push_back(action);
    needs_.push_back(std::move(needed));
  }
}

bool TestPlan::isHidden(std::size_t fluent) const
{
  return std::find(hidden_.begin(), hidden_.end(), fluent) != hidden_.end();
}

TestPlan::Parts TestPlan::parts(StateId state)
{
  const auto [entry, is_new] = parts_.try_emplace(state);
  if (is_new)
  {
    std::vector<std::string> place;
    std::vector<std::string> hidden;
    for (std::size_t fluent = 0; fluent < task_.space().fluents().size(); ++fluent)
      (isHidden(fluent) ? hidden : place).push_back(task_.space().value(state, fluent));
    const auto numberOf = [state](auto& numbers, auto& states, std::vector<std::string> values) {
      const auto [found, is_first] =
          numbers.try_emplace(std::move(values), static_cast<std::uint32_t>(states.size()));
      if (is_first)
        states.push_back(state);
      return found->second;
    };
    entry->second = {numberOf(place_numbers_, places_, std::move(place)),
                     numberOf(hidden_numbers_, hidden_values_, std::move(hidden))};
  }
  return entry->second;
}

std::optional<StateId> TestPlan::state(const Parts& parts)
{
  std::vector<std::string> values;
  for (std::size_t fluent = 0; fluent < task_.space().fluents().size(); ++fluent)
  {
    values.push_back(task_.space().value(
        isHidden(fluent) ? hidden_values_.at(parts.hidden) : places_.at(parts.place), fluent));
  }
  return task_.space().find(values);
}

const std::optional<Prospect>& TestPlan::prospect(const Parts& parts)
{
  if (parts.place >= prospects_.size())
    prospects_.resize(places_.size());
  auto& row = prospects_[parts.place];
  if (parts.hidden >= row.size())
    row.resize(hidden_values_.size());
  if (!row[parts.hidden].known)
  {
    const auto found = computed(parts);
    prospects_[parts.place][parts.hidden] = {true, found};
  }
  return prospects_[parts.place][parts.hidden].prospect;
}

std::optional<Prospect> TestPlan::computed(const Parts& parts)
{
  const auto begin = state(parts);
  const auto test = begin ? testFrom(*begin) : std::nullopt;
  if (!test || test->steps.empty())
    return std::nullopt;
  const StateId end = test->endFrom(*begin);
  const auto& rest = goalFrom(end);
  if (!rest)
    return std::nullopt;
  return Prospect{test->cost_s, rest->cost_s, detection(*test), this->parts(end).place};
}

TestPlan::Allowed TestPlan::actionsAbout(StateId state) const
{
  std::set<std::string> constants;
  for (std::size_t fluent = 0; fluent < task_.space().fluents().size(); ++fluent)
    constants.insert(task_.space().value(state, fluent));
  Allowed allowed = always_;
  for (const auto& constant : constants)
  {
    const auto found = about_.find(constant);
    if (found == about_.end())
      continue;
    for (const std::size_t action : found->second)
    {
      const auto& needed = needs_[action];
      if (std::all_of(needed.begin(), needed.end(),
                      [&](const std::string& name) { return constants.count(name) != 0; }))
        allowed.push_back(action);
    }
  }
  std::sort(allowed.begin(), allowed.end());
  return allowed;
}

bool TestPlan::tests(std::size_t action, StateId state) const
{
  const auto& laws = task_.space().observations(action);
  return std::any_of(laws.begin(), laws.end(), [&](const auto& law) {
    return !law.caused && isHidden(law.fluent) &&
           (!law.value || *law.value == task_.space().value(state, law.fluent));
  });
}

std::optional<RouteStep> TestPlan::likeliest(StateId state, std::size_t action)
{
  const auto& transition = task_.transition(state, action);
  if (!transition.executable)
    return std::nullopt;
  const refinement::DomainTask::Next* best = nullptr;
  for (const auto& outcome : transition.next)
  {
    if (outcome.state != state && (best == nullptr || outcome.probability > best->probability))
      best = &outcome;
  }
  if (best == nullptr)
    return std::nullopt;
  return RouteStep{action, best->state, transition.cost_s / best->probability};
}

std::optional<Route> TestPlan::route(StateId state, bool to_test)
{
  const Allowed some = actionsAbout(state);
  if (auto found = route(state, to_test, some))
    return found;
  Allowed all(task_.numActions());
  for (std::size_t action = 0; action < all.size(); ++action)
    all[action] = action;
  return some.size() == all.size() ? std::nullopt : route(state, to_test, all);
}

std::optional<Route> TestPlan::route(StateId state, bool to_test, const Allowed& actions)
{
  const Successors successors = [&](StateId from, const Visit& visit) {
    for (const std::size_t action : actions)
    {
      if (const auto step = likeliest(from, action))
        visit(*step);
    }
  };
  const RouteEnd at_goal = [&](StateId at) -> std::optional<RouteStep> {
    return task_.holds(goal_, at) ? std::optional(RouteStep{0, at, 0.0}) : std::nullopt;
  };
  const RouteEnd at_test = [&](StateId at) -> std::optional<RouteStep> {
    std::optional<RouteStep> best;
    for (const std::size_t action : actions)
    {
      if (!tests(action, at))
        continue;
      const auto& transition = task_.transition(at, action);
      if (transition.executable && (!best || transition.cost_s < best->cost_s))
        best = RouteStep{action, at, transition.cost_s};
    }
    return best;
  };
  return shortestRoute(state, successors, to_test ? at_test : at_goal, kMaxNodes);
}

const std::optional<Route>& TestPlan::goalFrom(StateId state)
{
  const auto found = goals_.find(state);
  return found != goals_.end() ? found->second
                               : goals_.emplace(state, route(state, false)).first->second;
}

double TestPlan::detection(const Route& test) const
{
  const RouteStep& last = test.steps.back();
  const auto& laws = task_.space().observations(last.action);
  double probability = 0.0;
  for (std::size_t law = 0; law < laws.size(); ++law)
  {
    const std::string& value = task_.space().value(last.next, laws[law].fluent);
    if (isHidden(laws[law].fluent) && !laws[law].caused &&
        (!laws[law].value || *laws[law].value == value))
      probability = std::max(probability, task_.likelihood(last.action, law, last.next, true,
                                                           laws[law].value ? "true" : value));
  }
  return probability;
}

std::optional<std::size_t> TestPlan::orienting(const DomainBelief& belief, StateId likeliest)
{
  std::vector<std::size_t> lost = openFluents(belief);
  lost.erase(std::remove_if(lost.begin(), lost.end(),
                            [this](std::size_t fluent) { return isHidden(fluent); }),
             lost.end());
  std::optional<std::size_t> best;
  double least_s = 0.0;
  for (const std::size_t action : lost.empty() ? Allowed{} : actionsAbout(likeliest))
  {
    const auto& laws = task_.space().observations(action);
    if (std::none_of(laws.begin(), laws.end(), [&](const auto& law) {
          return law.caused && std::find(lost.begin(), lost.end(), law.fluent) != lost.end();
        }))
      continue;
    double cost_s = 0.0;
    for (const auto& [state, probability] : belief.states())
      cost_s += probability * task_.transition(state, action).cost_s;
    if (!best || cost_s < least_s)
    {
      best = action;
      least_s = cost_s;
    }
  }
  return best;
}

}  // namespace kr3::executive
