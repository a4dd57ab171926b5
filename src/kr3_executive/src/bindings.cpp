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
    reader_.checkKeys(node, {"action", "server", "skill", "arguments", "outcomes",
                             "expected_duration_s", "time_limit_s"});
    Binding binding;
    const LiteralText head = takeApart(reader_.text(node, "action"));
    binding.action = head.symbol;
    binding.parameters = head.arguments;
    binding.server = reader_.text(node, "server");
    binding.skill = reader_.text(node, "skill");
    binding.expected_duration_s = reader_.number(node, "expected_duration_s", 10.0);
    binding.time_limit_s = reader_.number(node, "time_limit_s", 0.0);
    if (binding.expected_duration_s < 0.0 || binding.time_limit_s < 0.0)
      reader_.problem(node, "a negative duration");
    const auto* declared = low_level_.findAction(binding.action);
    if (declared == nullptr || declared->exogenous)
    {
      reader_.problem(node["action"],
                      "'" + binding.action + "', expected an action of the low level: " + names());
      return binding;
    }
    if (declared->argument_sorts.size() != binding.parameters.size())
    {
      reader_.problem(node["action"], std::to_string(binding.parameters.size()) +
                                          " parameters of '" + binding.action + "', expected " +
                                          std::to_string(declared->argument_sorts.size()));
    }
    readArguments(node["arguments"], binding);
    readOutcomes(node["outcomes"], binding);
    return binding;
  }

private:
  [[nodiscard]] std::string names() const
  {
    std::vector<std::string> known;
    for (const auto& action : low_level_.actions)
    {
      if (!action.exogenous)
        known.push_back(action.name);
    }
    return listed(known);
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
      const LiteralText fluent = takeApart(argument.substr(2, argument.size() - 3));
      if (low_level_.findFluent(fluent.symbol) == nullptr)
        reader_.problem(node, "fluent '" + fluent.symbol + "' is not declared");
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
      const auto label = entry.first.as<std::string>();
      const std::vector<std::string> truths = reader_.texts(entry.second);
      if (truths.size() != expected)
      {
        reader_.problem(entry.second, "outcome '" + label + "' of '" + binding.action + "' tells " +
                                          std::to_string(truths.size()) + " truths, expected " +
                                          std::to_string(expected));
      }
      for (const auto& truth : truths)
      {
        if (truth != "true" && truth != "false")
          reader_.problem(entry.second, "'" + truth + "', expected true or false");
      }
      binding.outcomes[label] = truths;
    }
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
  reader.checkKeys(reader.root(), {"actions", "phrases"});
  Bindings bindings;
  Loader loader(reader, low_level);
  if (!reader.root()["actions"].IsSequence())
    reader.problem(reader.root(), "no list 'actions'");
  for (const auto& node : reader.root()["actions"])
  {
    Binding binding = loader.binding(node);
    const std::string name = binding.action;
    if (!bindings.actions_.emplace(name, std::move(binding)).second)
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
  for (const auto& entry : reader.root()["phrases"])
  {
    reader.checkKeys(entry.second, {"holds", "refuted"});
    const auto name = entry.first.as<std::string>();
    if (low_level.findFluent(name) == nullptr)
      reader.problem(entry.first, "fluent '" + name + "' is not declared");
    bindings.phrases_[name] = {reader.text(entry.second, "holds"),
                               reader.optionalText(entry.second, "refuted")};
  }
  reader.finish();
  return bindings;
}

std::vector<std::string> Bindings::servers() const
{
  std::set<std::string> names;
  for (const auto& entry : actions_)
    names.insert(entry.second.server);
  return {names.begin(), names.end()};
}

SkillCall Bindings::call(const LowLevelAction& action, const FluentLookup& believed) const
{
  const auto found = actions_.find(action.symbol);
  if (found == actions_.end())
    throw NotFound("no binding for action '" + action.symbol + "'");
  const Binding& binding = found->second;
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
  const auto found = actions_.find(action.symbol);
  if (found == actions_.end())
    throw NotFound("no binding for action '" + action.symbol + "'");
  const auto truths = found->second.outcomes.find(outcome);
  if (truths == found->second.outcomes.end())
  {
    throw InvalidArgument("skill '" + found->second.skill + "' gave outcome '" + outcome +
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
      throw InvalidArgument("skill '" + found->second.skill + "' observed nothing with outcome '" +
                            outcome + "', expected a value");
    values.push_back(observed[next_value++]);
  }
  return values;
}

}  // namespace kr3::executive
