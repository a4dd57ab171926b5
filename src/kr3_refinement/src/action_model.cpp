// Which numbers hold for a ground action, and where they come from.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include <kr3_common/error.hpp>

#include "kr3_refinement/models.hpp"

namespace kr3::refinement
{
namespace
{

/// The most specific class with some arguments for which `get` finds something.
template <typename T, typename Get>
const T* found(const std::vector<ClassModel>& classes, const std::vector<std::string>& arguments,
               const Get& get)
{
  const ClassModel* best = nullptr;
  const T* result = nullptr;
  for (const ClassModel& model : classes)
  {
    const T* const candidate = model.contains(arguments) ? get(model) : nullptr;
    if (candidate != nullptr && (best == nullptr || model.isWithin(*best)))
    {
      best = &model;
      result = candidate;
    }
  }
  return result;
}

std::string placed(const Models& models, int line)
{
  return line > 0 ? " (" + models.file + ":" + std::to_string(line) + ")" : "";
}

std::string number(double value)
{
  char text[32];
  std::snprintf(text, sizeof(text), "%.3g", value);
  return text;
}

std::uint64_t sum(const std::map<std::string, std::uint64_t>& counts)
{
  return std::accumulate(
      counts.begin(), counts.end(), std::uint64_t{0},
      [](std::uint64_t total, const auto& entry) { return total + entry.second; });
}

std::string source(ModelSource source, const std::map<std::string, std::uint64_t>& counts)
{
  return source == ModelSource::kLearned ? "learned, " + std::to_string(sum(counts)) + " samples"
                                         : "hand-written";
}

std::string costSource(const CostModel& cost)
{
  std::string text = number(cost.base_s) + " s";
  text += cost.from ? " + " + number(cost.per_metre_s) + " s/m, metres from the map" : "";
  const bool learned = cost.source == ModelSource::kLearned;
  text += ", " + number(cost.impossible_s) + " s where impossible; seconds ";
  if (!learned)
  {
    return text + "hand-written";
  }
  const auto count = [&](const char* name) {
    const auto entry = cost.counts.find(name);
    return entry == cost.counts.end() ? std::uint64_t{0} : entry->second;
  };
  const std::uint64_t carried_out = count("carried_out");
  const std::uint64_t impossible = count("impossible");
  text += "learned, " + std::to_string(carried_out) + " samples";
  text += carried_out > 0
              ? ", standard error " +
                    number(cost.stddev_s / std::sqrt(static_cast<double>(carried_out))) + " s"
              : "";
  return text + (impossible > 0 ? ", " + std::to_string(impossible) + " where impossible"
                                : ", where impossible hand-written");
}

}  // namespace

bool ClassModel::contains(const std::vector<std::string>& arguments) const
{
  return std::all_of(members.begin(), members.end(), [&](const auto& entry) {
    return entry.first < arguments.size() && entry.second.count(arguments[entry.first]) > 0;
  });
}

bool ClassModel::isWithin(const ClassModel& other) const
{
  return std::all_of(other.members.begin(), other.members.end(), [&](const auto& entry) {
    const auto own = members.find(entry.first);
    return own != members.end() && std::includes(entry.second.begin(), entry.second.end(),
                                                 own->second.begin(), own->second.end());
  });
}

const OutcomeModel& ActionModel::outcomesOf(const std::vector<std::string>& arguments) const
{
  const auto* const model = found<OutcomeModel>(classes, arguments, [](const ClassModel& of_class) {
    return of_class.outcomes ? &*of_class.outcomes : nullptr;
  });
  return model == nullptr ? outcomes : *model;
}

const CostModel& ActionModel::costOf(const std::vector<std::string>& arguments) const
{
  const auto* const model = found<CostModel>(classes, arguments, [](const ClassModel& of_class) {
    return of_class.cost ? &*of_class.cost : nullptr;
  });
  return model == nullptr ? cost : *model;
}

const ObservationModel& ActionModel::observationOf(const std::string& fluent,
                                                   const std::vector<std::string>& arguments) const
{
  const auto* const model =
      found<ObservationModel>(classes, arguments, [&](const ClassModel& of_class) {
        const auto entry = of_class.observations.find(fluent);
        return entry == of_class.observations.end() ? nullptr : &entry->second;
      });
  const auto general = observations.find(fluent);
  if (model == nullptr && general == observations.end())
  {
    throw InvalidArgument("the models have no numbers for observing '" + fluent + "'");
  }
  return model == nullptr ? general->second : *model;
}

std::vector<std::string> sources(const Models& models, const std::string& action,
                                 const std::vector<std::string>& arguments)
{
  const auto entry = models.actions.find(action);
  if (entry == models.actions.end())
  {
    throw NotFound("the models have no action '" + action + "'");
  }
  std::vector<std::string> lines;
  const OutcomeModel& outcomes = entry->second.outcomesOf(arguments);
  if (!outcomes.probabilities.empty())
  {
    std::string text = "outcomes:";
    for (const auto& [label, probability] : outcomes.probabilities)
    {
      text += (text.back() == ':' ? " " : ", ") + label + " " + number(probability);
    }
    lines.push_back(text + "; " + source(outcomes.source, outcomes.counts) +
                    placed(models, outcomes.line));
  }
  for (const auto& [fluent, general] : entry->second.observations)
  {
    const ObservationModel& model = entry->second.observationOf(fluent, arguments);
    lines.push_back("observation of " + fluent + ": " +
                    (model.exact ? "exact"
                                 : "true positives " + number(model.true_positive) +
                                       (model.false_positive > 0.0
                                            ? ", false positives " + number(model.false_positive)
                                            : std::string()) +
                                       "; " + source(model.source, model.counts)) +
                    placed(models, model.line));
  }
  const CostModel& cost = entry->second.costOf(arguments);
  lines.push_back("cost: " + costSource(cost) + placed(models, cost.line));
  return lines;
}

}  // namespace kr3::refinement
