#include "kr3_refinement/models.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>
#include <sstream>
#include <utility>

#include <yaml-cpp/yaml.h>

#include <kr3_common/error.hpp>

namespace kr3::refinement
{
namespace
{

using reasoner::ActionDeclaration;
using reasoner::Atom;
using reasoner::Description;

/// `name` or `name(A, B)`; nothing when it is neither.
std::optional<Atom> parseAtom(const std::string& text)
{
  const auto is_name = [](const std::string& name) {
    return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
      return (std::isalnum(static_cast<unsigned char>(c)) != 0) || c == '_';
    });
  };
  std::string compact;
  std::copy_if(text.begin(), text.end(), std::back_inserter(compact),
               [](char c) { return c != ' '; });
  const std::size_t open = compact.find('(');
  Atom atom{compact.substr(0, open), {}, {}};
  if (open != std::string::npos)
  {
    if (compact.back() != ')')
    {
      return std::nullopt;
    }
    std::istringstream list(compact.substr(open + 1, compact.size() - open - 2));
    for (std::string argument; std::getline(list, argument, ',');)
    {
      atom.arguments.push_back({true, argument});
    }
  }
  const bool good = is_name(atom.name) &&
                    std::all_of(atom.arguments.begin(), atom.arguments.end(),
                                [&](const reasoner::Term& term) { return is_name(term.name); });
  return good ? std::optional(atom) : std::nullopt;
}

std::set<std::string> labelsOf(const Description& description, const std::string& action)
{
  std::set<std::string> labels;
  for (const reasoner::CausalLaw& law : description.causal_laws)
  {
    for (const reasoner::Outcome& outcome : law.outcomes)
    {
      if (law.action.name == action && !outcome.label.empty())
      {
        labels.insert(outcome.label);
      }
    }
  }
  return labels;
}

std::set<std::string> observedFluents(const Description& description, const std::string& action)
{
  std::set<std::string> fluents;
  for (const reasoner::ObservationLaw& law : description.observations)
  {
    if (law.action.name == action)
    {
      fluents.insert(law.fluent.name);
    }
  }
  return fluents;
}

std::string listed(const std::set<std::string>& names)
{
  std::string result;
  for (const std::string& name : names)
  {
    result += (result.empty() ? "'" : ", '") + name + "'";
  }
  return result.empty() ? "none" : result;
}

class ModelsReader
{
public:
  ModelsReader(std::string file, const Description& description)
    : file_(std::move(file)), description_(description)
  {
  }

  Models read(const YAML::Node& root)
  {
    Models models;
    if (!checkMap(root, "the models", {"actions", "rewards", "discount", "threshold"}))
    {
      stopOnProblems();
    }
    models.discount = number(root, "discount", models.discount, 0.0, 1.0);
    models.threshold = number(root, "threshold", models.threshold, 0.5, 1.0);
    if (models.discount <= 0.0 || models.discount >= 1.0)
    {
      report(root["discount"],
             "discount " + std::to_string(models.discount) + ", expected one between 0 and 1");
    }
    if (const YAML::Node rewards = root["rewards"])
    {
      readRewards(rewards, models.rewards);
    }
    readActions(root, models);
    stopOnProblems();
    return models;
  }

private:
  static constexpr double kLarge = 1e9;

  void report(const YAML::Node& node, const std::string& message)
  {
    const int line = node.IsDefined() ? node.Mark().line : -1;
    problems_.push_back(
        {line, file_ + ":" + std::to_string(std::max(line, 0) + 1) + ": " + message});
  }

  void stopOnProblems()
  {
    if (problems_.empty())
    {
      return;
    }
    std::stable_sort(problems_.begin(), problems_.end(),
                     [](const Problem& a, const Problem& b) { return a.line < b.line; });
    std::string message;
    for (const Problem& problem : problems_)
    {
      message += (message.empty() ? "" : "\n") + problem.message;
    }
    throw InvalidArgument(message);
  }

  bool checkMap(const YAML::Node& node, const std::string& what, const std::set<std::string>& keys)
  {
    if (!node.IsMap())
    {
      report(node, what + ": found no map, expected one with keys " + listed(keys));
      return false;
    }
    std::set<std::string> seen;
    for (const auto& entry : node)
    {
      const auto key = entry.first.as<std::string>();
      if (keys.count(key) == 0)
      {
        report(entry.first, what + ": unknown key '" + key + "', expected one of " + listed(keys));
      }
      if (!seen.insert(key).second)
      {
        report(entry.first, what + ": key '" + key + "' a second time");
      }
    }
    return true;
  }

  double number(const YAML::Node& map, const std::string& key, double fallback, double least,
                double most)
  {
    const YAML::Node node = map[key];
    if (!node.IsDefined())
    {
      return fallback;
    }
    double value = fallback;
    const bool is_number =
        node.IsScalar() && YAML::convert<double>::decode(node, value) && std::isfinite(value);
    if (!is_number || value < least || value > most)
    {
      std::ostringstream message;
      message << key << ": found '" << (node.IsScalar() ? node.Scalar() : "no scalar")
              << "', expected a number from " << least << " to " << most;
      report(node, message.str());
      return fallback;
    }
    return value;
  }

  void readRewards(const YAML::Node& node, RewardModel& rewards)
  {
    if (checkMap(node, "rewards", {"success", "given_up", "wrong_finish"}))
    {
      rewards.success = number(node, "success", rewards.success, -kLarge, kLarge);
      rewards.given_up = number(node, "given_up", rewards.given_up, -kLarge, kLarge);
      rewards.wrong_finish = number(node, "wrong_finish", rewards.wrong_finish, -kLarge, kLarge);
    }
  }

  void readActions(const YAML::Node& root, Models& models)
  {
    const YAML::Node actions = root["actions"];
    if (!actions.IsDefined() || !actions.IsMap())
    {
      report(root,
             "found no map 'actions', expected one entry for each action, as 'move(R, C): {...}'");
      return;
    }
    for (const auto& entry : actions)
    {
      const auto text = entry.first.as<std::string>();
      const std::optional<Atom> atom = parseAtom(text);
      const ActionDeclaration* action = atom ? description_.findAction(atom->name) : nullptr;
      if (action == nullptr)
      {
        report(entry.first, "'" + text + "' is no action of the low level, as 'move(R, C)' is");
      }
      else if (atom->arguments.size() != action->argument_sorts.size())
      {
        report(entry.first, "'" + text + "' has " + std::to_string(atom->arguments.size()) +
                                " parameters, expected " +
                                std::to_string(action->argument_sorts.size()));
      }
      else if (models.actions.count(atom->name) > 0)
      {
        report(entry.first, "'" + atom->name + "' a second time");
      }
      else
      {
        models.actions.emplace(atom->name, readAction(*atom, entry.first, entry.second));
      }
    }
    for (const ActionDeclaration& action : description_.actions)
    {
      if (!action.exogenous && models.actions.count(action.name) == 0)
      {
        report(actions,
               "actions: found none for '" + action.name + "', expected an entry for each action");
      }
    }
  }

  ActionModel readAction(const Atom& action, const YAML::Node& key, const YAML::Node& node)
  {
    ActionModel model;
    for (const reasoner::Term& parameter : action.arguments)
    {
      model.parameters.push_back(parameter.name);
    }
    if (!checkMap(node, action.name, {"outcomes", "observations", "cost"}))
    {
      return model;
    }
    const std::set<std::string> labels = labelsOf(description_, action.name);
    if (node["outcomes"].IsDefined() || !labels.empty())
    {
      model.outcomes =
          readOutcomes(action.name, node["outcomes"].IsDefined() ? node["outcomes"] : key, labels);
    }
    readObservations(action.name, key, node["observations"], model);
    if (const YAML::Node cost = node["cost"])
    {
      model.cost = readCost(action, cost);
    }
    else
    {
      report(key, action.name + ": found no 'cost', expected one with base_s and impossible_s");
    }
    return model;
  }

  ModelSource readSource(const std::string& what, const YAML::Node& node, bool has_counts)
  {
    const YAML::Node source = node["source"];
    const std::string text = source.IsDefined() && source.IsScalar() ? source.Scalar() : "";
    if (text != "learned" && text != "hand-written")
    {
      report(source.IsDefined() ? source : node,
             what + ": source '" + text + "', expected 'learned' or 'hand-written'");
    }
    if (text == "learned" && !has_counts)
    {
      report(node, what + ": learned without counts; give the sample sizes");
    }
    return text == "learned" ? ModelSource::kLearned : ModelSource::kHandWritten;
  }

  std::map<std::string, std::uint64_t> readCounts(const std::string& what, const YAML::Node& node)
  {
    std::map<std::string, std::uint64_t> counts;
    if (!node.IsDefined())
    {
      return counts;
    }
    for (const auto& entry : node)
    {
      std::uint64_t count = 0;
      if (!entry.second.IsScalar() || !YAML::convert<std::uint64_t>::decode(entry.second, count))
      {
        report(entry.second, what + ": a count must be a whole number");
      }
      counts[entry.first.as<std::string>()] = count;
    }
    return counts;
  }

  OutcomeModel readOutcomes(const std::string& action, const YAML::Node& node,
                            const std::set<std::string>& labels)
  {
    const std::string what = action + ", outcomes";
    OutcomeModel model;
    if (!checkMap(node, what, {"probabilities", "counts", "source"}))
    {
      return model;
    }
    const YAML::Node probabilities = node["probabilities"];
    if (!probabilities.IsDefined() || !checkMap(probabilities, what + ", probabilities", labels))
    {
      report(node, what + ": found no probabilities, expected one for each of " + listed(labels));
      return model;
    }
    double total = 0.0;
    for (const std::string& label : labels)
    {
      if (!probabilities[label].IsDefined())
      {
        report(probabilities, what + ": found no probability of '" + label + "'");
      }
      model.probabilities[label] = number(probabilities, label, 0.0, 0.0, 1.0);
      total += model.probabilities[label];
    }
    if (std::abs(total - 1.0) > 1e-6)
    {
      report(probabilities,
             what + ": the probabilities sum to " + std::to_string(total) + ", expected 1");
    }
    model.counts = readCounts(what, node["counts"]);
    for (const auto& [label, count] : model.counts)
    {
      if (labels.count(label) == 0)
      {
        report(node["counts"],
               what + ": count of unknown outcome '" + label + "', expected " + listed(labels));
      }
    }
    model.source = readSource(what, node, !model.counts.empty());
    return model;
  }

  void readObservations(const std::string& action, const YAML::Node& key, const YAML::Node& node,
                        ActionModel& model)
  {
    const std::set<std::string> fluents = observedFluents(description_, action);
    if (node.IsDefined() && !checkMap(node, action + ", observations", fluents))
    {
      return;
    }
    for (const std::string& fluent : fluents)
    {
      const YAML::Node entry = node.IsDefined() ? node[fluent] : node;
      if (!entry.IsDefined())
      {
        report(node.IsDefined() ? node : key, action + ": found no observation model of '" +
                                                  fluent +
                                                  "', expected 'exact' or true_positive and "
                                                  "false_positive");
        continue;
      }
      model.observations[fluent] = readObservation(action + ", observation of " + fluent, entry);
    }
  }

  ObservationModel readObservation(const std::string& what, const YAML::Node& node)
  {
    ObservationModel model;
    if (node.IsScalar() && node.Scalar() == "exact")
    {
      return model;
    }
    if (node.IsScalar())
    {
      report(node, what + ": found '" + node.Scalar() + "', expected 'exact' or a map");
      return model;
    }
    if (checkMap(node, what, {"true_positive", "false_positive", "counts", "source"}))
    {
      if (!node["true_positive"].IsDefined())
      {
        report(node, what + ": found no true_positive, expected a probability");
      }
      model.true_positive = number(node, "true_positive", 1.0, 0.0, 1.0);
      model.false_positive = number(node, "false_positive", 0.0, 0.0, 1.0);
      model.counts = readCounts(what, node["counts"]);
      model.source = readSource(what, node, !model.counts.empty());
    }
    return model;
  }

  CostModel readCost(const Atom& action, const YAML::Node& node)
  {
    const std::string what = action.name + ", cost";
    CostModel cost;
    if (!checkMap(node, what, {"base_s", "per_metre_s", "distance", "impossible_s"}))
    {
      return cost;
    }
    for (const char* key : {"base_s", "impossible_s"})
    {
      if (!node[key].IsDefined())
      {
        report(node, what + ": found no " + key + ", expected seconds");
      }
    }
    cost.base_s = number(node, "base_s", cost.base_s, 0.0, kLarge);
    cost.impossible_s = number(node, "impossible_s", cost.impossible_s, 0.0, kLarge);
    cost.per_metre_s = number(node, "per_metre_s", cost.per_metre_s, 0.0, kLarge);
    const YAML::Node distance = node["distance"];
    if (distance.IsDefined() != node["per_metre_s"].IsDefined())
    {
      report(node, what + ": per_metre_s and distance go together");
    }
    if (distance.IsDefined() && checkMap(distance, what + ", distance", {"from", "to"}))
    {
      readDistance(action, what, distance, cost);
    }
    return cost;
  }

  void readDistance(const Atom& action, const std::string& what, const YAML::Node& node,
                    CostModel& cost)
  {
    const auto is_parameter = [&](const reasoner::Term& term) {
      return std::any_of(
          action.arguments.begin(), action.arguments.end(),
          [&](const reasoner::Term& parameter) { return parameter.name == term.name; });
    };
    const YAML::Node from = node["from"];
    const YAML::Node to = node["to"];
    const std::optional<Atom> fluent =
        from.IsDefined() && from.IsScalar() ? parseAtom(from.Scalar()) : std::nullopt;
    const reasoner::FluentDeclaration* declaration =
        fluent ? description_.findFluent(fluent->name) : nullptr;
    const bool good = declaration != nullptr &&
                      declaration->argument_sorts.size() == fluent->arguments.size() &&
                      std::all_of(fluent->arguments.begin(), fluent->arguments.end(), is_parameter);
    if (!good)
    {
      report(from.IsDefined() ? from : node,
             what + ": distance from '" +
                 (from.IsDefined() && from.IsScalar() ? from.Scalar() : "") +
                 "', expected a fluent over the action's parameters");
    }
    if (!to.IsDefined() || !to.IsScalar() || !is_parameter({true, to.Scalar()}))
    {
      report(to.IsDefined() ? to : node, what + ": distance to '" +
                                             (to.IsDefined() && to.IsScalar() ? to.Scalar() : "") +
                                             "', expected one of the action's parameters");
      return;
    }
    cost.from = good ? fluent : std::nullopt;
    cost.to = to.Scalar();
  }

  struct Problem
  {
    int line;
    std::string message;
  };

  std::string file_;
  const Description& description_;
  std::vector<Problem> problems_;
};

}  // namespace

Models parseModels(const std::string& text, const std::string& file, const Description& low_level)
{
  try
  {
    return ModelsReader(file, low_level).read(YAML::Load(text));
  }
  catch (const YAML::Exception& error)
  {
    throw InvalidArgument(file + ":" + std::to_string(error.mark.line + 1) + ": " + error.msg);
  }
}

Models readModels(const std::string& path, const Description& low_level)
{
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file.is_open() || file.bad())
  {
    throw Unavailable("cannot read '" + path + "'");
  }
  return parseModels(text.str(), path, low_level);
}

}  // namespace kr3::refinement
