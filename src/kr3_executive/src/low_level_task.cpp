#include "kr3_executive/low_level_task.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include <kr3_common/error.hpp>

#include "literal_text.hpp"

namespace kr3::executive
{
namespace
{

using refinement::Distribution;
using refinement::kElsewhere;

/// The name that PomdpTask gives to mass and observations beyond the zoom.
const std::string kOutside = "outside";

constexpr double kCertain = 0.999;

std::string symbolOf(const std::string& atom)
{
  return atom.substr(0, atom.find('('));
}

std::string substituted(const reasoner::Term& term,
                        const std::map<std::string, std::string>& binding)
{
  if (!term.is_variable)
    return term.name;
  const auto found = binding.find(term.name);
  return found == binding.end() ? term.name : found->second;
}

Distribution normalised(Distribution values)
{
  values.erase(kOutside);
  double sum = 0.0;
  for (const auto& entry : values)
    sum += entry.second;
  if (sum <= 0.0)
    return {};
  for (auto& entry : values)
    entry.second /= sum;
  return values;
}

bool isBoolean(const std::string& value)
{
  return value == "true" || value == "false";
}

std::string firstOf(const Distribution& values)
{
  return std::max_element(values.begin(), values.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

}  // namespace

std::string coarseFluent(const refinement::LowLevelDomain& domain, const std::string& fluent)
{
  LiteralText parts = takeApart(fluent);
  for (auto& argument : parts.arguments)
    argument = domain.coarse(argument);
  return parts.fluent();
}

std::vector<ObservedFluent> observedFluents(const reasoner::Description& low_level,
                                            const LowLevelAction& action)
{
  std::vector<ObservedFluent> observed;
  for (const auto& law : low_level.observations)
  {
    if (law.action.name != action.symbol || law.action.arguments.size() != action.arguments.size())
      continue;
    std::map<std::string, std::string> binding;
    bool fits = true;
    for (std::size_t i = 0; i < action.arguments.size(); ++i)
    {
      const auto& term = law.action.arguments[i];
      if (term.is_variable)
        fits = fits &&
               binding.emplace(term.name, action.arguments[i]).first->second == action.arguments[i];
      else
        fits = fits && term.name == action.arguments[i];
    }
    if (!fits)
      continue;
    reasoner::Atom fluent = law.fluent;
    for (auto& argument : fluent.arguments)
      argument = {false, substituted(argument, binding)};
    observed.push_back(
        {reasoner::toString(fluent), law.value ? substituted(*law.value, binding) : std::string()});
  }
  return observed;
}

refinement::InitialKnowledge initialKnowledge(const refinement::LowLevelDomain& domain,
                                              const refinement::Zoom& zoom,
                                              const LowLevelMemory& memory,
                                              const SupportOf& support)
{
  refinement::InitialKnowledge knowledge;
  std::map<std::string, std::string> start;  // high-level values by fluent
  for (const auto& literal : zoom.start)
  {
    if (literal.equal)
      start[reasoner::toString(literal.atom)] = literal.value.name;
  }
  std::set<std::string> settled;
  for (const auto& [fluent, remembered] : memory)
  {
    if (domain.highLevel().findFluent(symbolOf(fluent)) == nullptr)
    {
      knowledge.fine[fluent] = remembered.values;  // the high level says nothing about it
      continue;
    }
    const std::string whole = coarseFluent(domain, fluent);
    const auto held = start.find(whole);
    if (held == start.end() || held->second == "false")
      continue;
    double inside = 0.0;
    for (const auto& component : domain.components(held->second))
    {
      const auto entry = remembered.values.find(component);
      inside += entry == remembered.values.end() ? 0.0 : entry->second;
    }
    const bool of_a_part = whole != fluent;  // a part may differ from its whole
    if (inside > 0.5 || of_a_part || (remembered.assumed == held->second && inside > 0.0))
    {
      knowledge.fine[fluent] = remembered.values;
      settled.insert(whole);
    }
  }
  for (const auto& [fluent, value] : start)
  {
    if (settled.count(fluent) != 0)
      continue;
    const bool boolean = isBoolean(value);
    const std::string literal =
        boolean ? (value == "true" ? fluent : "-" + fluent) : fluent + " = " + value;
    const double probability = support(literal).probability;
    if (probability >= kCertain)
      continue;
    knowledge.coarse[fluent] = {{value, probability}};
    if (boolean)
      knowledge.coarse[fluent][value == "true" ? "false" : "true"] = 1.0 - probability;
  }
  return knowledge;
}

LowLevelTask::LowLevelTask(const refinement::LowLevelDomain& domain, refinement::PomdpTask pomdp,
                           const refinement::InitialKnowledge& knowledge)
  : domain_(domain)
  , pomdp_(std::move(pomdp))
  , belief_(pomdp_.model().initialBelief())
  , symbol_(symbolOf(pomdp_.zoom().action))
  , remembered_(std::any_of(knowledge.fine.begin(), knowledge.fine.end(),
                            [](const auto& known) { return known.second.count(kElsewhere) != 0; }))
{
}

LowLevelAction LowLevelTask::action(std::size_t index) const
{
  return {pomdp_.model().actionName(index), pomdp_.actionSymbol(index),
          pomdp_.actionArguments(index)};
}

std::size_t LowLevelTask::observationIndex(std::size_t action,
                                           const std::vector<std::string>& observation) const
{
  const auto& possible = pomdp_.observationsOf(action);
  std::string name;
  for (const auto& value : observation)
    name += (name.empty() ? "" : ",") + value;
  if (observation.empty())
    name = "none";
  const auto index = pomdp_.model().findObservation(name);
  if (index && std::find(possible.begin(), possible.end(), *index) != possible.end())
    return *index;
  return pomdp_.model().numObservations();  // beyond the zoom
}

bool LowLevelTask::update(std::size_t action, const std::vector<std::string>& observation)
{
  const LowLevelAction executed = this->action(action);
  const auto laws = observedFluents(domain_.description(), executed);
  if (laws.size() != observation.size())
  {
    throw InvalidArgument(executed.text + " gave " + std::to_string(observation.size()) +
                          " observations, expected " + std::to_string(laws.size()));
  }
  attempted_ = attempted_ || executed.symbol == symbol_;
  std::vector<std::string> told = observation;
  for (std::size_t i = 0; i < laws.size(); ++i)
  {
    if (!laws[i].value.empty())
      continue;
    const auto& fluents = pomdp_.fluents();
    const auto hidden = std::find_if(fluents.begin(), fluents.end(), [&](const auto& fluent) {
      return fluent.name == laws[i].fluent && !fluent.values.empty() &&
             fluent.values.back() == kElsewhere;
    });
    if (hidden == fluents.end())
      observed_[laws[i].fluent] = observation[i];
    else if (std::find(hidden->values.begin(), hidden->values.end(), told[i]) ==
             hidden->values.end())
      told[i] = kOutside;  // one more hint, which the belief weighs: sensors err
  }
  const std::size_t index = observationIndex(action, told);
  if (index == pomdp_.model().numObservations())
    return false;
  try
  {
    belief_ = pomdp::updated(pomdp_.model(), belief_, action, index).posterior;
  }
  catch (const FailedPrecondition&)
  {
    return false;
  }
  return true;
}

Assessment LowLevelTask::assess() const
{
  Assessment assessment;
  assessment.achieved = pomdp_.successProbability(belief_);
  assessment.remembered = remembered_;
  assessment.attempted = attempted_;
  for (const auto& effect : pomdp_.zoom().effects)
    assessment.effects.push_back(reasoner::toString(effect));
  for (const auto& literal : pomdp_.zoom().start)
  {
    const std::string name = reasoner::toString(literal.atom);
    const auto& fluents = pomdp_.fluents();
    const bool hidden = std::any_of(fluents.begin(), fluents.end(), [&](const auto& fluent) {
      return fluent.name == name && !fluent.values.empty() && fluent.values.back() == kElsewhere;
    });
    if (!hidden || !literal.equal)
      continue;
    const auto marginal = pomdp_.coarseMarginal(belief_, name);
    const auto elsewhere = marginal.find(kElsewhere);
    if (elsewhere != marginal.end())
      assessment.refutations.push_back({reasoner::toString(literal), elsewhere->second});
  }
  return assessment;
}

void LowLevelTask::remember(LowLevelMemory& memory) const
{
  for (const auto& fluent : pomdp_.fluents())
  {
    Distribution values = normalised(pomdp_.fineMarginal(belief_, fluent.name));
    if (values.empty())
      continue;
    const std::string most = firstOf(values);
    std::string assumed = most == kElsewhere ? std::string() : domain_.coarse(most);
    for (const auto& literal : pomdp_.zoom().start)
    {
      if (assumed.empty() && reasoner::toString(literal.atom) == coarseFluent(domain_, fluent.name))
        assumed = literal.value.name;
    }
    memory[fluent.name] = {std::move(values), std::move(assumed)};
  }
  // What was observed last outweighs a belief that could not take it in.
  for (const auto& [fluent, value] : observed_)
  {
    const auto known = memory.find(fluent);
    if (known == memory.end() || known->second.values.count(value) == 0)
      memory[fluent] = {{{value, 1.0}}, domain_.coarse(value)};
  }
}

}  // namespace kr3::executive
