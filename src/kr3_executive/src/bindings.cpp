#include "kr3_executive/bindings.hpp"

#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>
#include <utility>

#include <kr3_common/error.hpp>

#include "literal_text.hpp"
#include "yaml_reader.hpp"

namespace kr3::executive
{
namespace
{

bool contains(const std::vector<std::string>& items, const std::string& item)
{
  return std::find(items.begin(), items.end(), item) != items.end();
}

bool isFluentArgument(const std::string& argument)
{
  return argument.size() > 3 && argument.compare(0, 2, "${") == 0 && argument.back() == '}';
}

bool isQuoted(const std::string& argument)
{
  return argument.size() >= 2 && argument.front() == '\'' && argument.back() == '\'';
}

/// For each observation law of the action: whether the value comes with the skill's result.
std::vector<bool> valuedLaws(const reasoner::Description& low_level, const std::string& action)
{
  std::vector<bool> valued;
  for (const auto& law : low_level.observations)
  {
    if (law.action.name != action)
      continue;
    const auto* fluent = low_level.findFluent(law.fluent.name);
    valued.push_back(!law.value && fluent != nullptr && fluent->value_sort.has_value());
  }
  return valued;
}

class Loader
{
public:
  Loader(YamlReader& reader, const reasoner::Description& low_level)
    : reader_(reader), low_level_(low_level)
  {
  }

  Binding binding(const YAML::Node& node)
  {
    reader_.checkKeys(node, {"action", "for", "server", "skill", "arguments", "outcomes",
                             "expected_duration_s", "time_limit_s"});
    Binding binding;
    const LiteralText head = takeApart(reader_.text(node, "action"));
    binding.action = head.symbol;
    binding.parameters = head.arguments;
    binding.server = reader_.text(node, "server");
    binding.skill = reader_.text(node, "skill");
    for (const char* key : {"server", "skill"})
    {
      if (node.IsMap() && node[key] && node[key].IsScalar() && node[key].Scalar().empty())
        reader_.problem(node[key], std::string("an empty '") + key + "', expected a name");
    }
    binding.expected_duration_s = reader_.number(node, "expected_duration_s", 10.0);
    binding.time_limit_s = reader_.number(node, "time_limit_s", 0.0);
    if (binding.expected_duration_s < 0.0 || binding.time_limit_s < 0.0)
      reader_.problem(node, "a negative duration, expected seconds from 0 on");
    if (!node.IsMap())
      return binding;
    const auto* declared = low_level_.findAction(binding.action);
    if (declared == nullptr || declared->exogenous)
    {
      reader_.problem(node["action"], "'" + binding.action +
                                          "', expected an action of the low level: " +
                                          listed(names()) + suggestion(binding.action, names()));
      return binding;
    }
    if (declared->argument_sorts.size() != binding.parameters.size())
    {
      reader_.problem(node["action"], std::to_string(binding.parameters.size()) +
                                          " parameters of '" + binding.action + "', expected " +
                                          std::to_string(declared->argument_sorts.size()) +
                                          ", of the sorts " + listed(declared->argument_sorts));
    }
    else
      readFor(node["for"], binding);
    const std::set<std::string> different(binding.parameters.begin(), binding.parameters.end());
    if (different.size() != binding.parameters.size())
      reader_.problem(node["action"], "two parameters of '" + binding.action +
                                          "' have the same name, expected a name for each");
    readArguments(node["arguments"], binding);
    readOutcomes(node["outcomes"], binding);
    return binding;
  }

  /// A sensor of `sightings: watches`.
  Watch watch(const YAML::Node& node)
  {
    reader_.checkKeys(node, {"topic", "becomes", "literal", "confidence"});
    Watch watch;
    watch.topic = reader_.text(node, "topic");
    watch.becomes = reader_.truth(node, "becomes", true);
    watch.confidence = reader_.number(node, "confidence", 1.0);
    if (!(watch.confidence > 0.0 && watch.confidence <= 1.0))
      reader_.problem(node["confidence"], "confidence outside (0, 1]");
    const LiteralText literal = takeApart(reader_.text(node, "literal"));
    watch.holds = literal.value == "true";
    const auto* fluent = low_level_.findFluent(literal.symbol);
    if (fluent == nullptr || fluent->value_sort || !literal.isBoolean())
    {
      reader_.problem(node["literal"], "'" + literal.symbol + "', expected a boolean fluent");
      return watch;
    }
    if (fluent->argument_sorts.size() != literal.arguments.size())
    {
      reader_.problem(node["literal"], std::to_string(literal.arguments.size()) +
                                           " arguments of '" + literal.symbol + "', expected " +
                                           std::to_string(fluent->argument_sorts.size()));
      return watch;
    }
    std::vector<LiteralText> instances{literal};
    for (std::size_t i = 0; i < literal.arguments.size(); ++i)
    {
      if (!isVariable(literal.arguments[i]))
        continue;
      std::vector<LiteralText> longer;
      for (const auto& instance : instances)
      {
        for (const auto& element : low_level_.findSort(fluent->argument_sorts[i])->elements)
        {
          longer.push_back(instance);
          longer.back().arguments[i] = element;
        }
      }
      instances = std::move(longer);
    }
    for (const auto& instance : instances)
      watch.fluents.push_back(instance.fluent());
    return watch;
  }

  /// What a skill that looks about says of what it sees; it fills in the names.
  void checkSeen(const YAML::Node& node)
  {
    if (!node)
      return;
    const std::string text = node.IsScalar() ? node.Scalar() : std::string();
    const LiteralText literal = takeApart(text);
    const auto* fluent = low_level_.findFluent(literal.symbol);
    if (fluent == nullptr || text.find("${object}") == std::string::npos ||
        text.find("${cell}") == std::string::npos)
      reader_.problem(node,
                      "'" + text + "', expected a fluent's literal with ${object} and ${cell}");
  }

  Phrase phrase(const YAML::Node& key, const YAML::Node& node)
  {
    reader_.checkKeys(node, {"holds", "refuted"});
    const auto* fluent = low_level_.findFluent(key.IsScalar() ? key.Scalar() : std::string());
    Phrase phrase{reader_.text(node, "holds"), reader_.optionalText(node, "refuted")};
    if (fluent == nullptr)
    {
      std::vector<std::string> known;
      for (const auto& candidate : low_level_.fluents)
        known.push_back(candidate.name);
      const std::string name = key.IsScalar() ? key.Scalar() : std::string();
      reader_.problem(key, "fluent '" + name + "' is not declared" + suggestion(name, known));
      return phrase;
    }
    for (const auto& text : {phrase.holds, phrase.refuted})
      checkPlaceholders(node, *fluent, text);
    return phrase;
  }

private:
  void readFor(const YAML::Node& node, Binding& binding)
  {
    if (!node)
      return;
    if (!node.IsMap())
    {
      reader_.problem(node, "'for' is no map from parameters to sorts");
      return;
    }
    for (const auto& entry : node)
    {
      const auto parameter = entry.first.as<std::string>();
      const auto at = std::find(binding.parameters.begin(), binding.parameters.end(), parameter);
      const auto* sort = low_level_.findSort(entry.second.as<std::string>(""));
      if (at == binding.parameters.end())
        reader_.problem(entry.first,
                        "'" + parameter + "', expected one of " + listed(binding.parameters));
      else if (sort == nullptr)
        reader_.problem(entry.second, "'" + entry.second.as<std::string>("") + "' is no sort");
      else
        binding.only_for[static_cast<std::size_t>(at - binding.parameters.begin())] = {
            sort->elements.begin(), sort->elements.end()};
    }
  }

  [[nodiscard]] std::vector<std::string> names() const
  {
    std::vector<std::string> known;
    for (const auto& action : low_level_.actions)
    {
      if (!action.exogenous)
        known.push_back(action.name);
    }
    return known;
  }

  /// `{1}` to `{n}` of n arguments, and `{value}` of a fluent that has values.
  void checkPlaceholders(const YAML::Node& node, const reasoner::FluentDeclaration& fluent,
                         const std::string& text)
  {
    for (std::size_t open = text.find('{'); open != std::string::npos;
         open = text.find('{', open + 1))
    {
      const std::size_t close = text.find('}', open);
      const std::string name =
          text.substr(open + 1, close == std::string::npos ? close : close - open - 1);
      bool good = close != std::string::npos && name == "value" && fluent.value_sort.has_value();
      for (std::size_t i = 1; i <= fluent.argument_sorts.size(); ++i)
        good = good || (close != std::string::npos && name == std::to_string(i));
      if (!good)
      {
        reader_.problem(node, "'{" + name + "}' in the phrase of " + fluent.name +
                                  ", expected {1} to {" +
                                  std::to_string(fluent.argument_sorts.size()) + "}" +
                                  (fluent.value_sort ? " or {value}" : ""));
      }
    }
  }

  void readArguments(const YAML::Node& node, Binding& binding)
  {
    for (const auto& argument : reader_.texts(node))
    {
      binding.arguments.push_back(argument);
      if (isQuoted(argument))
        continue;
      if (!isFluentArgument(argument))
      {
        if (!contains(binding.parameters, argument))
        {
          reader_.problem(node, "argument '" + argument + "', expected one of " +
                                    listed(binding.parameters) + ", '...' or ${fluent}");
        }
        continue;
      }
      checkFluent(node, takeApart(argument.substr(2, argument.size() - 3)), binding);
    }
  }

  /// A fluent whose value the robot always has a belief about.
  void checkFluent(const YAML::Node& node, const LiteralText& fluent, const Binding& binding)
  {
    const auto* declared = low_level_.findFluent(fluent.symbol);
    if (declared == nullptr)
    {
      std::vector<std::string> known;
      for (const auto& candidate : low_level_.fluents)
        known.push_back(candidate.name);
      reader_.problem(node, "fluent '" + fluent.symbol + "' is not declared" +
                                suggestion(fluent.symbol, known));
      return;
    }
    if (declared->kind != reasoner::FluentKind::kInertial)
      reader_.problem(node, "the value of '" + fluent.symbol +
                                "' is no belief of the robot, expected an inertial fluent");
    if (declared->argument_sorts.size() != fluent.arguments.size())
    {
      reader_.problem(node, std::to_string(fluent.arguments.size()) + " arguments of '" +
                                fluent.symbol + "', expected " +
                                std::to_string(declared->argument_sorts.size()));
      return;
    }
    for (std::size_t i = 0; i < fluent.arguments.size(); ++i)
    {
      const auto* sort = low_level_.findSort(declared->argument_sorts[i]);
      const std::string& term = fluent.arguments[i];
      if (!contains(binding.parameters, term) &&
          (sort == nullptr || !contains(sort->elements, term)))
      {
        reader_.problem(node, "'" + term + "' in ${" + fluent.fluent() + "}, expected one of " +
                                  listed(binding.parameters) + " or an element of the sort '" +
                                  declared->argument_sorts[i] + "'");
      }
    }
  }

  /// Each labelled outcome of the action's laws: the models say how often it happens, so the
  /// binding has to say what it tells.
  void checkLabels(const YAML::Node& node, const Binding& binding)
  {
    std::set<std::string> missing;
    for (const auto& law : low_level_.causal_laws)
    {
      for (const auto& outcome : law.outcomes)
      {
        if (law.action.name == binding.action && !outcome.label.empty() &&
            binding.outcomes.count(outcome.label) == 0)
          missing.insert(outcome.label);
      }
    }
    for (const auto& label : missing)
    {
      reader_.problem(node, "no outcome '" + label + "' of '" + binding.action +
                                "', which its laws have; say what it tells, as '" + label +
                                ": [...]'");
    }
  }

  void readOutcomes(const YAML::Node& node, Binding& binding)
  {
    if (!node || !node.IsMap() || node.size() == 0)
    {
      reader_.problem(node, "no outcomes of '" + binding.action + "', expected label: [truths]");
      return;
    }
    const std::vector<bool> valued = valuedLaws(low_level_, binding.action);
    const auto expected = static_cast<std::size_t>(std::count(valued.begin(), valued.end(), false));
    for (const auto& entry : node)
    {
      if (!entry.first.IsScalar())
      {
        reader_.problem(entry.first, "an outcome that is no text, expected the skill's label");
        continue;
      }
      const std::string& label = entry.first.Scalar();
      if (binding.outcomes.count(label) != 0)
        reader_.problem(entry.first, "outcome '" + label + "' a second time; leave one of them");
      const std::vector<std::string> truths = reader_.texts(entry.second);
      if (truths.size() != expected)
      {
        reader_.problem(entry.second, "outcome '" + label + "' of '" + binding.action + "' tells " +
                                          std::to_string(truths.size()) + " truths, expected " +
                                          std::to_string(expected) +
                                          ", one for each 'observes' about a truth");
      }
      for (const auto& truth : truths)
      {
        if (truth != "true" && truth != "false")
          reader_.problem(entry.second, "'" + truth + "', expected true or false");
      }
      binding.outcomes[label] = truths;
    }
    if (binding.only_for.empty())  // another skill for a few cases may know other outcomes
      checkLabels(node, binding);
  }

  YamlReader& reader_;
  const reasoner::Description& low_level_;
};

}  // namespace

Bindings Bindings::read(const std::string& path, const reasoner::Description& low_level)
{
  return parse(readTextFile(path), path, low_level);
}

Bindings Bindings::parse(const std::string& text, const std::string& file,
                         const reasoner::Description& low_level)
{
  YamlReader reader(text, file);
  reader.checkKeys(reader.root(), {"actions", "phrases", "sightings"});
  Bindings bindings;
  Loader loader(reader, low_level);
  if (!reader.root()["actions"].IsSequence())
    reader.problem(reader.root(),
                   "no list 'actions', expected '- {action: go(R, S), server: ...}'");
  for (const auto& node : reader.root()["actions"])
  {
    if (!reader.root()["actions"].IsSequence())
      break;
    Binding binding = loader.binding(node);
    const std::string name = binding.action;
    if (!binding.only_for.empty())
      bindings.special_.push_back(std::move(binding));
    else if (!bindings.actions_.emplace(name, std::move(binding)).second)
      reader.problem(node, "a second binding of '" + name + "'");
  }
  for (const auto& action : low_level.actions)
  {
    if (action.exogenous)
      continue;
    bindings.valued_[action.name] = valuedLaws(low_level, action.name);
    if (bindings.actions_.count(action.name) == 0)
      reader.problem(reader.root()["actions"], "action '" + action.name + "' has no binding");
  }
  if (reader.root()["phrases"] && !reader.root()["phrases"].IsMap())
    reader.problem(reader.root()["phrases"],
                   "found no map 'phrases', expected fluent: {holds: ...}");
  else
  {
    for (const auto& entry : reader.root()["phrases"])
    {
      const Phrase phrase = loader.phrase(entry.first, entry.second);
      if (entry.first.IsScalar())
        bindings.phrases_[entry.first.Scalar()] = phrase;
    }
  }
  if (const auto sightings = reader.root()["sightings"])
  {
    reader.checkKeys(sightings, {"seen", "watches"});
    loader.checkSeen(sightings["seen"]);
    for (const auto& node : sightings["watches"])
      bindings.watches_.push_back(loader.watch(node));
  }
  reader.finish();
  return bindings;
}

const Binding& Bindings::bindingOf(const LowLevelAction& action) const
{
  for (const auto& binding : special_)
  {
    const bool fits =
        binding.action == action.symbol &&
        std::all_of(binding.only_for.begin(), binding.only_for.end(), [&](const auto& only) {
          return only.second.count(action.arguments.at(only.first)) != 0;
        });
    if (fits)
      return binding;
  }
  const auto found = actions_.find(action.symbol);
  if (found == actions_.end())
    throw NotFound("no binding for action '" + action.symbol + "'");
  return found->second;
}

std::vector<std::string> Bindings::servers() const
{
  std::set<std::string> names;
  for (const auto& entry : actions_)
    names.insert(entry.second.server);
  for (const auto& binding : special_)
    names.insert(binding.server);
  return {names.begin(), names.end()};
}

SkillCall Bindings::call(const LowLevelAction& action, const FluentLookup& believed) const
{
  const Binding& binding = bindingOf(action);
  const auto valueOf = [&](const std::string& name) {
    const auto at = std::find(binding.parameters.begin(), binding.parameters.end(), name);
    return at == binding.parameters.end()
               ? name
               : action.arguments.at(static_cast<std::size_t>(at - binding.parameters.begin()));
  };
  SkillCall call{binding.server, binding.skill, {}, binding.time_limit_s};
  for (const auto& argument : binding.arguments)
  {
    if (isQuoted(argument))
      call.arguments.push_back(argument.substr(1, argument.size() - 2));
    else if (isFluentArgument(argument))
    {
      LiteralText fluent = takeApart(argument.substr(2, argument.size() - 3));
      for (auto& term : fluent.arguments)
        term = valueOf(term);
      const std::string value = believed(fluent.fluent());
      if (value.empty())
        throw FailedPrecondition(action.text + " needs the value of " + fluent.fluent() +
                                 ", which is not known");
      call.arguments.push_back(value);
    }
    else
      call.arguments.push_back(valueOf(argument));
  }
  return call;
}

std::vector<std::string> Bindings::observation(const LowLevelAction& action,
                                               const std::string& outcome,
                                               const std::vector<std::string>& observed) const
{
  const Binding& binding = bindingOf(action);
  const auto truths = binding.outcomes.find(outcome);
  if (truths == binding.outcomes.end())
  {
    throw InvalidArgument("skill '" + binding.skill + "' gave outcome '" + outcome +
                          "', which the bindings do not list for " + action.symbol);
  }
  std::vector<std::string> values;
  std::size_t next_truth = 0;
  std::size_t next_value = 0;
  for (const bool valued : valued_.at(action.symbol))
  {
    if (!valued)
    {
      values.push_back(truths->second[next_truth++]);
      continue;
    }
    if (next_value >= observed.size())
      throw InvalidArgument("skill '" + binding.skill + "' observed nothing with outcome '" +
                            outcome + "', expected a value");
    values.push_back(observed[next_value++]);
  }
  return values;
}

}  // namespace kr3::executive
