#include "kr3_executive/domain_belief.hpp"

#include <algorithm>
#include <cstdio>
#include <optional>
#include <utility>

#include <kr3_common/error.hpp>

#include "kr3_executive/low_level_task.hpp"
#include "literal_text.hpp"

namespace kr3::executive
{
namespace
{

using refinement::SparseBelief;
using refinement::StateId;

constexpr double kMostCertain = 0.999;
constexpr double kNegligible = 1e-14;

/// A law that the executive knows with the number that it has in the task.
struct ToldValue
{
  std::size_t law;
  std::string value;
};

std::vector<ToldValue> matched(const refinement::DomainTask& task, const LowLevelAction& action,
                               std::size_t index, const std::vector<std::string>& observation)
{
  const auto laws = observedFluents(task.domain().description(), action);
  if (laws.size() != observation.size())
  {
    throw InvalidArgument(action.text + " gave " + std::to_string(observation.size()) +
                          " observations, expected " + std::to_string(laws.size()));
  }
  std::vector<ToldValue> told;
  const auto& known = task.space().observations(index);
  for (std::size_t i = 0; i < laws.size(); ++i)
  {
    for (std::size_t law = 0; law < known.size(); ++law)
    {
      if (task.space().fluents()[known[law].fluent].name == laws[i].fluent &&
          known[law].value.value_or("") == laws[i].value)
        told.push_back({law, observation[i]});
    }
  }
  return told;
}

}  // namespace

DomainBelief::DomainBelief(std::shared_ptr<refinement::DomainTask> task, SparseBelief states)
  : task_(std::move(task)), states_(std::move(states))
{
  if (!replace(states_))
    throw InvalidArgument("a belief without mass");
}

bool DomainBelief::replace(SparseBelief states)
{
  double total = 0.0;
  for (const auto& entry : states)
    total += entry.second;
  if (!(total > 0.0))
    return false;
  for (auto entry = states.begin(); entry != states.end();)
  {
    entry->second /= total;
    entry = entry->second < kNegligible ? states.erase(entry) : std::next(entry);
  }
  states_ = std::move(states);
  return true;
}

LowLevelAction DomainBelief::action(std::size_t index) const
{
  const auto& ground = task_->space().actions().at(index);
  return {ground.text, ground.symbol, ground.arguments};
}

bool DomainBelief::update(std::size_t action, const std::vector<std::string>& observation)
{
  const std::vector<ToldValue> told = matched(*task_, this->action(action), action, observation);
  SparseBelief next;
  SparseBelief predicted;
  for (const auto& [state, probability] : states_)
  {
    const auto& transition = task_->transition(state, action);
    for (const auto& outcome : transition.next)
    {
      double weight = probability * outcome.probability;
      predicted[outcome.state] += weight;
      for (const auto& [law, value] : told)
        weight *= task_->likelihood(action, law, outcome.state, transition.executable, value);
      if (weight > 0.0)
        next[outcome.state] += weight;
    }
  }
  if (replace(std::move(next)))
    return true;

  const auto& fluents = task_->space().fluents();
  SparseBelief corrected;
  for (const auto& [state, probability] : predicted)
  {
    std::vector<std::string> values;
    for (std::size_t i = 0; i < fluents.size(); ++i)
      values.push_back(task_->space().value(state, i));
    for (const auto& [law, value] : told)
    {
      const auto& observed = task_->space().observations(action)[law];
      const auto& possible = fluents[observed.fluent].values;
      if (!observed.value && std::find(possible.begin(), possible.end(), value) != possible.end())
        values[observed.fluent] = value;
    }
    if (const auto found = task_->space().find(values))
      corrected[*found] += probability;
  }
  static_cast<void>(replace(std::move(corrected)));
  return false;
}

void DomainBelief::weigh(const std::string& literal, double confidence)
{
  const LiteralText parts = takeApart(literal);
  const auto fine = task_->space().findFluent(parts.fluent());
  const bool is_coarse = task_->coarseFluents().count(parts.fluent()) != 0;
  const bool of_a_component = task_->domain().coarse(parts.value) != parts.value;
  if (!fine && !is_coarse)
    return;
  const double right = std::min(confidence, kMostCertain);
  const auto valueIn = [&](StateId state) {
    return fine && (of_a_component || !is_coarse) ? task_->space().value(state, *fine)
                                                  : task_->coarseValue(state, parts.fluent());
  };
  std::map<std::string, bool> others;
  for (const auto& entry : states_)
  {
    const std::string value = valueIn(entry.first);
    if (value != parts.value)
      others[value] = true;
  }
  const double wrong =
      parts.equal ? (1.0 - right) / static_cast<double>(std::max<std::size_t>(others.size(), 1))
                  : right;
  SparseBelief weighed;
  for (const auto& [state, probability] : states_)
  {
    const bool is_so = valueIn(state) == parts.value;
    weighed[state] = probability * (is_so ? (parts.equal ? right : 1.0 - right) : wrong);
  }
  static_cast<void>(replace(std::move(weighed)));
}

double DomainBelief::probability(const reasoner::Formula& goal) const
{
  double sum = 0.0;
  for (const auto& [state, probability] : states_)
    sum += task_->holds(goal, state) ? probability : 0.0;
  return sum;
}

std::map<std::string, refinement::Distribution> DomainBelief::marginals() const
{
  std::map<std::string, refinement::Distribution> result;
  const auto& fluents = task_->space().fluents();
  for (std::size_t i = 0; i < fluents.size(); ++i)
    result[fluents[i].name] = task_->fineMarginal(states_, i);
  return result;
}

std::string DomainBelief::likeliest(const std::string& fluent) const
{
  const auto index = task_->space().findFluent(fluent);
  if (!index)
    return {};
  const auto values = task_->fineMarginal(states_, *index);
  return std::max_element(values.begin(), values.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

std::string DomainBelief::summary() const
{
  constexpr std::size_t kShown = 4;
  std::string text;
  for (const auto& [fluent, distribution] : marginals())
  {
    std::vector<std::pair<std::string, double>> values(distribution.begin(), distribution.end());
    std::stable_sort(values.begin(), values.end(),
                     [](const auto& a, const auto& b) { return a.second > b.second; });
    text += (text.empty() ? "" : "; ") + fluent;
    for (std::size_t i = 0; i < std::min(kShown, values.size()); ++i)
    {
      char number[16];
      std::snprintf(number, sizeof number, " %.2f", values[i].second);
      text += (i == 0 ? ": " : ", ") + values[i].first + number;
    }
    text += values.size() > kShown ? ", ..." : "";
  }
  return text;
}

}  // namespace kr3::executive
