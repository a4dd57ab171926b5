#include "coarse_plan.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include <kr3_common/error.hpp>
#include <kr3_refinement/zoom.hpp>

#include "literal_text.hpp"

namespace kr3::executive
{
namespace
{

using refinement::StateId;

constexpr std::size_t kMaxNodes = 3000;
constexpr double kFirstWorth_s = 30.0;
constexpr int kRounds = 3;
/// A room is only a part of the search, so its own discount must not end it.
constexpr double kLessImpatient = 0.1;

std::set<std::string> coarseConstants(const refinement::DomainTask& task)
{
  std::set<std::string> constants;
  const auto add = [&](const std::vector<std::string>& names) {
    for (const auto& name : names)
      constants.insert(task.domain().coarse(name));
  };
  for (const auto& fluent : task.space().fluents())
  {
    add(fluent.arguments);
    add(fluent.values);
  }
  for (const auto& action : task.space().actions())
    add(action.arguments);
  return constants;
}

std::uint64_t pairOf(StateId first, std::size_t second)
{
  return (std::uint64_t{first} << 32U) | second;
}

}  // namespace

CoarsePlan::CoarsePlan(const DomainBelief& start, reasoner::Formula goal, PolicyServer& policies,
                       const SolveBudget& budget, double threshold, std::size_t samples)
  : domain_(start.task().domain())
  , models_(start.task().models())
  , space_(domain_.highLevel(), coarseConstants(start.task()))
  , goal_(std::move(goal))
  , policies_(policies)
  , budget_(budget)
  , threshold_(threshold)
  , samples_(samples)
{
  addConstants(goal_);
  for (const auto& action : space_.actions())
  {
    for (const auto& argument : action.arguments)
    {
      if (!domain_.isMagnified(argument))
        always_.insert(argument);
    }
  }
  for (const auto& entry : coarse(start))
    start_.push_back(entry.first);
  if (start_.empty())
    throw FailedPrecondition("the belief agrees with no state of the high level");
  for (std::size_t fluent = 0; fluent < space_.fluents().size(); ++fluent)
  {
    if (std::any_of(start_.begin(), start_.end(), [&](StateId state) {
          return space_.value(state, fluent) != space_.value(start_.front(), fluent);
        }))
      hidden_.push_back(fluent);
  }
}

void CoarsePlan::addConstants(const reasoner::Formula& formula)
{
  for (const auto& operand : formula.operands)
    addConstants(operand);
  if (formula.kind != reasoner::Formula::Kind::kLiteral)
    return;
  for (const auto& argument : formula.literal.atom.arguments)
    always_.insert(argument.name);
  always_.insert(formula.literal.value.name);
}

std::map<StateId, double> CoarsePlan::coarse(const DomainBelief& belief)
{
  std::map<StateId, double> result;
  for (const auto& [state, probability] : belief.states())
  {
    const auto [entry, is_new] = coarse_of_.try_emplace(state);
    if (is_new)
    {
      std::vector<std::string> values;
      bool agree = true;
      for (const auto& fluent : space_.fluents())
      {
        values.push_back(belief.task().coarseValue(state, fluent.name));
        agree = agree && std::find(fluent.values.begin(), fluent.values.end(), values.back()) !=
                             fluent.values.end();
      }
      entry->second = agree ? space_.find(values) : std::nullopt;
    }
    if (entry->second)
      result[*entry->second] += probability;
  }
  return result;
}

std::optional<StateId> CoarsePlan::combined(StateId state, StateId hidden_from)
{
  const auto [entry, is_new] = combined_.try_emplace(pairOf(state, hidden_from));
  if (is_new)
  {
    std::vector<std::string> values;
    for (std::size_t fluent = 0; fluent < space_.fluents().size(); ++fluent)
    {
      const bool open = std::find(hidden_.begin(), hidden_.end(), fluent) != hidden_.end();
      values.push_back(space_.value(open ? hidden_from : state, fluent));
    }
    entry->second = space_.find(values);
  }
  return entry->second;
}

bool CoarsePlan::dependsOnHidden(StateId state, std::size_t action)
{
  return std::any_of(start_.begin(), start_.end(), [&](StateId other) {
    const auto supposed = combined(state, other);
    return supposed && !space_.executable(*supposed, action);
  });
}

std::vector<reasoner::Literal> CoarsePlan::literals(StateId state) const
{
  std::vector<reasoner::Literal> result;
  for (std::size_t i = 0; i < space_.fluents().size(); ++i)
  {
    const auto& fluent = space_.fluents()[i];
    reasoner::Literal literal;
    literal.atom.name = fluent.symbol;
    for (const auto& argument : fluent.arguments)
      literal.atom.arguments.push_back({false, argument});
    literal.value = {false, space_.value(state, i)};
    result.push_back(std::move(literal));
  }
  return result;
}

refinement::PomdpTask CoarsePlan::task(StateId state, std::size_t action,
                                       const refinement::InitialKnowledge& knowledge,
                                       const std::optional<LowerObjective>& objective) const
{
  const auto zoom =
      refinement::zoom(domain_, literals(state),
                       reasoner::parseGroundAction(actionText(action), domain_.highLevel()));
  if (!objective)
    return refinement::generatePomdp(domain_, models_, zoom, knowledge);
  refinement::Models models = models_;
  models.rewards = {objective->success, 0.0, 0.0};
  models.discount = objective->discount;
  return refinement::generatePomdp(domain_, models, zoom, knowledge);
}

LowerObjective CoarsePlan::worthSeconds(double found_s) const
{
  return {found_s, 1.0 - (1.0 - models_.discount) * kLessImpatient};
}

const OptionModel& CoarsePlan::option(StateId state, std::size_t action)
{
  const auto [entry, is_new] = options_.try_emplace(pairOf(state, action));
  OptionModel& model = entry->second;
  if (is_new)
  {
    model.success = model.failure = {meanCost(state, action), 1.0};
    model.on_hidden = dependsOnHidden(state, action);
    if (model.on_hidden)
    {
      // What finding it is worth if all hypotheses are equally likely and take as long, which
      // depends on how long that is.
      const auto hypotheses = static_cast<double>(std::max<std::size_t>(start_.size(), 2));
      double worth_s = kFirstWorth_s;
      for (int round = 0; round < kRounds; ++round)
      {
        simulate(state, action, 1.0 / hypotheses, worthSeconds(worth_s), model);
        worth_s = hypotheses * model.failure.seconds / model.detection;
      }
    }
  }
  return model;
}

std::optional<StateId> CoarsePlan::supposedFor(StateId state, std::size_t action)
{
  if (space_.executable(state, action))
    return state;
  for (const StateId other : start_)
  {
    const auto supposed = combined(state, other);
    if (supposed && space_.executable(*supposed, action))
      return supposed;
  }
  return std::nullopt;
}

std::optional<StateId> CoarsePlan::resultOf(StateId state, std::size_t action)
{
  const auto step = stepOf(state, action);
  return step ? std::optional(step->next) : std::nullopt;
}

refinement::InitialKnowledge CoarsePlan::knowledgeAt(StateId state, double probability) const
{
  refinement::InitialKnowledge knowledge;
  for (const std::size_t fluent : hidden_)
  {
    const std::string& value = space_.value(state, fluent);
    auto& distribution = knowledge.coarse[space_.fluents()[fluent].name];
    distribution[value] = probability;
    if (value == "true" || value == "false")
      distribution[value == "true" ? "false" : "true"] = 1.0 - probability;
  }
  return knowledge;
}

void CoarsePlan::simulate(StateId state, std::size_t action, double probability,
                          const std::optional<LowerObjective>& objective, OptionModel& model)
{
  const refinement::InitialKnowledge knowledge = knowledgeAt(state, probability);
  const LowLevelTask begun(
      domain_,
      std::make_shared<const refinement::PomdpTask>(task(state, action, knowledge, objective)),
      knowledge);
  const std::atomic<bool> never{false};
  const std::string policy = policies_.solve(begun.pomdp().model(), budget_, never).id;
  model = simulatedOption(begun, policies_, policy,
                          {threshold_, samples_, state * 1000003ULL + action}, model);
}

bool CoarsePlan::holds(const reasoner::Formula& formula, StateId state) const
{
  using Kind = reasoner::Formula::Kind;
  const auto one = [&](const reasoner::Formula& operand) { return holds(operand, state); };
  switch (formula.kind)
  {
    case Kind::kNot:
      return !holds(formula.operands.at(0), state);
    case Kind::kAnd:
      return std::all_of(formula.operands.begin(), formula.operands.end(), one);
    case Kind::kOr:
      return std::any_of(formula.operands.begin(), formula.operands.end(), one);
    case Kind::kLiteral:
      break;
  }
  const auto fluent = space_.findFluent(reasoner::toString(formula.literal.atom));
  const std::string value = fluent ? space_.value(state, *fluent) : std::string();
  return (value == formula.literal.value.name) == formula.literal.equal;
}

std::vector<std::size_t> CoarsePlan::actionsAbout(StateId state) const
{
  std::set<std::string> constants = always_;
  for (std::size_t fluent = 0; fluent < space_.fluents().size(); ++fluent)
    constants.insert(space_.value(state, fluent));
  std::vector<std::size_t> result;
  for (std::size_t action = 0; action < space_.actions().size(); ++action)
  {
    const auto& arguments = space_.actions()[action].arguments;
    if (std::all_of(arguments.begin(), arguments.end(),
                    [&](const std::string& name) { return constants.count(name) != 0; }))
      result.push_back(action);
  }
  return result;
}

std::optional<RouteStep> CoarsePlan::stepOf(StateId state, std::size_t action)
{
  if (!space_.executable(state, action))
    return std::nullopt;
  const auto results = space_.results(state, action);
  if (results.empty() || !results.front().state || *results.front().state == state)
    return std::nullopt;
  return RouteStep{action, *results.front().state, meanCost(state, action)};
}

std::optional<Route> CoarsePlan::route(StateId state, bool to_test)
{
  const auto with = [&](const std::vector<std::size_t>& actions) {
    const Successors successors = [&](StateId from, const Visit& visit) {
      for (const std::size_t action : actions)
      {
        const auto step = stepOf(from, action);
        if (step && !(to_test && dependsOnHidden(from, action)))
          visit(*step);
      }
    };
    const RouteEnd at_goal = [&](StateId at) -> std::optional<RouteStep> {
      return holds(goal_, at) ? std::optional(RouteStep{0, at, 0.0}) : std::nullopt;
    };
    const RouteEnd at_test = [&](StateId at) -> std::optional<RouteStep> {
      for (const std::size_t action : actions)
      {
        const auto step = stepOf(at, action);
        if (step && dependsOnHidden(at, action))
          return step;
      }
      return std::nullopt;
    };
    return shortestRoute(state, successors, to_test ? at_test : at_goal, kMaxNodes);
  };
  const std::vector<std::size_t> some = actionsAbout(state);
  if (auto found = with(some))
    return found;
  std::vector<std::size_t> all(space_.actions().size());
  for (std::size_t action = 0; action < all.size(); ++action)
    all[action] = action;
  return some.size() == all.size() ? std::nullopt : with(all);
}

const std::optional<Route>& CoarsePlan::goalFrom(StateId state)
{
  const auto found = goals_.find(state);
  return found != goals_.end() ? found->second
                               : goals_.emplace(state, route(state, false)).first->second;
}

const std::optional<Route>& CoarsePlan::testFrom(StateId state)
{
  if (const auto found = tests_.find(state); found != tests_.end())
    return found->second;
  std::optional<Route> test;
  if (const auto& goal = goalFrom(state))
  {
    StateId at = state;
    Route prefix;
    for (const RouteStep& step : goal->steps)
    {
      prefix.steps.push_back(step);
      prefix.cost_s += step.cost_s;
      if (dependsOnHidden(at, step.action))
      {
        test = prefix;
        break;
      }
      at = step.next;
    }
  }
  if (!test)
    test = route(state, true);
  return tests_.emplace(state, std::move(test)).first->second;
}

}  // namespace kr3::executive
