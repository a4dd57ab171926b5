#include "kr3_executive/abstract_world.hpp"

#include <algorithm>
#include <cmath>
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

void AbstractWorld::reset(const FluentValues& coarse)
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
      // A fluent of a component is given by that of its whole.
      reasoner::Atom whole = atom;
      for (auto& argument : whole.arguments)
        argument.name = domain_.coarse(argument.name);
      const auto given = coarse.find(reasoner::toString(whole));
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

double AbstractWorld::durationOf(const LowLevelAction& action) const
{
  const auto& model = models_.actions.at(action.symbol);
  const auto& cost = model.cost;
  double distance_m = 0.0;
  if (cost.from && !cost.to.empty())
  {
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
    if (a && b)
      distance_m = domain_.map().distance(*a, *b);
  }
  return cost.base_s + cost.per_metre_s * distance_m;
}

std::string AbstractWorld::observe(const LowLevelAction& action, const std::string& fluent,
                                   const std::string& asked)
{
  const auto* declared = domain_.description().findFluent(takeApart(fluent).symbol);
  const auto& model = models_.actions.at(action.symbol).observations.at(declared->name);
  const auto held = state_.find(fluent);
  const std::string truth = held == state_.end() ? "false" : held->second;
  if (!asked.empty() || !declared->value_sort)
  {
    const bool is_so = truth == (asked.empty() ? "true" : asked);
    return chance(is_so ? model.true_positive : model.false_positive) ? "true" : "false";
  }
  if (chance(model.true_positive))
    return truth;
  std::vector<std::string> others;
  for (const auto& value : domain_.description().findSort(*declared->value_sort)->elements)
  {
    if (value != truth)
      others.push_back(value);
  }
  return others.empty() ? truth : others[anyOf(others.size())];
}

LowLevelResult AbstractWorld::execute(const LowLevelAction& action,
                                      const FluentLookup& /*believed*/,
                                      const std::atomic<bool>& /*cancel*/)
{
  reasoner::Atom atom{action.symbol, {}, {}};
  for (const auto& argument : action.arguments)
    atom.arguments.push_back({false, argument});
  LowLevelResult result;
  const auto& model = models_.actions.at(action.symbol);
  if (!laws_.executable(state_, atom))
  {
    result.outcome = "impossible";
    result.duration_s = model.cost.impossible_s;
  }
  else
  {
    result.duration_s = durationOf(action);
    const OutcomeChooser chooser{[&](const std::string&, const std::vector<std::string>& labels) {
      std::vector<double> weights;
      for (const auto& label : labels)
        weights.push_back(model.outcomes.probabilities.at(label));
      return std::discrete_distribution<std::size_t>(weights.begin(), weights.end())(random_);
                                 },
                                 [&](std::size_t count) { return anyOf(count); }};
    state_ = laws_.successor(state_, atom, chooser, &result.outcome);
  }
  for (const auto& observed : observedFluents(domain_.description(), action))
    result.observation.push_back(observe(action, observed.fluent, observed.value));
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
