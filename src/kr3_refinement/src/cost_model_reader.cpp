// ActionModelReader: what an action costs.

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "action_model_reader.hpp"

namespace kr3::refinement
{
namespace
{

using reasoner::Atom;
using reasoner::FluentDeclaration;

constexpr double kLarge = 1e9;

}  // namespace

CostModel ActionModelReader::readCost(const YAML::Node& key, const YAML::Node& node)
{
  CostModel cost;
  const std::string what = action_.name + ", cost";
  if (!node.IsDefined())
  {
    file_.report(key,
                 action_.name + ": found no 'cost', expected one with base_s and impossible_s");
    return cost;
  }
  if (!file_.checkMap(
          node, what,
          {"base_s", "per_metre_s", "distance", "impossible_s", "counts", "stddev_s", "source"}))
  {
    return cost;
  }
  for (const char* name : {"base_s", "impossible_s"})
  {
    if (!YamlFile::entry(node, name).IsDefined())
    {
      file_.report(node, what + ": found no " + name + ", expected seconds");
    }
  }
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
  readDuration(what, node, cost);
  return cost;
}

/// The seconds, and where they come from; what is not said stays as it is.
void ActionModelReader::readDuration(const std::string& what, const YAML::Node& node,
                                     CostModel& cost)
{
  cost.line = YamlFile::line(node);
  cost.base_s = file_.number(node, "base_s", cost.base_s, 0.0, kLarge);
  cost.impossible_s = file_.number(node, "impossible_s", cost.impossible_s, 0.0, kLarge);
  cost.per_metre_s = file_.number(node, "per_metre_s", cost.per_metre_s, 0.0, kLarge);
  cost.counts = readCounts(what, YamlFile::entry(node, "counts"), {"carried_out", "impossible"});
  const bool says_source =
      YamlFile::entry(node, "source").IsDefined() || YamlFile::entry(node, "counts").IsDefined();
  cost.source = says_source ? readSource(what, node, cost.counts) : ModelSource::kHandWritten;
  const YAML::Node stddev = YamlFile::entry(node, "stddev_s");
  if (stddev.IsDefined() != (cost.source == ModelSource::kLearned))
  {
    file_.report(stddev.IsDefined() ? stddev : node,
                 what + (stddev.IsDefined()
                             ? ": stddev_s of hand-written seconds; leave it out"
                             : ": learned without stddev_s, expected the standard deviation of one "
                               "duration"));
  }
  cost.stddev_s = file_.number(node, "stddev_s", 0.0, 0.0, kLarge);
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
