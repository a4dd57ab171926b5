#include "laws.hpp"

#include <algorithm>

namespace kr3::reasoner
{

Laws::Laws(const Description& description)
{
  for (const CausalLaw& law : description.causal_laws)
  {
    causal_.push_back(add(LawKind::kCausal, law.action.name, law.position));
  }
  for (const StateConstraint& rule : description.constraints)
  {
    const FluentDeclaration* fluent =
        rule.head ? description.findFluent(rule.head->atom.name) : nullptr;
    if (fluent != nullptr && fluent->kind == FluentKind::kStatic)
    {
      constraints_.push_back(kNoLaw);
    }
    else if (fluent != nullptr && fluent->kind == FluentKind::kDefined)
    {
      const std::size_t known = ofDefinition(fluent->name);
      if (known != kNoLaw)
      {
        laws_[known].positions.push_back(rule.position);
      }
      constraints_.push_back(
          known != kNoLaw ? known : add(LawKind::kDefinition, fluent->name, rule.position));
    }
    else
    {
      constraints_.push_back(
          add(LawKind::kConstraint, fluent == nullptr ? "" : fluent->name, rule.position));
    }
  }
  for (const Executability& rule : description.executabilities)
  {
    const auto* action =
        rule.actions.size() == 1 ? std::get_if<Atom>(&rule.actions.front()) : nullptr;
    executabilities_.push_back(
        action == nullptr ? kNoLaw : add(LawKind::kExecutability, action->name, rule.position));
  }
}

std::size_t Laws::add(LawKind kind, const std::string& about, const SourcePosition& position)
{
  laws_.push_back({kind, about, {position}});
  return laws_.size() - 1;
}

std::size_t Laws::ofDefinition(const std::string& fluent) const
{
  const auto found = std::find_if(laws_.begin(), laws_.end(), [&](const CitedLaw& law) {
    return law.kind == LawKind::kDefinition && law.about == fluent;
  });
  return found == laws_.end() ? kNoLaw : static_cast<std::size_t>(found - laws_.begin());
}

void Cited::insert(const Cited& other)
{
  records.insert(other.records.begin(), other.records.end());
  defaults.insert(other.defaults.begin(), other.defaults.end());
  laws.insert(other.laws.begin(), other.laws.end());
}

bool operator==(const Cited& a, const Cited& b)
{
  return a.records == b.records && a.defaults == b.defaults && a.laws == b.laws;
}

std::vector<CitedItem> itemsOf(const Cited& cited)
{
  std::vector<CitedItem> items;
  for (const std::size_t record : cited.records)
  {
    items.push_back({CitedItem::Kind::kRecord, record, ""});
  }
  for (const std::string& name : cited.defaults)
  {
    items.push_back({CitedItem::Kind::kDefault, 0, name});
  }
  for (const std::size_t law : cited.laws)
  {
    items.push_back({CitedItem::Kind::kLaw, law, ""});
  }
  return items;
}

Cited citedOf(const std::vector<CitedItem>& items)
{
  Cited cited;
  for (const CitedItem& item : items)
  {
    switch (item.kind)
    {
      case CitedItem::Kind::kRecord:
        cited.records.insert(item.number);
        break;
      case CitedItem::Kind::kDefault:
        cited.defaults.insert(item.name);
        break;
      case CitedItem::Kind::kLaw:
        cited.laws.insert(item.number);
        break;
    }
  }
  return cited;
}

}  // namespace kr3::reasoner
