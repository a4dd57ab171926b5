#include "kr3_refinement/models.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include <kr3_common/error.hpp>

#include "action_model_reader.hpp"
#include "yaml_file.hpp"

namespace kr3::refinement
{
namespace
{

using reasoner::ActionDeclaration;
using reasoner::Atom;
using reasoner::Description;

constexpr double kLarge = 1e9;
constexpr double kSumTolerance = 1e-6;

struct Unlearned
{
  std::string action;  ///< with its class, where it is one's
  std::string what;
  int line;
};

void addUnlearned(const std::string& action, const OutcomeModel& model,
                  std::vector<Unlearned>& result)
{
  if (!model.probabilities.empty() && model.source == ModelSource::kHandWritten)
  {
    result.push_back({action, "outcomes", model.line});
  }
}

void addUnlearned(const std::string& action,
                  const std::map<std::string, ObservationModel>& observations,
                  std::vector<Unlearned>& result)
{
  for (const auto& [fluent, model] : observations)
  {
    if (!model.exact && model.source == ModelSource::kHandWritten)
    {
      result.push_back({action, "observation of " + fluent, model.line});
    }
  }
}

void addUnlearned(const std::string& action, const CostModel& model, std::vector<Unlearned>& result)
{
  if (model.source == ModelSource::kHandWritten)
  {
    result.push_back({action, "cost", model.line});
  }
}

/// Everything that nobody learned from trials.
std::vector<Unlearned> unlearned(const Models& models)
{
  std::vector<Unlearned> result;
  for (const auto& [name, action] : models.actions)
  {
    addUnlearned(name, action.outcomes, result);
    addUnlearned(name, action.observations, result);
    addUnlearned(name, action.cost, result);
    for (const ClassModel& model : action.classes)
    {
      const std::string of_class = name + " for " + model.text;
      addUnlearned(of_class, model.outcomes.value_or(OutcomeModel()), result);
      addUnlearned(of_class, model.observations, result);
      if (model.cost)
      {
        addUnlearned(of_class, *model.cost, result);
      }
    }
  }
  return result;
}

class ModelsReader
{
public:
  /// @param domain  nullptr: the map is not checked
  ModelsReader(YamlFile& file, const Description& description, const LowLevelDomain* domain)
    : file_(file), description_(description), domain_(domain)
  {
  }

  Models read(const ModelsOptions& options)
  {
    Models models;
    models.file = file_.name();
    const YAML::Node& root = file_.root();
    if (file_.checkMap(root, "the models",
                       {"actions", "rewards", "discount", "threshold", "priors"}))
    {
      readNumbers(root, models);
      readPriors(YamlFile::entry(root, "priors"), models);
      readActions(root, models);
    }
    if (options.require_learned)
    {
      requireLearned(models);
    }
    file_.problems().throwIfAny();
    return models;
  }

private:
  void readNumbers(const YAML::Node& root, Models& models)
  {
    models.discount = file_.number(root, "discount", models.discount, 0.0, 1.0);
    models.threshold = file_.number(root, "threshold", models.threshold, 0.0, 1.0);
    if (models.discount <= 0.0 || models.discount >= 1.0)
    {
      file_.report(YamlFile::entry(root, "discount"),
                   "discount: found " + YamlFile::shown(YamlFile::entry(root, "discount")) +
                       ", expected a number between 0 and 1, both excluded");
    }
    if (models.threshold <= 0.5 || models.threshold >= 1.0)
    {
      file_.report(YamlFile::entry(root, "threshold"),
                   "threshold: found " + YamlFile::shown(YamlFile::entry(root, "threshold")) +
                       ", expected a number between 0.5 and 1, both excluded: belief above it "
                       "becomes knowledge");
    }
    const YAML::Node node = YamlFile::entry(root, "rewards");
    RewardModel& rewards = models.rewards;
    if (node.IsDefined() &&
        file_.checkMap(node, "rewards", {"success", "given_up", "wrong_finish"}))
    {
      rewards.success = file_.number(node, "success", rewards.success, -kLarge, kLarge);
      rewards.given_up = file_.number(node, "given_up", rewards.given_up, -kLarge, kLarge);
      rewards.wrong_finish =
          file_.number(node, "wrong_finish", rewards.wrong_finish, -kLarge, kLarge);
      if (rewards.success <= rewards.given_up || rewards.given_up <= rewards.wrong_finish)
      {
        file_.report(node,
                     "rewards: expected success above given_up and given_up above wrong_finish, or "
                     "giving up is the better policy");
      }
    }
  }

  void readPriors(const YAML::Node& node, Models& models)
  {
    if (!node.IsDefined())
    {
      return;
    }
    std::vector<std::string> names;
    for (const reasoner::FluentDeclaration& fluent : description_.fluents)
    {
      const bool of_both =
          domain_ != nullptr && domain_->highLevel().findFluent(fluent.name) != nullptr;
      if (fluent.kind == reasoner::FluentKind::kInertial && !of_both)
      {
        names.push_back(fluent.name);
      }
    }
    if (!node.IsMap())
    {
      file_.report(node,
                   "priors: found " + YamlFile::shown(node) +
                       ", expected a map from fluents of the low level alone, as 'f(X): 0.3'");
      return;
    }
    for (const auto& entry : node)
    {
      const std::optional<Atom> atom =
          parsedAtom(entry.first.IsScalar() ? entry.first.Scalar() : "");
      if (!atom || std::find(names.begin(), names.end(), atom->name) == names.end())
      {
        file_.report(entry.first,
                     "priors: " + YamlFile::shown(entry.first) +
                         " is no inertial fluent of the low level alone, expected one of " +
                         listed(names) + (atom ? suggestion(atom->name, names) : "") +
                         "; what the high level has is known from its history and defaults");
        continue;
      }
      const reasoner::FluentDeclaration& fluent = *description_.findFluent(atom->name);
      if (atom->arguments.size() != fluent.argument_sorts.size())
      {
        file_.report(entry.first, "priors: '" + entry.first.Scalar() + "' has " +
                                      std::to_string(atom->arguments.size()) +
                                      " arguments, expected " +
                                      std::to_string(fluent.argument_sorts.size()) +
                                      ", of the sorts " + listed(fluent.argument_sorts));
      }
      if (!models.priors.emplace(atom->name, readPrior(fluent, entry.second)).second)
      {
        file_.report(entry.first, "priors: '" + atom->name + "' a second time; leave one of them");
      }
    }
  }

  FluentPrior readPrior(const reasoner::FluentDeclaration& fluent, const YAML::Node& node)
  {
    const std::string what = "priors, " + fluent.name;
    const std::vector<std::string> values =
        fluent.value_sort ? description_.findSort(*fluent.value_sort)->elements
                          : std::vector<std::string>{"false", "true"};
    FluentPrior prior;
    prior.line = YamlFile::line(node);
    for (const std::string& value : values)
    {
      prior.probabilities[value] = 1.0 / static_cast<double>(values.size());
    }
    if (node.IsScalar() && node.Scalar() == "uniform")
    {
      return prior;
    }
    if (node.IsScalar() && !fluent.value_sort)
    {
      const std::optional<double> yes = file_.finite(node, what);
      if (yes && (*yes < 0.0 || *yes > 1.0))
      {
        file_.report(node, what + ": found '" + node.Scalar() + "', expected a number from 0 to 1");
      }
      prior.probabilities = {{"false", 1.0 - yes.value_or(0.5)}, {"true", yes.value_or(0.5)}};
      return prior;
    }
    if (node.IsScalar())
    {
      file_.report(node, what + ": found '" + node.Scalar() +
                             "', expected 'uniform' or probabilities by value");
      return prior;
    }
    if (!file_.checkMap(node, what, values))
    {
      return prior;
    }
    double total = 0.0;
    for (auto& [value, probability] : prior.probabilities)
    {
      probability = file_.number(node, value, 0.0, 0.0, 1.0);
      total += probability;
    }
    if (std::abs(total - 1.0) > kSumTolerance)
    {
      file_.report(node,
                   what + ": the probabilities sum to " + std::to_string(total) + ", expected 1");
    }
    return prior;
  }

  void readActions(const YAML::Node& root, Models& models)
  {
    const YAML::Node actions = YamlFile::entry(root, "actions");
    if (!actions.IsDefined() || !actions.IsMap())
    {
      file_.report(
          actions.IsDefined() ? actions : root,
          "found no map 'actions', expected one entry for each action, as 'move(R, C): {...}'");
      return;
    }
    std::vector<std::string> names;
    for (const ActionDeclaration& action : description_.actions)
    {
      if (!action.exogenous)
      {
        names.push_back(action.name);
      }
    }
    std::vector<std::string> mentioned;
    for (const auto& entry : actions)
    {
      const std::string text = entry.first.IsScalar() ? entry.first.Scalar() : "";
      const std::optional<Atom> atom = parsedAtom(text);
      if (!atom || std::find(names.begin(), names.end(), atom->name) == names.end())
      {
        file_.report(entry.first, "actions: " + YamlFile::shown(entry.first) +
                                      " is no action of the low level, as 'move(R, C)' is" +
                                      (atom ? suggestion(atom->name, names) : ""));
        continue;
      }
      readAction(*atom, entry.first, entry.second, models);
      mentioned.push_back(atom->name);
    }
    for (const std::string& name : names)
    {
      if (std::find(mentioned.begin(), mentioned.end(), name) == mentioned.end())
      {
        file_.report(actions, "actions: found none for '" + name +
                                  "', expected an entry for each action of the low level");
      }
    }
  }

  void readAction(const Atom& atom, const YAML::Node& key, const YAML::Node& node, Models& models)
  {
    const ActionDeclaration& action = *description_.findAction(atom.name);
    if (atom.arguments.size() != action.argument_sorts.size())
    {
      file_.report(key, "actions: '" + key.Scalar() + "' has " +
                            std::to_string(atom.arguments.size()) + " parameters, expected " +
                            std::to_string(action.argument_sorts.size()) + ", of the sorts " +
                            listed(action.argument_sorts));
      return;
    }
    if (models.actions.count(atom.name) > 0)
    {
      file_.report(key, "actions: '" + atom.name + "' a second time; leave one of them");
      return;
    }
    ActionModel model = ActionModelReader(file_, description_, domain_, atom).read(key, node);
    if (domain_ != nullptr && model.cost.from)
    {
      checkDistances(action, YamlFile::entry(YamlFile::entry(node, "cost"), "distance"), model);
    }
    models.actions.emplace(atom.name, std::move(model));
  }

  /// Both ends of a distance must be components, and the map must know how far apart they are.
  void checkDistances(const ActionDeclaration& action, const YAML::Node& node,
                      const ActionModel& model)
  {
    const auto parameter =
        std::find(model.parameters.begin(), model.parameters.end(), model.cost.to);
    const std::string& to_sort =
        action.argument_sorts[static_cast<std::size_t>(parameter - model.parameters.begin())];
    const std::string& from_sort = *description_.findFluent(model.cost.from->name)->value_sort;
    const auto check = [&](const char* end, const std::string& sort) {
      for (const std::string& element : description_.findSort(sort)->elements)
      {
        if (!domain_->map().find(element))
        {
          file_.report(YamlFile::entry(node, end),
                       action.name + ", cost: distance " + end + " '" + element +
                           "' of the sort '" + sort +
                           "', which is no component of the map; expected components only");
          return false;
        }
      }
      return true;
    };
    const bool from = check("from", from_sort);
    if (check("to", to_sort) && from && !domain_->map().hasDistances())
    {
      file_.report(node,
                   action.name +
                       ", cost: the map says of no component where it is; add 'at: [x, y]' to "
                       "each, or leave out distance and per_metre_s");
    }
  }

  void requireLearned(const Models& models)
  {
    for (const Unlearned& number : unlearned(models))
    {
      file_.problems().add({file_.name(), number.line, 0},
                           number.action + ", " + number.what +
                               " is hand-written, but learned values are required; run a training "
                               "phase, or allow hand-written ones");
    }
  }

  YamlFile& file_;
  const Description& description_;
  const LowLevelDomain* domain_;
};

}  // namespace

Models parseModels(const std::string& text, const std::string& file, const Description& low_level,
                   const ModelsOptions& options)
{
  YamlFile yaml(text, file);
  return ModelsReader(yaml, low_level, nullptr).read(options);
}

Models parseModels(const std::string& text, const std::string& file, const LowLevelDomain& domain,
                   const ModelsOptions& options)
{
  YamlFile yaml(text, file);
  return ModelsReader(yaml, domain.description(), &domain).read(options);
}

Models readModels(const std::string& path, const Description& low_level,
                  const ModelsOptions& options)
{
  return parseModels(fileText(path), path, low_level, options);
}

Models readModels(const std::string& path, const LowLevelDomain& domain,
                  const ModelsOptions& options)
{
  return parseModels(fileText(path), path, domain, options);
}

std::vector<std::string> handWritten(const Models& models)
{
  std::vector<std::string> result;
  for (const Unlearned& number : unlearned(models))
  {
    result.push_back(models.file + (number.line > 0 ? ":" + std::to_string(number.line) : "") +
                     ": " + number.what + " of " + number.action);
  }
  return result;
}

}  // namespace kr3::refinement
