#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "slice_cut.hpp"

// What slices keep of the beginning of a history that was progressed.
namespace kr3::reasoner
{

namespace
{

/// The price of a value at each level, with the retractions; {-1, -1}: impossible.
using PriceList = std::array<std::pair<int, int>, kNumAssumables>;

std::pair<int, int> priceOf(const BeginningRow& row, const BeginningComponent& component)
{
  Price price;
  for (const std::size_t i : row.explanations.front())
  {
    const CarriedAssumption& assumption = component.assumptions[i];
    price.add(assumption.price, assumption.is_retraction);
  }
  return {price.retractions, price.assumptions};
}

}  // namespace

bool Slicer::Cut::isRelevant(const BeginningComponent& component) const
{
  return std::any_of(component.fluents.begin(), component.fluents.end(),
                     [this](const OpenFluent& fluent) {
    return relevance_.isRelevant(rules_.ground(fluent.atom, false));
  });
}

/// Values of a fluent with the same prices are alike; those of the largest class need no names as
/// long as no other fluent depends on them.
void Slicer::Cut::keepBeginning()
{
  std::map<std::string, std::map<std::string, PriceList>> prices;  // by fluent, by value
  std::map<std::string, std::string> sorts;
  for (std::size_t l = 0; beginning_ != nullptr && l < kNumAssumables; ++l)
  {
    for (const BeginningComponent& component : beginning_->levels[l]->components)
    {
      if (!isRelevant(component))
      {
        continue;
      }
      for (std::size_t f = 0; f < component.fluents.size(); ++f)
      {
        const OpenFluent& fluent = component.fluents[f];
        const FluentDeclaration& declared = *rules_.description().findFluent(fluent.atom.name);
        if (!declared.value_sort)
        {
          continue;
        }
        if (component.fluents.size() > 1)
        {
          for (const std::string& value : fluent.values)
          {
            need(rules_.constant(value));
          }
          continue;
        }
        const std::string name = toString(fluent.atom);
        auto& of_values = prices[name];
        if (sorts.emplace(name, *declared.value_sort).second)
        {
          PriceList never;
          never.fill({-1, -1});
          for (const ConstantId element : rules_.elements(rules_.sortIndex(*declared.value_sort)))
          {
            of_values.emplace(rules_.name(element), never);
          }
        }
        for (const BeginningRow& row : component.rows)
        {
          of_values.at(fluent.values[row.values[f]])[l] = priceOf(row, component);
        }
      }
    }
  }
  for (const auto& [fluent, of_values] : prices)
  {
    std::map<PriceList, std::vector<ConstantId>> classes;
    for (const auto& [value, list] : of_values)
    {
      classes[list].push_back(rules_.constant(value));
    }
    const auto largest = std::max_element(
        classes.begin(), classes.end(),
        [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); });
    for (auto place = classes.begin(); place != classes.end(); ++place)
    {
      if (place != largest)
      {
        needAll(place->second);
      }
    }
  }
}

std::shared_ptr<const Beginning> Slicer::Cut::beginning() const
{
  if (beginning_ == nullptr)
  {
    return nullptr;
  }
  auto part = std::make_shared<Beginning>();
  part->first_step = beginning_->first_step;
  part->num_records = beginning_->num_records;
  part->uncertain = beginning_->uncertain;
  part->retractable = beginning_->retractable;
  for (std::size_t l = 0; l < kNumAssumables; ++l)
  {
    auto level = std::make_shared<BeginningLevel>();
    level->consistent = beginning_->levels[l]->consistent;
    for (const BeginningComponent& whole : beginning_->levels[l]->components)
    {
      if (!isRelevant(whole))
      {
        continue;
      }
      level->components.push_back(whole);
      auto& rows = level->components.back().rows;
      rows.erase(std::remove_if(
                     rows.begin(), rows.end(),
                     [&](const BeginningRow& row) {
        for (std::size_t f = 0; f < whole.fluents.size(); ++f)
        {
          if (!keeps(rules_.constant(whole.fluents[f].values[row.values[f]])))
          {
            return true;
          }
        }
        return false;
                     }),
                 rows.end());
    }
    part->levels[l] = std::move(level);
  }
  return part;
}

}  // namespace kr3::reasoner
