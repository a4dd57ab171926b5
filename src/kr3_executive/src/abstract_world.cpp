#include "kr3_executive/abstract_world.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>
#include <utility>

#include <kr3_common/error.hpp>

#include "kr3_executive/low_level_task.hpp"
#include "literal_text.hpp"

namespace kr3::executive
{
namespace
{

using reasoner::FluentKind;

constexpr int kMaxDraws = 1000;

/// All ground instances of the inertial fluents.
std::vector<reasoner::Atom> inertialFluents(const reasoner::Description& description)
{
  std::vector<reasoner::Atom> all;
  for (const auto& fluent : description.fluents)
  {
    if (fluent.kind != FluentKind::kInertial)
      continue;
    std::vector<reasoner::Atom> atoms{{fluent.name, {}, {}}};
    for (const auto& sort : fluent.argument_sorts)
    {
      std::vector<reasoner::Atom> longer;
      for (const auto& atom : atoms)
      {
        for (const auto& element : description.findSort(sort)->elements)
        {
          longer.push_back(atom);
          longer.back().arguments.push_back({false, element});
        }
      }
      atoms = std::move(longer);
    }
    all.insert(all.end(), atoms.begin(), atoms.end());
  }
  return all;
}

std::string drawn(const std::map<std::string, double>& probabilities, std::mt19937_64& random)
{
  std::vector<double> weights;
  for (const auto& [value, probability] : probabilities)
    weights.push_back(probability);
  std::discrete_distribution<std::ptrdiff_t> index(weights.begin(), weights.end());
  return std::next(probabilities.begin(), index(random))->first;
}

}  // namespace

AbstractWorld::AbstractWorld(const refinement::LowLevelDomain& domain,
                             const refinement::Models& models, std::uint64_t seed)
  : domain_(domain)
  , models_(models)
  , laws_(domain.description())
  , high_level_laws_(domain.highLevel())
  , random_(seed)
{
}

bool AbstractWorld::chance(double probability)
{
  return std::uniform_real_distribution<double>(0.0, 1.0)(random_) < probability;
}

std::size_t AbstractWorld::anyOf(std::size_t count)
{
  return std::uniform_int_distribution<std::size_t>(0, count - 1)(random_);
}

void AbstractWorld::reset(const FluentValues& coarse, const FluentValues& fine)
{
  const auto& description = domain_.description();
  const std::vector<reasoner::Atom> fluents = inertialFluents(description);
  for (int draw = 0; draw < kMaxDraws; ++draw)
  {
    FluentValues state;
    for (const auto& atom : fluents)
    {
      const std::string name = reasoner::toString(atom);
      const auto* declared = description.findFluent(atom.name);
      if (const auto fixed = fine.find(name); fixed != fine.end())
      {
        state[name] = fixed->second;
        continue;
      }
      // A fluent of a component is given by that of its whole.
      reasoner::Atom whole = atom;
      for (auto& argument : whole.arguments)
        argument.name = domain_.coarse(argument.name);
      const auto given = coarse.find(reasoner::toString(whole));
      if (const auto prior = models_.priors.find(atom.name);
          prior != models_.priors.end() && given == coarse.end())
      {
        state[name] = drawn(prior->second.probabilities, random_);
        continue;
      }
      if (!declared->value_sort)
      {
        state[name] = given == coarse.end() ? "false" : given->second;
        continue;
      }
      const std::vector<std::string> values =
          given == coarse.end() ? description.findSort(*declared->value_sort)->elements
                                : domain_.components(given->second);
      if (values.empty())
        throw InvalidArgument("no value is left for " + name);
      state[name] = values[anyOf(values.size())];
    }
    if (laws_.consistent(state))
    {
      state_ = std::move(state);
      now_s_ = 0.0;
      return;
    }
  }
  throw InvalidArgument("no state with the given values was found that satisfies the constraints");
}

std::optional<double> AbstractWorld::metres(const LowLevelAction& action) const
{
  const auto& model = models_.actions.at(action.symbol);
  const auto& cost = model.costOf(action.arguments);
  if (!cost.from || cost.to.empty())
    return std::nullopt;
  const auto argumentOf = [&](const std::string& name) {
    const auto at = std::find(model.parameters.begin(), model.parameters.end(), name);
    return at == model.parameters.end()
               ? name
               : action.arguments.at(static_cast<std::size_t>(at - model.parameters.begin()));
  };
  reasoner::Atom from = *cost.from;
  for (auto& term : from.arguments)
    term = {false, argumentOf(term.name)};
  const auto start = state_.find(reasoner::toString(from));
  const auto a = start == state_.end() ? std::nullopt : domain_.map().find(start->second);
  const auto b = domain_.map().find(argumentOf(cost.to));
  if (!a || !b)
    return std::nullopt;
  return domain_.map().distance(*a, *b);
}

double AbstractWorld::durationOf(const LowLevelAction& action) const
{
  const auto& cost = models_.actions.at(action.symbol).costOf(action.arguments);
  return cost.base_s + cost.per_metre_s * metres(action).value_or(0.0);
}

bool AbstractWorld::possible(const LowLevelAction& action) const
{
  reasoner::Atom atom{action.symbol, {}, {}};
  for (const auto& argument : action.arguments)
    atom.arguments.push_back({false, argument});
  return laws_.executable(state_, atom) && std::isfinite(durationOf(action));
}

bool AbstractWorld::affects(const LowLevelAction& action, const std::string& fluent) const
{
  for (const auto& law : domain_.description().causal_laws)
  {
    std::map<std::string, std::string> binding;
    bool fits = law.action.name == action.symbol;
    for (std::size_t i = 0; fits && i < action.arguments.size(); ++i)
    {
      const auto& term = law.action.arguments[i];
      fits = (term.is_variable ? binding.emplace(term.name, action.arguments[i]).first->second
                               : term.name) == action.arguments[i];
    }
    for (const auto& outcome : law.outcomes)
    {
      for (const auto& effect : outcome.effects)
      {
        reasoner::Atom changed = effect.fluent;
        for (auto& argument : changed.arguments)
        {
          const auto bound = binding.find(argument.name);
          if (argument.is_variable && bound != binding.end())
            argument = {false, bound->second};
        }
        if (fits && reasoner::toString(changed) == fluent)
          return true;
      }
    }
  }
  return false;
}

std::string AbstractWorld::senseNothing(const LowLevelAction& action, const std::string& fluent,
                                        const std::string& asked)
{
  const auto* declared = domain_.description().findFluent(takeApart(fluent).symbol);
  if (asked.empty() && declared->value_sort)
  {
    const auto& values = domain_.description().findSort(*declared->value_sort)->elements;
    return values[noise_ ? anyOf(values.size()) : 0];
  }
  const auto& model =
      models_.actions.at(action.symbol).observationOf(declared->name, action.arguments);
  const double yes = asked.empty() ? 0.5 : model.false_positive;
  return noise_ && chance(yes) ? "true" : "false";
}

std::string AbstractWorld::observe(const LowLevelAction& action, const std::string& fluent,
                                   const std::string& asked)
{
  const auto* declared = domain_.description().findFluent(takeApart(fluent).symbol);
  const auto& model =
      models_.actions.at(action.symbol).observationOf(declared->name, action.arguments);
  const auto held = state_.find(fluent);
  const std::string truth = held == state_.end() ? "false" : held->second;
  if (!asked.empty() || !declared->value_sort)
  {
    const bool is_so = truth == (asked.empty() ? "true" : asked);
    if (!noise_)
      return is_so ? "true" : "false";
    return chance(is_so ? model.true_positive : model.false_positive) ? "true" : "false";
  }
  if (!noise_ || chance(model.true_positive))
    return truth;
  std::vector<std::string> others;
  for (const auto& value : domain_.description().findSort(*declared->value_sort)->elements)
  {
    if (value != truth)
      others.push_back(value);
  }
  return others.empty() ? truth : others[anyOf(others.size())];
}

std::size_t AbstractWorld::chooseOutcome(const LowLevelAction& action,
                                         const std::vector<std::string>& labels,
                                         const Disturbance& disturbance)
{
  if (disturbance.outcome)
  {
    const auto forced = std::find(labels.begin(), labels.end(), *disturbance.outcome);
    if (forced == labels.end())
    {
      throw InvalidArgument("outcome '" + *disturbance.outcome + "' of " + action.text +
                            ", possible now: " + listed(labels));
    }
    return static_cast<std::size_t>(forced - labels.begin());
  }
  const auto& probabilities =
      models_.actions.at(action.symbol).outcomesOf(action.arguments).probabilities;
  std::vector<double> weights;
  for (const auto& label : labels)
    weights.push_back(probabilities.at(label));
  if (!noise_)
  {
    return static_cast<std::size_t>(std::max_element(weights.begin(), weights.end()) -
                                    weights.begin());
  }
  return std::discrete_distribution<std::size_t>(weights.begin(), weights.end())(random_);
}

LowLevelResult AbstractWorld::execute(const LowLevelAction& action,
                                      const FluentLookup& /*believed*/,
                                      const std::atomic<bool>& /*cancel*/)
{
  return execute(action, Disturbance{});
}

LowLevelResult AbstractWorld::execute(const LowLevelAction& action, const Disturbance& disturbance)
{
  reasoner::Atom atom{action.symbol, {}, {}};
  for (const auto& argument : action.arguments)
    atom.arguments.push_back({false, argument});
  LowLevelResult result;
  const auto& cost = models_.actions.at(action.symbol).costOf(action.arguments);
  const bool is_possible = possible(action);
  if (!is_possible)
  {
    result.outcome = "impossible";
    result.duration_s = cost.impossible_s;
  }
  else if (disturbance.blocked)
  {
    result.outcome = disturbance.outcome.value_or("blocked");
    result.duration_s = cost.impossible_s;
  }
  else
  {
    result.duration_s = durationOf(action);
    const OutcomeChooser chooser{[&](const std::string&, const std::vector<std::string>& labels) {
      return chooseOutcome(action, labels, disturbance);
                                 },
                                 [&](std::size_t count) { return anyOf(count); }};
    state_ = laws_.successor(state_, atom, chooser, &result.outcome);
    if (disturbance.outcome && result.outcome != *disturbance.outcome)
      throw InvalidArgument("outcome '" + *disturbance.outcome + "' of " + action.text +
                            " is not possible now");
  }
  if (!disturbance.becomes.empty())
    impose(disturbance.becomes);
  const auto laws = observedFluents(domain_.description(), action);
  if (!disturbance.observation.empty() && disturbance.observation.size() != laws.size())
  {
    throw InvalidArgument(std::to_string(disturbance.observation.size()) + " observations of " +
                          action.text + ", expected " + std::to_string(laws.size()));
  }
  for (std::size_t i = 0; i < laws.size(); ++i)
  {
    const auto& [fluent, asked] = laws[i];
    if (!disturbance.observation.empty())
      result.observation.push_back(disturbance.observation[i]);
    else if (is_possible || affects(action, fluent))
      result.observation.push_back(observe(action, fluent, asked));
    else
      result.observation.push_back(senseNothing(action, fluent, asked));
  }
  now_s_ += result.duration_s;
  return result;
}

FluentValues AbstractWorld::coarse() const
{
  FluentValues values;
  for (const auto& [fluent, value] : state_)
  {
    // A boolean fluent of a whole is true when that of a part is.
    auto& whole = values[coarseFluent(domain_, fluent)];
    if (whole != "true")
      whole = domain_.coarse(value);
  }
  return values;
}

bool AbstractWorld::holds(const reasoner::Formula& goal) const
{
  return high_level_laws_.holds(coarse(), goal);
}

}  // namespace kr3::executive
