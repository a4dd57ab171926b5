// ActionModelReader: numbers that hold for some arguments only.

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "action_model_reader.hpp"

namespace kr3::refinement
{
namespace
{

bool contains(const std::vector<std::string>& names, const std::string& name)
{
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// What a class says, by what is looked up apart from the rest.
std::vector<std::string> partsOf(const ClassModel& model)
{
  std::vector<std::string> parts;
  if (model.outcomes)
  {
    parts.emplace_back("outcomes");
  }
  for (const auto& [fluent, observation] : model.observations)
  {
    parts.push_back("observation of " + fluent);
  }
  if (model.cost)
  {
    parts.emplace_back("cost");
  }
  return parts;
}

/// Of each set of constants that no class tells apart, one.
std::vector<std::string> representatives(const std::vector<std::string>& constants,
                                         const std::vector<ClassModel>& classes,
                                         std::size_t argument)
{
  std::map<std::vector<bool>, std::string> by_classes;
  for (const std::string& constant : constants)
  {
    std::vector<bool> in;
    for (const ClassModel& model : classes)
    {
      const auto members = model.members.find(argument);
      in.push_back(members == model.members.end() || members->second.count(constant) > 0);
    }
    by_classes.try_emplace(std::move(in), constant);
  }
  std::vector<std::string> result;
  for (const auto& [in, constant] : by_classes)
  {
    result.push_back(constant);
  }
  return result;
}

}  // namespace

void ActionModelReader::readClasses(const YAML::Node& node, ActionModel& model)
{
  if (!node.IsDefined())
  {
    return;
  }
  const std::string what = action_.name + ", classes";
  if (!node.IsSequence())
  {
    file_.report(node, what + ": found " + YamlFile::shown(node) +
                           ", expected a list, as '- {for: {" +
                           (model.parameters.empty() ? "X" : model.parameters.back()) +
                           ": SORT}, outcomes: {...}}'");
    return;
  }
  for (const auto& entry : node)
  {
    if (file_.checkMap(entry, what, {"for", "outcomes", "observations", "cost"}))
    {
      model.classes.push_back(readClass(entry, model));
    }
  }
  checkUnambiguous(model);
}

ClassModel ActionModelReader::readClass(const YAML::Node& node, const ActionModel& model)
{
  ClassModel result;
  result.line = YamlFile::line(node);
  readMembers(node, result);
  const std::string what = action_.name + " for " + result.text;
  const YAML::Node outcomes = YamlFile::entry(node, "outcomes");
  if (outcomes.IsDefined())
  {
    OutcomeModel own = readOutcomes(what + ", outcomes", outcomes, outcomes);
    result.outcomes = labels().empty() ? std::nullopt : std::optional(std::move(own));
  }
  const YAML::Node observations = YamlFile::entry(node, "observations");
  if (observations.IsDefined() &&
      file_.checkMap(observations, what + ", observations", observedFluents()))
  {
    for (const std::string& fluent : observedFluents())
    {
      const YAML::Node entry = YamlFile::entry(observations, fluent);
      if (entry.IsDefined())
      {
        result.observations[fluent] =
            readObservation(what + ", observation of " + fluent, entry, tellsValue(fluent));
      }
    }
  }
  const YAML::Node cost = YamlFile::entry(node, "cost");
  if (cost.IsDefined() &&
      file_.checkMap(cost, what + ", cost",
                     {"base_s", "per_metre_s", "impossible_s", "counts", "stddev_s", "source"}))
  {
    result.cost = model.cost;  // from where to where stays
    if (YamlFile::entry(cost, "per_metre_s").IsDefined() && !model.cost.from)
    {
      file_.report(cost, what + ", cost: per_metre_s, but the cost of " + action_.name +
                             " has no distance; add it there, or leave this out");
    }
    readDuration(what + ", cost", cost, *result.cost);
  }
  if (!outcomes.IsDefined() && !observations.IsDefined() && !cost.IsDefined())
  {
    file_.report(node, what +
                           ": found no numbers, expected 'outcomes', 'observations' or 'cost' that "
                           "differ from those of all " +
                           action_.name);
  }
  return result;
}

/// Sets which constants a class has, and how messages name it.
void ActionModelReader::readMembers(const YAML::Node& node, ClassModel& model)
{
  const std::string what = action_.name + ", classes, for";
  std::vector<std::string> parameters;
  for (const reasoner::Term& parameter : action_.arguments)
  {
    parameters.push_back(parameter.name);
  }
  const YAML::Node given = YamlFile::entry(node, "for");
  model.text = "{}";
  if (!file_.checkMap(given.IsDefined() ? given : node, what, parameters) || !given.IsDefined())
  {
    return;
  }
  if (given.size() == 0)
  {
    file_.report(given, what + ": found no parameter, expected one of " + listed(parameters) +
                            " with its class, as '{" + parameters.front() + ": SORT}'");
  }
  model.text = "{";
  const std::vector<std::string>& sorts = description_.findAction(action_.name)->argument_sorts;
  for (std::size_t i = 0; i < parameters.size(); ++i)
  {
    const YAML::Node entry = YamlFile::entry(given, parameters[i]);
    if (!entry.IsDefined())
    {
      continue;
    }
    const std::string name = entry.IsScalar() ? entry.Scalar() : "";
    model.text += (model.text.size() > 1 ? ", " : "") + parameters[i] + ": " + name;
    const std::vector<std::string>& possible = description_.findSort(sorts[i])->elements;
    const reasoner::Sort* sort = description_.findSort(name);
    std::set<std::string> members = membersOf(name, possible);
    if (sort == nullptr && members.empty())
    {
      std::vector<std::string> known = possible;
      for (const reasoner::Sort& candidate : description_.sorts)
      {
        known.push_back(candidate.name);
      }
      file_.report(entry, what + ": " + parameters[i] + " is " + YamlFile::shown(entry) +
                              ", expected a sort, or an element of the sort '" + sorts[i] + "'" +
                              suggestion(name, known));
      continue;
    }
    if (members.empty() && !sort->elements.empty())
    {
      file_.report(entry, what + ": no " + parameters[i] + " of " + action_.name +
                              " is of the sort '" + name + "'; it is of the sort '" + sorts[i] +
                              "'");
    }
    const bool all = std::all_of(possible.begin(), possible.end(), [&](const std::string& element) {
      return members.count(element) > 0;
    });
    if (!all || possible.empty())
    {
      model.members.emplace(i, std::move(members));
    }
  }
  model.text += "}";
}

/// The possible constants that a sort (or the constant itself) has, and the wholes of those that
/// are components.
std::set<std::string> ActionModelReader::membersOf(const std::string& name,
                                                   const std::vector<std::string>& possible) const
{
  const reasoner::Sort* sort = description_.findSort(name);
  const std::vector<std::string> named =
      sort == nullptr ? std::vector<std::string>{name} : sort->elements;
  std::set<std::string> members;
  for (const std::string& constant : possible)
  {
    const std::string whole = domain_ == nullptr ? constant : domain_->coarse(constant);
    if (contains(named, whole))
    {
      members.insert(whole);
    }
    if (contains(named, constant) || contains(named, whole))
    {
      members.insert(constant);
    }
  }
  return members;
}

/// For any arguments, one of the classes that have a number must be within all others.
void ActionModelReader::checkUnambiguous(const ActionModel& model)
{
  const std::vector<std::string>& sorts = description_.findAction(action_.name)->argument_sorts;
  std::vector<std::vector<std::string>> kinds;
  for (std::size_t i = 0; i < sorts.size(); ++i)
  {
    kinds.push_back(representatives(description_.findSort(sorts[i])->elements, model.classes, i));
  }
  std::set<std::pair<int, int>> told;
  std::vector<std::size_t> choice(kinds.size(), 0);
  bool more = std::none_of(kinds.begin(), kinds.end(), [](const auto& k) { return k.empty(); });
  while (more)
  {
    std::vector<std::string> arguments;
    for (std::size_t i = 0; i < kinds.size(); ++i)
    {
      arguments.push_back(kinds[i][choice[i]]);
    }
    std::map<std::string, std::vector<const ClassModel*>> least;
    for (const ClassModel& candidate : model.classes)
    {
      for (const std::string& part : partsOf(candidate))
      {
        if (candidate.contains(arguments))
        {
          least[part].push_back(&candidate);
        }
      }
    }
    for (auto& [part, candidates] : least)
    {
      const std::vector<const ClassModel*> all = candidates;
      const auto beaten = [&](const ClassModel* one) {
        return std::any_of(all.begin(), all.end(), [&](const ClassModel* other) {
          return other->isWithin(*one) && !one->isWithin(*other);
        });
      };
      candidates.erase(std::remove_if(candidates.begin(), candidates.end(), beaten),
                       candidates.end());
      if (candidates.size() < 2 || !told.insert({candidates[0]->line, candidates[1]->line}).second)
      {
        continue;
      }
      std::string text;
      for (const std::string& argument : arguments)
      {
        text += (text.empty() ? "" : ", ") + argument;
      }
      file_.problems().add(
          {file_.name(), candidates[1]->line, 0},
          action_.name + ", classes: " + candidates[1]->text + " here and " + candidates[0]->text +
              " in line " + std::to_string(candidates[0]->line) + " both have the " + part +
              " of " + action_.name + "(" + text +
              "), and neither is within the other; add a class for what is in both, or take it out "
              "of one");
    }
    std::size_t digit = 0;
    while (digit < kinds.size() && ++choice[digit] == kinds[digit].size())
    {
      choice[digit++] = 0;
    }
    more = digit < kinds.size();
  }
}

}  // namespace kr3::refinement
