#include "kr3_refinement/domain_task.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <kr3_common/error.hpp>

#include "prior.hpp"
#include "state_view.hpp"

namespace kr3::refinement
{
namespace
{

const std::string kTrue = "true";
const std::string kFalse = "false";
const std::string kNone = "none";

/// Transitions that are kept, of about 200 bytes each; with more all are computed anew.
constexpr std::size_t kMaxTransitions = 1500000;

/// Substitutes an action's arguments for the names that the models file gives its parameters.
std::string argumentOf(const ActionModel& model, const StateSpace::Action& action,
                       const std::string& name)
{
  const auto at = std::find(model.parameters.begin(), model.parameters.end(), name);
  return at == model.parameters.end()
             ? name
             : action.arguments[static_cast<std::size_t>(at - model.parameters.begin())];
}

}  // namespace

/// Ways in which some fluents can turn out together, each as likely as it says.
struct DomainTask::Group
{
  struct Way
  {
    std::vector<std::pair<std::size_t, std::string>> values;
    double probability;
  };
  std::vector<Way> ways;
};

DomainTask::DomainTask(const LowLevelDomain& domain, const Models& models,
                       const std::set<std::string>& constants)
  : domain_(&domain)
  , models_(&models)
  , constants_(constants)
  , space_(domain.description(), constants)
{
  for (std::size_t i = 0; i < space_.fluents().size(); ++i)
  {
    const reasoner::GroundFluent& fluent = space_.fluents()[i];
    reasoner::Atom whole{fluent.symbol, {}, {}};
    for (const std::string& argument : fluent.arguments)
    {
      whole.arguments.push_back({false, domain.coarse(argument)});
    }
    coarse_fluents_[reasoner::toString(whole)].push_back(i);
    boolean_.push_back(fluent.values == std::vector<std::string>{kFalse, kTrue});
  }
  for (const StateSpace::Action& action : space_.actions())
  {
    const ActionModel& model = models.actions.at(action.symbol);
    action_models_.push_back(&model);
    start_fluents_.emplace_back();
    ends_.emplace_back();
    const CostModel& cost = model.costOf(action.arguments);
    outcomes_.push_back(&model.outcomesOf(action.arguments));
    costs_.push_back(&cost);
    if (cost.from)
    {
      reasoner::Atom from = *cost.from;
      for (reasoner::Term& term : from.arguments)
      {
        term = {false, argumentOf(model, action, term.name)};
      }
      start_fluents_.back() = space_.findFluent(reasoner::toString(from));
      ends_.back() = domain.map().find(argumentOf(model, action, cost.to));
    }
  }
}

std::optional<double> DomainTask::distance(StateId state, std::size_t action) const
{
  if (!start_fluents_[action] || !ends_[action])
  {
    return 0.0;
  }
  const auto start = domain_->map().find(space_.value(state, *start_fluents_[action]));
  const double distance_m = start ? domain_->map().distance(*start, *ends_[action]) : 0.0;
  return std::isfinite(distance_m) ? std::optional(distance_m) : std::nullopt;
}

const DomainTask::Transition& DomainTask::transition(StateId state, std::size_t action)
{
  const std::uint64_t key = std::uint64_t{state} * numActions() + action;
  if (transitions_.size() >= kMaxTransitions && transitions_.count(key) == 0)
  {
    transitions_.clear();
  }
  const auto [entry, is_new] = transitions_.try_emplace(key);
  Transition& transition = entry->second;
  if (!is_new)
  {
    return transition;
  }
  const CostModel& cost = *costs_.at(action);
  transition.cost_s = cost.impossible_s;
  const std::optional<double> distance_m = distance(state, action);
  std::map<StateId, double> next;
  double total = 0.0;
  if (distance_m && space_.executable(state, action))
  {
    for (const StateSpace::Outcome& outcome : space_.results(state, action))
    {
      const double probability =
          outcome.share *
          (outcome.label.empty() ? 1.0 : outcomes_[action]->probabilities.at(outcome.label));
      next[outcome.state.value_or(state)] += probability;
      total += probability;
    }
  }
  if (!(total > 0.0))
  {
    transition.next = {{state, 1.0}};
    return transition;
  }
  transition.executable = true;
  transition.cost_s = cost.base_s + cost.per_metre_s * *distance_m;
  for (const auto& [target, probability] : next)
  {
    if (probability > 0.0)
    {
      transition.next.push_back({target, probability / total});
    }
  }
  return transition;
}

double DomainTask::likelihood(std::size_t action, std::size_t law, StateId next, bool executed,
                              const std::string& value) const
{
  const StateSpace::Observation& observed = space_.observations(action).at(law);
  const reasoner::GroundFluent& fluent = space_.fluents()[observed.fluent];
  const ObservationModel& model =
      action_models_[action]->observationOf(fluent.symbol, space_.actions()[action].arguments);
  const std::string& held = space_.value(next, observed.fluent);
  const bool informative = executed || observed.caused;
  if (observed.value || boolean_[observed.fluent])
  {
    if (!informative && !observed.value)
    {
      return 0.5;
    }
    const bool is_so = informative && held == observed.value.value_or(kTrue);
    const double yes = is_so ? model.true_positive : model.false_positive;
    return value == kTrue ? yes : (value == kFalse ? 1.0 - yes : 0.0);
  }
  const auto& values = fluent.values;
  if (std::find(values.begin(), values.end(), value) == values.end())
  {
    return 0.0;
  }
  const auto count = static_cast<double>(values.size());
  if (!informative)
  {
    return 1.0 / count;
  }
  const double right = count < 2.0 ? 1.0 : model.true_positive;
  return value == held ? right : (1.0 - right) / (count - 1.0);
}

std::vector<std::pair<std::string, double>> DomainTask::told(std::size_t action, StateId next,
                                                             bool executed) const
{
  std::vector<std::pair<std::string, double>> result{{"", 1.0}};
  const auto& laws = space_.observations(action);
  for (std::size_t law = 0; law < laws.size(); ++law)
  {
    const bool truth = laws[law].value || boolean_[laws[law].fluent];
    const std::vector<std::string> values =
        truth ? std::vector<std::string>{kFalse, kTrue} : space_.fluents()[laws[law].fluent].values;
    std::vector<std::pair<std::string, double>> longer;
    for (const auto& [name, probability] : result)
    {
      for (const std::string& value : values)
      {
        const double both = probability * likelihood(action, law, next, executed, value);
        if (both > 0.0)
        {
          longer.emplace_back(name.empty() ? value : name + "," + value, both);
        }
      }
    }
    result = std::move(longer);
  }
  return laws.empty() ? std::vector<std::pair<std::string, double>>{{kNone, 1.0}} : result;
}

std::string DomainTask::coarseValue(StateId state, const std::string& fluent) const
{
  const auto fine = coarse_fluents_.find(normalised(fluent));
  if (fine == coarse_fluents_.end())
  {
    throw NotFound("the task has no fluent '" + fluent + "'");
  }
  std::vector<std::string> values;
  for (const std::size_t index : fine->second)
  {
    values.push_back(domain_->coarse(space_.value(state, index)));
  }
  return refinement::coarseValue(values, boolean_[fine->second.front()]);
}

bool DomainTask::holds(const reasoner::Formula& goal, StateId state) const
{
  using Kind = reasoner::Formula::Kind;
  const auto one = [&](const reasoner::Formula& operand) { return holds(operand, state); };
  switch (goal.kind)
  {
    case Kind::kNot:
      return !holds(goal.operands.at(0), state);
    case Kind::kAnd:
      return std::all_of(goal.operands.begin(), goal.operands.end(), one);
    case Kind::kOr:
      return std::any_of(goal.operands.begin(), goal.operands.end(), one);
    case Kind::kLiteral:
      break;
  }
  const reasoner::Literal& literal = goal.literal;
  return (coarseValue(state, reasoner::toString(literal.atom)) == literal.value.name) ==
         literal.equal;
}

std::vector<DomainTask::Group> DomainTask::groupsOf(const InitialKnowledge& knowledge) const
{
  std::vector<Group> groups;
  const std::map<std::string, Distribution> priors =
      priorsOf(*domain_, *models_, constants_, knowledge);
  for (const auto& [name, fine] : coarse_fluents_)
  {
    std::vector<std::size_t> open;
    for (const std::size_t fluent : fine)
    {
      const auto known = knowledge.fine.find(space_.fluents()[fluent].name);
      const auto prior = priors.find(space_.fluents()[fluent].name);
      if (known == knowledge.fine.end() && prior == priors.end())
      {
        open.push_back(fluent);
        continue;
      }
      Group group;
      for (const auto& [value, probability] :
           known == knowledge.fine.end() ? prior->second : known->second)
      {
        if (probability > 0.0)
        {
          group.ways.push_back({{{fluent, value}}, probability});
        }
      }
      groups.push_back(std::move(group));
    }
    if (open.empty())
    {
      continue;
    }
    // Every way in which the fine fluents can turn out, by the coarse value that it amounts to.
    std::map<std::string, std::vector<Group::Way>> by_value;
    std::vector<std::size_t> choice(open.size(), 0);
    const auto known = knowledge.coarse.find(name);
    const bool boolean = boolean_[open.front()];
    if (known == knowledge.coarse.end() && boolean)
    {
      Group::Way all_false{{}, 1.0};
      for (const std::size_t fluent : open)
      {
        all_false.values.emplace_back(fluent, kFalse);
      }
      groups.push_back({{std::move(all_false)}});
      continue;
    }
    for (bool more = true; more;)
    {
      Group::Way way{{}, 1.0};
      std::vector<std::string> coarse;
      for (std::size_t i = 0; i < open.size(); ++i)
      {
        const std::string& value = space_.fluents()[open[i]].values[choice[i]];
        way.values.emplace_back(open[i], value);
        coarse.push_back(domain_->coarse(value));
      }
      by_value[refinement::coarseValue(coarse, boolean)].push_back(std::move(way));
      std::size_t digit = 0;
      while (digit < open.size() && ++choice[digit] == space_.fluents()[open[digit]].values.size())
      {
        choice[digit++] = 0;
      }
      more = digit < open.size();
    }
    Group group;
    for (auto& [value, ways] : by_value)
    {
      double probability = 1.0;
      if (known != knowledge.coarse.end())
      {
        const auto given = known->second.find(value);
        probability = given == known->second.end() ? 0.0 : given->second;
      }
      for (Group::Way& way : ways)
      {
        way.probability = probability / static_cast<double>(ways.size());
        if (probability > 0.0)
        {
          group.ways.push_back(std::move(way));
        }
      }
    }
    groups.push_back(std::move(group));
  }
  return groups;
}

SparseBelief DomainTask::initialBelief(const InitialKnowledge& knowledge, std::size_t max_states)
{
  const std::vector<Group> groups = groupsOf(knowledge);
  double count = 1.0;
  for (const Group& group : groups)
  {
    count *= static_cast<double>(group.ways.size());
  }
  if (count > static_cast<double>(max_states))
  {
    throw ResourceExhausted("an initial belief over " + std::to_string(count) +
                            " states, at most " + std::to_string(max_states) + " are allowed");
  }
  SparseBelief belief;
  double total = 0.0;
  std::vector<std::string> values(space_.fluents().size());
  std::vector<std::size_t> choice(groups.size(), 0);
  for (bool more = count > 0.0; more;)
  {
    double probability = 1.0;
    for (std::size_t i = 0; i < groups.size(); ++i)
    {
      const Group::Way& way = groups[i].ways[choice[i]];
      probability *= way.probability;
      for (const auto& [fluent, value] : way.values)
      {
        values[fluent] = value;
      }
    }
    if (const auto state = space_.find(values))
    {
      belief[*state] += probability;
      total += probability;
    }
    std::size_t digit = 0;
    while (digit < groups.size() && ++choice[digit] == groups[digit].ways.size())
    {
      choice[digit++] = 0;
    }
    more = digit < groups.size();
  }
  if (!(total > 0.0))
  {
    throw FailedPrecondition("no low-level state fits the initial knowledge");
  }
  for (auto& [state, probability] : belief)
  {
    probability /= total;
  }
  return belief;
}

Distribution DomainTask::fineMarginal(const SparseBelief& belief, std::size_t fluent) const
{
  Distribution result;
  for (const auto& [state, probability] : belief)
  {
    result[space_.value(state, fluent)] += probability;
  }
  return result;
}

}  // namespace kr3::refinement
