// What actions of the high level cost.

#include <algorithm>
#include <limits>
#include <utility>

#include "coarse_plan.hpp"

namespace kr3::executive
{

using refinement::StateId;

ActionCost CoarsePlan::actionCost(StateId state, std::size_t action) const
{
  const auto& ground = space_.actions()[action];
  const auto& model = models_.actions.at(ground.symbol);
  const auto argumentOf = [&](const std::string& name) {
    const auto at = std::find(model.parameters.begin(), model.parameters.end(), name);
    return at == model.parameters.end()
               ? name
               : ground.arguments[static_cast<std::size_t>(at - model.parameters.begin())];
  };
  const auto& cost = model.costOf(ground.arguments);
  ActionCost result{cost.base_s, cost.per_metre_s, {}, {}, {}};
  if (!cost.from || cost.to.empty())
    return result;
  reasoner::Atom from = *cost.from;
  for (auto& term : from.arguments)
    term = {false, argumentOf(term.name)};
  const std::string name = reasoner::toString(from);
  const auto fluent = space_.findFluent(name);
  if (!fluent)
    return result;
  result.fluent = name;
  const auto onMap = [this](const std::string& whole) {
    std::vector<std::string> components = domain_.components(whole);
    components.erase(
        std::remove_if(
            components.begin(), components.end(),
            [this](const std::string& component) { return !domain_.map().find(component); }),
        components.end());
    return components;
  };
  result.from = onMap(space_.value(state, *fluent));
  result.to = onMap(argumentOf(cost.to));
  return result;
}

double CoarsePlan::distanceOf(const std::string& from, const std::string& to) const
{
  return domain_.map().distance(*domain_.map().find(from), *domain_.map().find(to));
}

double CoarsePlan::meanCost(StateId state, std::size_t action) const
{
  const ActionCost cost = actionCost(state, action);
  double total_m = 0.0;
  for (const auto& from : cost.from)
  {
    for (const auto& to : cost.to)
      total_m += distanceOf(from, to);
  }
  const std::size_t pairs = cost.from.size() * cost.to.size();
  return cost.base_s + (pairs == 0 ? 0.0 : cost.per_metre_s * total_m / static_cast<double>(pairs));
}

double CoarsePlan::costFrom(StateId state, std::size_t action,
                            const std::function<std::string(const std::string&)>& where) const
{
  const ActionCost cost = actionCost(state, action);
  if (cost.from.empty() || cost.to.empty())
    return cost.base_s;
  const auto nearest_m = [&](const std::string& from) {
    double least_m = std::numeric_limits<double>::infinity();
    for (const auto& to : cost.to)
      least_m = std::min(least_m, distanceOf(from, to));
    return least_m;
  };
  const std::string known = where(cost.fluent);
  if (std::find(cost.from.begin(), cost.from.end(), known) != cost.from.end())
    return cost.base_s + cost.per_metre_s * nearest_m(known);
  double total_m = 0.0;
  for (const auto& from : cost.from)
    total_m += nearest_m(from);
  return cost.base_s + cost.per_metre_s * total_m / static_cast<double>(cost.from.size());
}

std::pair<double, double> CoarsePlan::costRange(StateId state, std::size_t action) const
{
  const ActionCost cost = actionCost(state, action);
  const auto nowhere = [](const std::string&) { return std::string(); };
  std::pair<double, double> range{costFrom(state, action, nowhere), 0.0};
  range.second = range.first;
  for (const auto& from : cost.from)
  {
    const double there = costFrom(state, action, [&](const std::string&) { return from; });
    range = {std::min(range.first, there), std::max(range.second, there)};
  }
  return range;
}

}  // namespace kr3::executive
