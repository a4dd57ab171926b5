#include "kr3_executive/scripted_world.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <utility>

#include <kr3_common/error.hpp>

#include "literal_text.hpp"

namespace kr3::executive
{
namespace
{

using Binding = std::map<std::string, std::string>;

/// The text with each variable of the binding replaced.
std::string substituted(const std::string& text, const Binding& binding)
{
  const auto partOfName = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
  };
  std::string result;
  for (std::size_t begin = 0; begin < text.size();)
  {
    std::size_t end = begin;
    while (end < text.size() && partOfName(text[end]))
      ++end;
    const std::string name = text.substr(begin, end - begin);
    const auto value = binding.find(name);
    result += value == binding.end() ? name : value->second;
    if (end < text.size())
      result += text[end++];
    begin = end;
  }
  return result;
}

}  // namespace

std::string canonicalText(const LowLevelAction& action)
{
  LiteralText text;
  text.symbol = action.symbol;
  text.arguments = action.arguments;
  return text.fluent();
}

ScriptedWorld::ScriptedWorld(const refinement::LowLevelDomain& domain, AbstractWorld& world,
                             const MissionScript& script, std::function<std::string()> high_level,
                             Tell tell, std::uint64_t seed)
  : domain_(domain)
  , world_(world)
  , script_(script)
  , high_level_(std::move(high_level))
  , tell_(std::move(tell))
  , random_(seed)
  , occurrences_(script.interventions.size(), 0)
  , happened_(script.interventions.size(), 0)
{
}

std::vector<std::string> ScriptedWorld::unused() const
{
  std::vector<std::string> places;
  for (std::size_t i = 0; i < happened_.size(); ++i)
  {
    if (happened_[i] == 0)
      places.push_back(script_.interventions[i].place);
  }
  return places;
}

bool ScriptedWorld::applies(std::size_t index, const LowLevelAction& action)
{
  const Trigger& when = script_.interventions[index].when;
  const bool matches = matchesPattern(canonicalText(action), when.action) &&
                       matchesPattern(high_level_(), when.high_level) &&
                       (when.number == 0 || when.number == number_) &&
                       std::all_of(when.conditions.begin(), when.conditions.end(),
                                   [&](const auto& condition) { return world_.holds(condition); });
  if (!matches || ++occurrences_[index] < when.occurrence)
    return false;
  if (when.times != 0 && happened_[index] >= when.times)
    return false;
  ++happened_[index];
  return true;
}

FluentValues ScriptedWorld::drawn(const std::vector<WorldChange>& changes)
{
  FluentValues values;
  for (const auto& change : changes)
  {
    std::uniform_int_distribution<std::size_t> any(0, change.values.size() - 1);
    values[change.fluent] = change.values[any(random_)];
  }
  return values;
}

void ScriptedWorld::let(const Happening& happening)
{
  if (!happening.set.empty())
    world_.impose(drawn(happening.set));
  for (const auto& record : happening.tell)
    tell_(record);
}

LowLevelResult ScriptedWorld::execute(const LowLevelAction& action,
                                      const FluentLookup& /*believed*/,
                                      const std::atomic<bool>& /*cancel*/)
{
  ++number_;
  std::vector<const Intervention*> now;
  for (std::size_t i = 0; i < script_.interventions.size(); ++i)
  {
    if (applies(i, action))
      now.push_back(&script_.interventions[i]);
  }
  try
  {
    return perform(action, now);
  }
  catch (const InvalidArgument& e)
  {
    problems_.push_back((now.empty() ? "" : now.back()->place + ": ") + e.what());
    throw;
  }
}

LowLevelResult ScriptedWorld::perform(const LowLevelAction& action,
                                      const std::vector<const Intervention*>& now)
{
  Disturbance disturbance;
  for (const auto* intervention : now)
  {
    let(intervention->before);
    const ForcedResult& force = intervention->force;
    if (force.unavailable)
      throw Unavailable("the skill for " + action.text + " does not answer");
    if (force.outcome)
      disturbance.outcome = force.outcome;
    disturbance.blocked = disturbance.blocked || force.blocked;
    for (auto& [fluent, value] : drawn(force.becomes))
      disturbance.becomes[fluent] = value;
    if (!force.observation.empty())
      disturbance.observation = force.observation;
  }
  LowLevelResult result = world_.execute(action, disturbance);
  for (const auto* intervention : now)
  {
    let(intervention->after);
    for (const auto& [literal, confidence] : intervention->sightings)
      result.sightings.push_back({literal, confidence});
  }
  for (const auto& notice : script_.notices)
  {
    for (auto& sighting : noticed(notice, action))
      result.sightings.push_back(std::move(sighting));
  }
  return result;
}

std::vector<Sighting> ScriptedWorld::noticed(const Notice& notice,
                                             const LowLevelAction& action) const
{
  const LiteralText pattern = takeApart(notice.after);
  if (pattern.symbol != action.symbol || pattern.arguments.size() != action.arguments.size())
    return {};
  Binding given;
  for (std::size_t i = 0; i < pattern.arguments.size(); ++i)
  {
    if (isVariable(pattern.arguments[i]))
      given[pattern.arguments[i]] = action.arguments[i];
    else if (pattern.arguments[i] != action.arguments[i])
      return {};
  }
  const LiteralText literal = takeApart(notice.literal);
  const auto* fluent = domain_.description().findFluent(literal.symbol);
  std::vector<Binding> bindings{given};
  for (std::size_t i = 0; i < literal.arguments.size(); ++i)
  {
    if (!isVariable(literal.arguments[i]) || given.count(literal.arguments[i]) != 0)
      continue;
    std::vector<Binding> longer;
    for (const auto& binding : bindings)
    {
      for (const auto& element :
           domain_.description().findSort(fluent->argument_sorts.at(i))->elements)
      {
        longer.push_back(binding);
        longer.back()[literal.arguments[i]] = element;
      }
    }
    bindings = std::move(longer);
  }
  std::vector<Sighting> seen;
  for (auto& binding : bindings)
  {
    const std::string name = substituted(literal.fluent(), binding);
    const auto truth = world_.fine().find(name);
    if (truth == world_.fine().end())
      continue;
    if (isVariable(literal.value))
      binding[literal.value] = truth->second;
    else if (literal.value != truth->second)
      continue;
    const bool visible =
        std::all_of(notice.conditions.begin(), notice.conditions.end(), [&](const auto& condition) {
          return world_.holds(
              reasoner::parseGroundLiteral(substituted(condition, binding), domain_.description()));
        });
    if (!visible)
      continue;
    const std::string& value = truth->second;
    const bool boolean = value == "true" || value == "false";
    seen.push_back({boolean ? (value == "true" ? name : "-" + name) : name + " = " + value,
                    notice.confidence});
  }
  return seen;
}

}  // namespace kr3::executive
