#include "kr3_executive/abstract_training.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include <kr3_common/error.hpp>

#include "kr3_executive/low_level_task.hpp"
#include "kr3_executive/rule_interpreter.hpp"
#include "literal_text.hpp"

namespace kr3::executive
{
namespace
{

constexpr int kInstances = 50;  // of an action, until one is possible somewhere
constexpr int kWorlds = 20;     // for each
constexpr int kChanges = 200;   // of a world, until the action is possible in it

}  // namespace

AbstractTraining::AbstractTraining(const refinement::LowLevelDomain& domain,
                                   const refinement::Models& world, std::uint64_t seed)
  : domain_(domain)
  , models_(world)
  , world_(domain, world, seed)
  , random_(seed ^ 0x9e3779b97f4a7c15ULL)  // apart from the world's chances
  , kinds_(kinds())
{
}

std::vector<TrainingAttempt> AbstractTraining::round()
{
  std::vector<TrainingAttempt> attempts;
  for (const auto& kind : kinds_)
    attempts.push_back(attempt(kind));
  return attempts;
}

std::vector<AbstractTraining::Kind> AbstractTraining::kinds() const
{
  const RuleInterpreter laws(domain_.description());
  std::vector<Kind> all;
  for (const auto& declared : domain_.description().actions)
  {
    if (models_.actions.count(declared.name) == 0)
      continue;
    Kind kind{declared.name, {}, std::nullopt};
    for (const auto& atom : laws.instances(declared))
    {
      LowLevelAction action{reasoner::toString(atom), atom.name, {}};
      for (const auto& argument : atom.arguments)
        action.arguments.push_back(argument.name);
      kind.instances.push_back(std::move(action));
    }
    if (kind.instances.empty())
      continue;
    if (!askingLaw(kind.instances.front()))
    {
      all.push_back(std::move(kind));
      continue;
    }
    for (const bool truth : {true, false})
    {
      kind.truth = truth;
      all.push_back(kind);
    }
  }
  return all;
}

std::optional<std::size_t> AbstractTraining::askingLaw(const LowLevelAction& action) const
{
  const auto laws = observedFluents(domain_.description(), action);
  for (std::size_t i = 0; i < laws.size(); ++i)
  {
    const std::string symbol = takeApart(laws[i].fluent).symbol;
    const bool asks =
        !laws[i].value.empty() || !domain_.description().findFluent(symbol)->value_sort;
    if (asks && !models_.actions.at(action.symbol).observationOf(symbol, action.arguments).exact)
      return i;
  }
  return std::nullopt;
}

TrainingAttempt AbstractTraining::attempt(const Kind& kind)
{
  for (int i = 0; i < kInstances; ++i)
  {
    const LowLevelAction& action = kind.instances[anyOf(kind.instances.size())];
    if (!prepare(action, kind.truth))
      continue;
    TrainingAttempt attempt;
    attempt.action = action;
    attempt.metres = world_.metres(action);
    const LowLevelResult result = world_.execute(action, Disturbance{});
    attempt.outcome = result.outcome;
    attempt.duration_s = result.duration_s;
    const auto laws = observedFluents(domain_.description(), action);
    for (std::size_t law = 0; law < laws.size(); ++law)
    {
      const std::string symbol = takeApart(laws[law].fluent).symbol;
      if (models_.actions.at(action.symbol).observationOf(symbol, action.arguments).exact)
        continue;
      const auto held = world_.fine().find(laws[law].fluent);
      const std::string truth = held == world_.fine().end() ? "false" : held->second;
      const std::string& said = result.observation[law];
      if (laws[law].value.empty() && domain_.description().findFluent(symbol)->value_sort)
        attempt.observed.push_back({symbol, true, said == truth, true});
      else
        attempt.observed.push_back({symbol,
                                    truth == (laws[law].value.empty() ? "true" : laws[law].value),
                                    said == "true", false});
    }
    return attempt;
  }
  throw FailedPrecondition(
      "no state was found in which " + kind.symbol + " is possible" +
      (kind.truth ? std::string(" and what it asks is ") + (*kind.truth ? "so" : "not so")
                  : std::string()));
}

bool AbstractTraining::prepare(const LowLevelAction& action, std::optional<bool> truth)
{
  const std::vector<std::string> conditions = conditionsOf(action);
  for (int draw = 0; draw < kWorlds; ++draw)
  {
    world_.reset({});
    if (truth && !imposeTruth(action, *truth))
      continue;
    std::vector<std::string> all;  // once the conditions by themselves do not help
    for (int change = 0; change < kChanges; ++change)
    {
      if (isReady(action, truth))
        return true;
      if ((conditions.empty() || change >= kChanges / 2) && all.empty())
      {
        for (const auto& [fluent, value] : world_.fine())
          all.push_back(fluent);
      }
      const auto& from = all.empty() ? conditions : all;
      const std::string& fluent = from[anyOf(from.size())];
      impose(fluent, valueFor(fluent, action));
    }
  }
  return false;
}

bool AbstractTraining::isReady(const LowLevelAction& action, std::optional<bool> truth) const
{
  if (!world_.possible(action))
    return false;
  if (!truth)
    return true;
  const auto law = observedFluents(domain_.description(), action).at(*askingLaw(action));
  const auto held = world_.fine().find(law.fluent);
  const std::string value = held == world_.fine().end() ? "false" : held->second;
  return (value == (law.value.empty() ? "true" : law.value)) == *truth;
}

bool AbstractTraining::imposeTruth(const LowLevelAction& action, bool truth)
{
  const auto law = observedFluents(domain_.description(), action).at(*askingLaw(action));
  const std::string asked = law.value.empty() ? "true" : law.value;
  if (truth)
    return impose(law.fluent, asked);
  std::vector<std::string> others = valuesOf(law.fluent);
  others.erase(std::remove(others.begin(), others.end(), asked), others.end());
  return !others.empty() && impose(law.fluent, others[anyOf(others.size())]);
}

bool AbstractTraining::impose(const std::string& fluent, const std::string& value)
{
  try
  {
    world_.impose({{fluent, value}});
    return true;
  }
  catch (const InvalidArgument&)  // the constraints are against it
  {
    return false;
  }
}

std::vector<std::string> AbstractTraining::conditionsOf(const LowLevelAction& action) const
{
  const auto& description = domain_.description();
  std::vector<std::string> fluents;
  for (const auto& law : description.executabilities)
  {
    const auto* head =
        law.actions.size() == 1 ? std::get_if<reasoner::Atom>(&law.actions.front()) : nullptr;
    if (head == nullptr || head->name != action.symbol)
      continue;
    std::map<std::string, std::string> binding;
    for (std::size_t i = 0; i < head->arguments.size(); ++i)
      binding[head->arguments[i].name] = action.arguments.at(i);
    for (const auto& condition : law.body)
    {
      const auto* literal = std::get_if<reasoner::Literal>(&condition);
      const auto* declared =
          literal == nullptr ? nullptr : description.findFluent(literal->atom.name);
      if (declared == nullptr || declared->kind != reasoner::FluentKind::kInertial)
        continue;
      reasoner::Atom fluent = literal->atom;
      bool bound = true;
      for (auto& argument : fluent.arguments)
      {
        const auto value = binding.find(argument.name);
        bound = bound && (!argument.is_variable || value != binding.end());
        if (argument.is_variable && value != binding.end())
          argument = {false, value->second};
      }
      const std::string name = reasoner::toString(fluent);
      if (bound && std::find(fluents.begin(), fluents.end(), name) == fluents.end())
        fluents.push_back(name);
    }
  }
  return fluents;
}

std::string AbstractTraining::valueFor(const std::string& fluent, const LowLevelAction& action)
{
  const std::vector<std::string> values = valuesOf(fluent);
  // Most conditions compare a fluent with an argument, or with another fluent.
  std::vector<std::string> likely;
  const auto add = [&](const std::string& value) {
    if (std::find(values.begin(), values.end(), value) != values.end())
      likely.push_back(value);
  };
  for (const auto& argument : action.arguments)
    add(argument);
  for (const auto& other : conditionsOf(action))
  {
    if (const auto held = world_.fine().find(other); held != world_.fine().end())
      add(held->second);
  }
  const auto& from = likely.empty() || anyOf(2) == 0 ? values : likely;
  return from[anyOf(from.size())];
}

std::vector<std::string> AbstractTraining::valuesOf(const std::string& fluent) const
{
  const auto* declared = domain_.description().findFluent(takeApart(fluent).symbol);
  if (!declared->value_sort)
    return {"true", "false"};
  return domain_.description().findSort(*declared->value_sort)->elements;
}

std::size_t AbstractTraining::anyOf(std::size_t count)
{
  return std::uniform_int_distribution<std::size_t>(0, count - 1)(random_);
}

}  // namespace kr3::executive
