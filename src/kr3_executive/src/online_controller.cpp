#include "online_controller.hpp"

#include <algorithm>
#include <utility>

#include <kr3_common/error.hpp>

namespace kr3::executive
{
namespace
{

using refinement::StateId;

constexpr std::size_t kMaxNodes = 3000;
constexpr double kCertain = 1.0 - 1e-9;

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

/// Fluents that have different values in the states of a belief.
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

}  // namespace

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
  addConstants(goal_, task.domain(), always_);
  for (const auto& action : task.space().actions())
  {
    for (const auto& argument : action.arguments)
    {
      if (!task.domain().map().find(argument))
        always_.insert(argument);
    }
  }
}

TestPlan::Allowed TestPlan::actionsAbout(StateId state) const
{
  std::set<std::string> constants = always_;
  for (std::size_t fluent = 0; fluent < task_.space().fluents().size(); ++fluent)
    constants.insert(task_.space().value(state, fluent));
  Allowed allowed;
  for (std::size_t action = 0; action < task_.numActions(); ++action)
  {
    const auto& arguments = task_.space().actions()[action].arguments;
    if (std::all_of(arguments.begin(), arguments.end(),
                    [&](const std::string& name) { return constants.count(name) != 0; }))
      allowed.push_back(action);
  }
  return allowed;
}

bool TestPlan::tests(std::size_t action, StateId state) const
{
  const auto& laws = task_.space().observations(action);
  return std::any_of(laws.begin(), laws.end(), [&](const auto& law) {
    return !law.caused && std::find(hidden_.begin(), hidden_.end(), law.fluent) != hidden_.end() &&
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

const std::optional<Route>& TestPlan::testFrom(StateId state)
{
  const auto found = tests_.find(state);
  return found != tests_.end() ? found->second
                               : tests_.emplace(state, route(state, true)).first->second;
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
    const bool about = std::find(hidden_.begin(), hidden_.end(), laws[law].fluent) != hidden_.end();
    const std::string& value = task_.space().value(last.next, laws[law].fluent);
    if (about && !laws[law].caused && (!laws[law].value || *laws[law].value == value))
      probability = std::max(probability, task_.likelihood(last.action, law, last.next, true,
                                                           laws[law].value ? "true" : value));
  }
  return probability;
}

std::optional<StateId> TestPlan::combined(StateId state, StateId hidden_from)
{
  const std::uint64_t key = (std::uint64_t{state} << 32U) | hidden_from;
  const auto [entry, is_new] = combined_.try_emplace(key);
  if (is_new)
  {
    std::vector<std::string> values;
    for (std::size_t fluent = 0; fluent < task_.space().fluents().size(); ++fluent)
    {
      const bool open = std::find(hidden_.begin(), hidden_.end(), fluent) != hidden_.end();
      values.push_back(task_.space().value(open ? hidden_from : state, fluent));
    }
    const auto found = task_.space().find(values);
    combined_[key] = found;
    return found;
  }
  return entry->second;
}

OnlineController::OnlineController(const DomainBelief& start, const reasoner::Formula& goal,
                                   double threshold, std::shared_ptr<BaselineCache> cache)
  : goal_(goal)
  , objective_(objectiveFor(start.task().domain(), start.task().models()))
  , threshold_(threshold)
  , num_actions_(start.task().numActions())
  , num_hypotheses_(start.states().size())
{
  auto& kept = cache->tests[keyOf(start.task(), reasoner::toString(goal), start.states())];
  if (!kept)
    kept = std::make_shared<TestPlan>(start.task(), goal, openFluents(start));
  plan_ = kept;
}

std::optional<std::size_t> TestPlan::orienting(const DomainBelief& belief, StateId likeliest)
{
  std::vector<std::size_t> lost = openFluents(belief);
  lost.erase(std::remove_if(
                 lost.begin(), lost.end(),
                 [this](std::size_t fluent) {
    return std::find(hidden_.begin(), hidden_.end(), fluent) != hidden_.end();
                 }),
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

std::optional<std::size_t> OnlineController::next(const DomainBelief& belief,
                                                  const std::atomic<bool>& cancel)
{
  if (cancel)
    throw Cancelled("planning was cancelled");
  const Hypotheses now = hypothesesOf(belief.states());
  const StateId likeliest = now.likeliestState();
  const auto toGoal = [&]() -> std::optional<std::size_t> {
    const auto& route = plan_->goalFrom(likeliest);
    return route && !route->steps.empty() ? std::optional(route->steps.front().action)
                                          : std::nullopt;
  };
  const double achieved = belief.probability(goal_);
  if (achieved > kCertain)
    return std::nullopt;
  const bool seems_done = belief.task().holds(goal_, likeliest);
  if (now.highest() > threshold_ && !seems_done)
    return toGoal();
  if (const auto action = plan_->orienting(belief, likeliest))
    return action;
  const ProspectOf prospect = [&](std::size_t from,
                                  std::size_t hypothesis) -> std::optional<Prospect> {
    const auto state = plan_->combined(static_cast<StateId>(from), now.states[hypothesis]);
    if (!state)
      return std::nullopt;
    const auto& test = plan_->testFrom(*state);
    if (!test)
      return std::nullopt;
    const StateId end = test->endFrom(*state);
    const auto& rest = plan_->goalFrom(end);
    if (!rest)
      return std::nullopt;
    return Prospect{test->cost_s, rest->cost_s, plan_->detection(*test), end};
  };
  const auto first = firstToTest(now.probability, likeliest, prospect, {});
  if (!first)
    return toGoal();
  // Searching on until the goal is certain, against ending now.
  if (endWorth(objective_, achieved) >= objective_.success - first->expected_s)
    return std::nullopt;
  const auto state = plan_->combined(likeliest, now.states[first->hypothesis]);
  return plan_->testFrom(*state)->steps.front().action;
}

std::string OnlineController::description() const
{
  return "planning online over the whole domain: " + std::to_string(num_hypotheses_) +
         " hypotheses, " + std::to_string(num_actions_) + " actions";
}

}  // namespace kr3::executive
