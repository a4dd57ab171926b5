#include "action_model_reader.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <optional>
#include <set>
#include <sstream>
#include <utility>

namespace kr3::refinement
{
namespace
{

using reasoner::Atom;
using reasoner::FluentDeclaration;
using reasoner::ObservationLaw;

constexpr double kSumTolerance = 1e-6;

}  // namespace

bool sumsToOne(const OutcomeModel& model, const reasoner::Description& description,
               const std::string& action)
{
  double total = 0.0;
  for (const auto& [label, probability] : model.probabilities)
  {
    total += probability;
  }
  bool each_law = true;
  for (const reasoner::CausalLaw& law : description.causal_laws)
  {
    double of_law = 0.0;
    bool labelled = false;
    for (const reasoner::Outcome& outcome : law.outcomes)
    {
      const auto entry = model.probabilities.find(outcome.label);
      labelled = labelled || entry != model.probabilities.end();
      of_law += entry == model.probabilities.end() ? 0.0 : entry->second;
    }
    each_law = each_law &&
               (law.action.name != action || !labelled || std::abs(of_law - 1.0) <= kSumTolerance);
  }
  return std::abs(total - 1.0) <= kSumTolerance || each_law;
}

std::optional<Atom> parsedAtom(const std::string& text)
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

ActionModelReader::ActionModelReader(YamlFile& file, const reasoner::Description& description,
                                     const LowLevelDomain* domain, Atom action)
  : file_(file), description_(description), domain_(domain), action_(std::move(action))
{
}

std::vector<std::string> ActionModelReader::labels() const
{
  std::vector<std::string> labels;
  for (const reasoner::CausalLaw& law : description_.causal_laws)
  {
    for (const reasoner::Outcome& outcome : law.outcomes)
    {
      if (law.action.name == action_.name && !outcome.label.empty() &&
          std::find(labels.begin(), labels.end(), outcome.label) == labels.end())
      {
        labels.push_back(outcome.label);
      }
    }
  }
  return labels;
}

std::vector<const ObservationLaw*> ActionModelReader::observationLaws() const
{
  std::vector<const ObservationLaw*> laws;
  for (const ObservationLaw& law : description_.observations)
  {
    if (law.action.name == action_.name)
    {
      laws.push_back(&law);
    }
  }
  return laws;
}

ActionModel ActionModelReader::read(const YAML::Node& key, const YAML::Node& node)
{
  ActionModel model;
  std::set<std::string> names;
  for (const reasoner::Term& parameter : action_.arguments)
  {
    model.parameters.push_back(parameter.name);
    if (!names.insert(parameter.name).second)
    {
      file_.report(key, action_.name + ": two parameters are named '" + parameter.name +
                            "', expected a name for each");
    }
  }
  if (!file_.checkMap(node, action_.name, {"outcomes", "observations", "cost", "classes"}))
  {
    return model;
  }
  model.outcomes =
      readOutcomes(action_.name + ", outcomes", key, YamlFile::entry(node, "outcomes"));
  readObservations(key, YamlFile::entry(node, "observations"), model);
  model.cost = readCost(key, YamlFile::entry(node, "cost"));
  readClasses(YamlFile::entry(node, "classes"), model);
  return model;
}

OutcomeModel ActionModelReader::readOutcomes(const std::string& what, const YAML::Node& key,
                                             const YAML::Node& node)
{
  OutcomeModel model;
  const std::vector<std::string> known = labels();
  if (known.empty())
  {
    if (node.IsDefined())
    {
      file_.report(node, what + ": the laws of " + action_.name +
                             " have no labelled outcomes; leave this out, or label them in the "
                             "refinement, as [reached]");
    }
    return model;
  }
  const YAML::Node place = node.IsDefined() ? node : key;
  if (node.IsDefined() &&
      !file_.checkMap(node, what, {"probabilities", "counts", "prior", "source"}))
  {
    return model;
  }
  const YAML::Node probabilities = YamlFile::entry(node, "probabilities");
  if (!probabilities.IsDefined())
  {
    file_.report(place,
                 what + ": found no probabilities, expected one for each of " + listed(known));
    return model;
  }
  if (!file_.checkMap(probabilities, what + ", probabilities", known))
  {
    return model;
  }
  model.line = YamlFile::line(place);
  bool complete = true;
  for (const std::string& label : known)
  {
    if (!YamlFile::entry(probabilities, label).IsDefined())
    {
      file_.report(probabilities, what + ": found no probability of '" + label +
                                      "', expected one for each of " + listed(known));
      complete = false;
    }
    model.probabilities[label] = file_.number(probabilities, label, 0.0, 0.0, 1.0);
  }
  if (complete)
  {
    checkSum(what, probabilities, model);
  }
  const YAML::Node counts = YamlFile::entry(node, "counts");
  model.counts = readCounts(what, counts, known);
  model.prior = readPrior(what, node, model.counts);
  model.source = readSource(what, node, model.counts);
  compareCounts(what, counts, model);
  return model;
}

void ActionModelReader::checkSum(const std::string& what, const YAML::Node& node,
                                 const OutcomeModel& model)
{
  double total = 0.0;
  for (const auto& [label, probability] : model.probabilities)
  {
    total += probability;
  }
  if (!sumsToOne(model, description_, action_.name))
  {
    file_.report(node, what + ": the probabilities sum to " + std::to_string(total) +
                           ", expected 1 (over all outcomes, or over those of each law)");
  }
}

std::vector<std::string> ActionModelReader::observedFluents() const
{
  std::vector<std::string> fluents;
  for (const ObservationLaw* law : observationLaws())
  {
    if (std::find(fluents.begin(), fluents.end(), law->fluent.name) == fluents.end())
    {
      fluents.push_back(law->fluent.name);
    }
  }
  return fluents;
}

bool ActionModelReader::tellsValue(const std::string& fluent) const
{
  const std::vector<const ObservationLaw*> laws = observationLaws();
  const FluentDeclaration* declaration = description_.findFluent(fluent);
  return std::all_of(laws.begin(), laws.end(), [&](const ObservationLaw* law) {
    return law->fluent.name != fluent ||
           (!law->value && declaration != nullptr && declaration->value_sort.has_value());
  });
}

void ActionModelReader::readObservations(const YAML::Node& key, const YAML::Node& node,
                                         ActionModel& model)
{
  const std::vector<std::string> fluents = observedFluents();
  if (node.IsDefined() && !file_.checkMap(node, action_.name + ", observations", fluents))
  {
    return;
  }
  for (const std::string& fluent : fluents)
  {
    const YAML::Node entry = YamlFile::entry(node, fluent);
    if (!entry.IsDefined())
    {
      file_.report(node.IsDefined() ? node : key,
                   action_.name + ": found no observation model of '" + fluent +
                       "', expected 'exact' or true_positive and false_positive");
      continue;
    }
    model.observations[fluent] =
        readObservation(action_.name + ", observation of " + fluent, entry, tellsValue(fluent));
  }
}

ObservationModel ActionModelReader::readObservation(const std::string& what, const YAML::Node& node,
                                                    bool tells_value)
{
  ObservationModel model;
  model.line = YamlFile::line(node);
  if (node.IsScalar())
  {
    model.exact = node.Scalar() == "exact";
    if (!model.exact)
    {
      file_.report(node, what + ": found '" + node.Scalar() + "', expected 'exact' or a map");
    }
    return model;
  }
  if (!file_.checkMap(node, what, {"true_positive", "false_positive", "counts", "prior", "source"}))
  {
    return model;
  }
  const bool has_false = YamlFile::entry(node, "false_positive").IsDefined();
  if (!YamlFile::entry(node, "true_positive").IsDefined())
  {
    file_.report(node, what + ": found no true_positive, expected a probability");
  }
  if (!tells_value && !has_false)
  {
    file_.report(node, what + ": found no false_positive, expected a probability");
  }
  if (tells_value && has_false)
  {
    file_.report(YamlFile::entry(node, "false_positive"),
                 what +
                     ": the action tells a value, which is right with true_positive and else one "
                     "of the others; leave false_positive out");
  }
  model.true_positive = file_.number(node, "true_positive", 1.0, 0.0, 1.0);
  model.false_positive = file_.number(node, "false_positive", 0.0, 0.0, 1.0);
  if (!tells_value && model.true_positive < model.false_positive)
  {
    file_.report(node,
                 what + ": true_positive " + std::to_string(model.true_positive) +
                     " is below false_positive " + std::to_string(model.false_positive) +
                     ", expected a sensor that says yes rather where it is so; exchange them");
  }
  const YAML::Node counts = YamlFile::entry(node, "counts");
  model.counts =
      readCounts(what, counts,
                 tells_value ? std::vector<std::string>{"right", "wrong"}
                             : std::vector<std::string>{"true_positive", "false_negative",
                                                        "false_positive", "true_negative"});
  model.prior = readPrior(what, node, model.counts);
  model.source = readSource(what, node, model.counts);
  if (!model.counts.empty() && tells_value)
  {
    compare(what, counts, model.true_positive, model.counts["right"],
            model.counts["right"] + model.counts["wrong"], model.prior);
  }
  else if (!model.counts.empty())
  {
    compare(what + ", true_positive", counts, model.true_positive, model.counts["true_positive"],
            model.counts["true_positive"] + model.counts["false_negative"], model.prior);
    compare(what + ", false_positive", counts, model.false_positive, model.counts["false_positive"],
            model.counts["false_positive"] + model.counts["true_negative"], model.prior);
  }
  return model;
}

}  // namespace kr3::refinement
