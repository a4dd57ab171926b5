#include "sensor_table.hpp"

#include <algorithm>

namespace kr3::refinement
{
namespace
{

constexpr int kNone = Vocabulary::kNone;

std::map<std::string, double> yesOrNo(double yes)
{
  std::map<std::string, double> told;
  if (yes > 0.0)
  {
    told["true"] = yes;
  }
  if (yes < 1.0)
  {
    told["false"] = 1.0 - yes;
  }
  return told;
}

}  // namespace

std::uint32_t ObservationNames::number(const std::string& name)
{
  const auto [entry, is_new] =
      numbers_.try_emplace(name, static_cast<std::uint32_t>(names_.size()));
  if (is_new)
  {
    names_.push_back(name);
  }
  return entry->second;
}

SensorTable::SensorTable(const Semantics& semantics, const Models& models,
                         const GroundAction& action, ObservationNames& names)
  : semantics_(semantics), laws_(semantics.observations(action)), names_(names)
{
  const std::vector<std::string> arguments = argumentNames(semantics.vocabulary(), action);
  for (const GroundObservation& law : laws_)
  {
    const std::string& fluent =
        semantics.signature().symbols()[semantics.fluents()[law.fluent].symbol].name;
    models_.push_back(&models.actions.at(action.symbol).observationOf(fluent, arguments));
    feedback_.push_back(semantics.affects(action, law.fluent));
  }
}

const std::vector<pomdp::SparseEntry>& SensorTable::row(const Values* state, bool really)
{
  std::vector<int> key{really ? 1 : 0};
  for (const GroundObservation& law : laws_)
  {
    key.push_back(state == nullptr ? kNone : (*state)[law.fluent]);
  }
  const auto [entry, is_new] = rows_.try_emplace(key);
  if (!is_new)
  {
    return entry->second;
  }
  Told joined;
  for (std::size_t law = 0; law < laws_.size(); ++law)
  {
    const Told own = told(law, key[law + 1], really);
    if (law == 0)
    {
      joined = own;
      continue;
    }
    Told longer;
    for (const auto& [first, p] : joined)
    {
      for (const auto& [second, q] : own)
      {
        longer[first + "," + second] += p * q;
      }
    }
    joined = std::move(longer);
  }
  if (laws_.empty())
  {
    joined[kNoObservation] = 1.0;
  }
  for (const auto& [name, probability] : joined)
  {
    entry->second.push_back({names_.number(name), probability});
  }
  std::sort(entry->second.begin(), entry->second.end(),
            [](const auto& a, const auto& b) { return a.index < b.index; });
  return entry->second;
}

SensorTable::Told SensorTable::told(std::size_t law, int value, bool really) const
{
  const GroundObservation& observed = laws_[law];
  const ObservationModel& model = *models_[law];
  const bool informative = really || feedback_[law];
  if (observed.value != kNone)
  {
    const bool is_so = informative && value == observed.value;
    return yesOrNo(is_so ? model.true_positive : model.false_positive);
  }
  const Symbol& symbol =
      semantics_.signature().symbols()[semantics_.fluents()[observed.fluent].symbol];
  if (!symbol.boolean)
  {
    return toldValue(law, value, informative);
  }
  if (!informative || value == kNone)
  {
    return yesOrNo(0.5);
  }
  return yesOrNo(value == semantics_.signature().trueValue() ? model.true_positive
                                                             : model.false_positive);
}

/// A sensor for values may be wrong by any value that the fluent has in the whole domain; those
/// outside the zoom are told as one.
SensorTable::Told SensorTable::toldValue(std::size_t law, int value, bool informative) const
{
  const PhysicalFluent& fluent = semantics_.fluents()[laws_[law].fluent];
  const ConstantSet& all = *semantics_.signature().symbols()[fluent.symbol].full_value_sort;
  const auto count = static_cast<double>(all.elements().size());
  const double right = count < 2.0 ? 1.0 : models_[law]->true_positive;
  const double wrong = count < 2.0 ? 0.0 : (1.0 - right) / (count - 1.0);
  const bool inside = all.contains(value) && value != kNone;
  Told told;
  double outside = 1.0;
  for (const int candidate : fluent.values)
  {
    if (!all.contains(candidate))
    {
      continue;  // `elsewhere` is what the robot calls the values outside
    }
    const double probability =
        informative ? (inside && candidate == value ? right : wrong) : 1.0 / count;
    if (probability > 0.0)
    {
      told[semantics_.vocabulary().name(candidate)] = probability;
      outside -= probability;
    }
  }
  if (outside > 1e-12)
  {
    told[kOutside] = outside;
  }
  return told;
}

}  // namespace kr3::refinement
