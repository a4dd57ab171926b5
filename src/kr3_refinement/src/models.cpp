#include "kr3_refinement/models.hpp"

#include <algorithm>
#include <optional>
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
    if (file_.checkMap(root, "the models", {"actions", "rewards", "discount", "threshold"}))
    {
      readNumbers(root, models);
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
    ActionModel model = ActionModelReader(file_, description_, atom).read(key, node);
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
    for (const auto& [name, action] : models.actions)
    {
      const std::string mend =
          " is hand-written, but learned values are required; run a training phase, or allow "
          "hand-written ones";
      if (action.outcomes.line > 0 && action.outcomes.source == ModelSource::kHandWritten)
      {
        file_.problems().add({file_.name(), action.outcomes.line, 0}, name + ", outcomes" + mend);
      }
      for (const auto& [fluent, model] : action.observations)
      {
        if (!model.exact && model.source == ModelSource::kHandWritten)
        {
          file_.problems().add({file_.name(), model.line, 0},
                               name + ", observation of " + fluent + mend);
        }
      }
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
  const auto at = [&](int line) {
    return models.file + (line > 0 ? ":" + std::to_string(line) : "") + ": ";
  };
  for (const auto& [name, action] : models.actions)
  {
    if (!action.outcomes.probabilities.empty() &&
        action.outcomes.source == ModelSource::kHandWritten)
    {
      result.push_back(at(action.outcomes.line) + "outcomes of " + name);
    }
    for (const auto& [fluent, model] : action.observations)
    {
      if (!model.exact && model.source == ModelSource::kHandWritten)
      {
        result.push_back(at(model.line) + name + " observes " + fluent);
      }
    }
  }
  return result;
}

}  // namespace kr3::refinement
