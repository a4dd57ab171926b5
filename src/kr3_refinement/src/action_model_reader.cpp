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

constexpr double kLarge = 1e9;
constexpr double kSumTolerance = 1e-6;
/// Probabilities in a file are rounded to two digits after the point, or better.
constexpr double kRounding = 0.0051;

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
                                     Atom action)
  : file_(file), description_(description), action_(std::move(action))
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
  if (!file_.checkMap(node, action_.name, {"outcomes", "observations", "cost"}))
  {
    return model;
  }
  readOutcomes(key, YamlFile::entry(node, "outcomes"), model);
  readObservations(key, YamlFile::entry(node, "observations"), model);
  readCost(key, YamlFile::entry(node, "cost"), model.cost);
  return model;
}

ModelSource ActionModelReader::readSource(const std::string& what, const YAML::Node& node,
                                          const Counts& counts)
{
  const YAML::Node source = YamlFile::entry(node, "source");
  const std::string text = source.IsDefined() && source.IsScalar() ? source.Scalar() : "";
  if (text != "learned" && text != "hand-written")
  {
    file_.report(source.IsDefined() ? source : node,
                 what + ": source " + YamlFile::shown(source) +
                     ", expected 'learned' or 'hand-written'" +
                     suggestion(text, {"learned", "hand-written"}));
  }
  const bool any =
      std::any_of(counts.begin(), counts.end(), [](const auto& entry) { return entry.second > 0; });
  if (text == "learned" && !any)
  {
    file_.report(node, what +
                           ": learned without counts; give the sample sizes, or say 'source: "
                           "hand-written'");
  }
  if (text == "hand-written" && any)
  {
    file_.report(source, what +
                             ": hand-written, but there are counts; say 'source: learned', or "
                             "leave them out");
  }
  return text == "learned" ? ModelSource::kLearned : ModelSource::kHandWritten;
}

ActionModelReader::Counts ActionModelReader::readCounts(const std::string& what,
                                                        const YAML::Node& node,
                                                        const std::vector<std::string>& keys)
{
  Counts counts;
  if (!node.IsDefined() || !file_.checkMap(node, what + ", counts", keys))
  {
    return counts;
  }
  for (const std::string& key : keys)
  {
    const YAML::Node entry = YamlFile::entry(node, key);
    if (!entry.IsDefined())
    {
      file_.report(node, what + ": found no count of '" + key + "', expected one for each of " +
                             listed(keys));
      continue;
    }
    counts[key] = file_.count(entry, what + ", counts, " + key).value_or(0);
  }
  return counts;
}

void ActionModelReader::compare(const std::string& what, const YAML::Node& node, double probability,
                                std::uint64_t count, std::uint64_t total)
{
  // Between the relative frequency and Laplace's rule, whatever prior was taken.
  const auto n = static_cast<double>(total);
  const auto k = static_cast<double>(count);
  const double least = std::min(k / std::max(n, 1.0), k / (n + 2.0)) - kRounding;
  const double most = std::max(k / std::max(n, 1.0), (k + 1.0) / (n + 2.0)) + kRounding;
  if (total > 0 && (probability < least || probability > most))
  {
    std::ostringstream message;
    message << what << ": probability " << probability << " contradicts its counts, " << count
            << " of " << total << "; expected about " << (k + 0.5) / (n + 1.0);
    file_.report(node, message.str());
  }
}

void ActionModelReader::readOutcomes(const YAML::Node& key, const YAML::Node& node,
                                     ActionModel& model)
{
  const std::string what = action_.name + ", outcomes";
  const std::vector<std::string> known = labels();
  if (known.empty())
  {
    if (node.IsDefined())
    {
      file_.report(node, what + ": the laws of " + action_.name +
                             " have no labelled outcomes; leave this out, or label them in the "
                             "refinement, as [reached]");
    }
    return;
  }
  const YAML::Node place = node.IsDefined() ? node : key;
  if (node.IsDefined() && !file_.checkMap(node, what, {"probabilities", "counts", "source"}))
  {
    return;
  }
  const YAML::Node probabilities = YamlFile::entry(node, "probabilities");
  if (!probabilities.IsDefined())
  {
    file_.report(place,
                 what + ": found no probabilities, expected one for each of " + listed(known));
    return;
  }
  if (!file_.checkMap(probabilities, what + ", probabilities", known))
  {
    return;
  }
  model.outcomes.line = YamlFile::line(place);
  bool complete = true;
  for (const std::string& label : known)
  {
    if (!YamlFile::entry(probabilities, label).IsDefined())
    {
      file_.report(probabilities, what + ": found no probability of '" + label +
                                      "', expected one for each of " + listed(known));
      complete = false;
    }
    model.outcomes.probabilities[label] = file_.number(probabilities, label, 0.0, 0.0, 1.0);
  }
  if (complete)
  {
    checkSum(probabilities, model.outcomes);
  }
  const YAML::Node counts = YamlFile::entry(node, "counts");
  model.outcomes.counts = readCounts(what, counts, known);
  model.outcomes.source = readSource(what, node, model.outcomes.counts);
  std::uint64_t total = 0;
  for (const auto& [label, count] : model.outcomes.counts)
  {
    total += count;
  }
  for (const auto& [label, count] : model.outcomes.counts)
  {
    compare(what + ", " + label, counts, model.outcomes.probabilities[label], count, total);
  }
}

void ActionModelReader::checkSum(const YAML::Node& node, const OutcomeModel& model)
{
  double total = 0.0;
  for (const auto& [label, probability] : model.probabilities)
  {
    total += probability;
  }
  if (!sumsToOne(model, description_, action_.name))
  {
    file_.report(node, action_.name + ", outcomes: the probabilities sum to " +
                           std::to_string(total) +
                           ", expected 1 (over all outcomes, or over those of each law)");
  }
}

void ActionModelReader::readObservations(const YAML::Node& key, const YAML::Node& node,
                                         ActionModel& model)
{
  const std::vector<const ObservationLaw*> laws = observationLaws();
  std::vector<std::string> fluents;
  for (const ObservationLaw* law : laws)
  {
    if (std::find(fluents.begin(), fluents.end(), law->fluent.name) == fluents.end())
    {
      fluents.push_back(law->fluent.name);
    }
  }
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
    const FluentDeclaration* declaration = description_.findFluent(fluent);
    const bool tells_value = std::all_of(laws.begin(), laws.end(), [&](const ObservationLaw* law) {
      return law->fluent.name != fluent ||
             (!law->value && declaration != nullptr && declaration->value_sort.has_value());
    });
    model.observations[fluent] =
        readObservation(action_.name + ", observation of " + fluent, entry, tells_value);
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
  if (!file_.checkMap(node, what, {"true_positive", "false_positive", "counts", "source"}))
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
  model.source = readSource(what, node, model.counts);
  if (!model.counts.empty() && tells_value)
  {
    compare(what, counts, model.true_positive, model.counts["right"],
            model.counts["right"] + model.counts["wrong"]);
  }
  else if (!model.counts.empty())
  {
    compare(what + ", true_positive", counts, model.true_positive, model.counts["true_positive"],
            model.counts["true_positive"] + model.counts["false_negative"]);
    compare(what + ", false_positive", counts, model.false_positive, model.counts["false_positive"],
            model.counts["false_positive"] + model.counts["true_negative"]);
  }
  return model;
}

void ActionModelReader::readCost(const YAML::Node& key, const YAML::Node& node, CostModel& cost)
{
  const std::string what = action_.name + ", cost";
  if (!node.IsDefined())
  {
    file_.report(key,
                 action_.name + ": found no 'cost', expected one with base_s and impossible_s");
    return;
  }
  if (!file_.checkMap(node, what, {"base_s", "per_metre_s", "distance", "impossible_s"}))
  {
    return;
  }
  for (const char* name : {"base_s", "impossible_s"})
  {
    if (!YamlFile::entry(node, name).IsDefined())
    {
      file_.report(node, what + ": found no " + name + ", expected seconds");
    }
  }
  cost.base_s = file_.number(node, "base_s", cost.base_s, 0.0, kLarge);
  cost.impossible_s = file_.number(node, "impossible_s", cost.impossible_s, 0.0, kLarge);
  cost.per_metre_s = file_.number(node, "per_metre_s", cost.per_metre_s, 0.0, kLarge);
  const YAML::Node distance = YamlFile::entry(node, "distance");
  if (distance.IsDefined() != YamlFile::entry(node, "per_metre_s").IsDefined())
  {
    file_.report(node, what +
                           ": per_metre_s and distance go together; add the other, as "
                           "'distance: {from: loc(R), to: C}', or leave both out");
  }
  if (distance.IsDefined() && file_.checkMap(distance, what + ", distance", {"from", "to"}))
  {
    readDistance(distance, cost);
  }
}

void ActionModelReader::readDistance(const YAML::Node& node, CostModel& cost)
{
  const std::string what = action_.name + ", cost";
  std::vector<std::string> parameters;
  for (const reasoner::Term& parameter : action_.arguments)
  {
    parameters.push_back(parameter.name);
  }
  const auto is_parameter = [&](const std::string& name) {
    return std::find(parameters.begin(), parameters.end(), name) != parameters.end();
  };
  const YAML::Node from = YamlFile::entry(node, "from");
  const YAML::Node to = YamlFile::entry(node, "to");
  const std::optional<Atom> fluent =
      from.IsDefined() && from.IsScalar() ? parsedAtom(from.Scalar()) : std::nullopt;
  const FluentDeclaration* declaration = fluent ? description_.findFluent(fluent->name) : nullptr;
  const bool over_parameters =
      declaration != nullptr && declaration->argument_sorts.size() == fluent->arguments.size() &&
      std::all_of(fluent->arguments.begin(), fluent->arguments.end(),
                  [&](const reasoner::Term& term) { return is_parameter(term.name); });
  const bool valued = declaration != nullptr && declaration->value_sort &&
                      declaration->kind == reasoner::FluentKind::kInertial;
  if (!over_parameters)
  {
    std::vector<std::string> fluents;
    for (const FluentDeclaration& candidate : description_.fluents)
    {
      fluents.push_back(candidate.name);
    }
    file_.report(from.IsDefined() ? from : node,
                 what + ": distance from " + YamlFile::shown(from) +
                     ", expected a fluent over the action's parameters " + listed(parameters) +
                     (declaration == nullptr && fluent ? suggestion(fluent->name, fluents) : ""));
  }
  else if (!valued)
  {
    file_.report(from, what + ": distance from '" + from.Scalar() +
                           "', which has no component as its value; expected an inertial fluent "
                           "with values, as where the robot is");
  }
  const bool good_end = to.IsDefined() && to.IsScalar() && is_parameter(to.Scalar());
  if (!good_end)
  {
    file_.report(to.IsDefined() ? to : node, what + ": distance to " + YamlFile::shown(to) +
                                                 ", expected one of the action's parameters " +
                                                 listed(parameters));
    return;
  }
  cost.from = over_parameters && valued ? fluent : std::nullopt;
  cost.to = to.Scalar();
}

}  // namespace kr3::refinement
