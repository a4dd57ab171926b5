#include "symbols.hpp"

#include <algorithm>

namespace kr3::reasoner
{

namespace
{

template <typename Declaration>
const Declaration* find(const std::unordered_map<std::string_view, const Declaration*>& index,
                        const std::string& name)
{
  const auto found = index.find(name);
  return found == index.end() ? nullptr : found->second;
}

template <typename Declaration>
void addNames(const std::vector<Declaration>& declarations, std::vector<std::string>& names)
{
  for (const Declaration& declaration : declarations)
  {
    names.push_back(declaration.name);
  }
}

}  // namespace

Symbols::Symbols(const Description& description) : description_(description)
{
  for (const Sort& sort : description.sorts)
  {
    sorts_.emplace(sort.name, &sort);
  }
  for (const FluentDeclaration& fluent : description.fluents)
  {
    fluents_.emplace(fluent.name, &fluent);
  }
  for (const ActionDeclaration& action : description.actions)
  {
    actions_.emplace(action.name, &action);
  }
}

const Sort* Symbols::sort(const std::string& name) const
{
  return find(sorts_, name);
}

const FluentDeclaration* Symbols::fluent(const std::string& name) const
{
  return find(fluents_, name);
}

const ActionDeclaration* Symbols::action(const std::string& name) const
{
  return find(actions_, name);
}

bool Symbols::hasElement(const Sort& sort, const std::string& element) const
{
  auto [place, fresh] = elements_.try_emplace(&sort);
  if (fresh)
  {
    place->second.insert(sort.elements.begin(), sort.elements.end());
  }
  return place->second.count(element) > 0;
}

bool Symbols::haveCommonElement(std::vector<std::string> sorts) const
{
  std::sort(sorts.begin(), sorts.end());
  sorts.erase(std::unique(sorts.begin(), sorts.end()), sorts.end());
  if (sorts.size() < 2)
  {
    return true;
  }
  const auto [place, fresh] = common_.try_emplace(sorts, true);
  if (!fresh)
  {
    return place->second;
  }
  std::vector<const Sort*> found;
  for (const std::string& name : sorts)
  {
    found.push_back(sort(name));
    if (found.back() == nullptr || found.back()->elements.empty())
    {
      return true;
    }
  }
  const auto smallest = std::min_element(
      found.begin(), found.end(),
      [](const Sort* a, const Sort* b) { return a->elements.size() < b->elements.size(); });
  place->second = std::any_of((*smallest)->elements.begin(), (*smallest)->elements.end(),
                              [&](const std::string& element) {
    return std::all_of(found.begin(), found.end(),
                       [&](const Sort* other) { return hasElement(*other, element); });
  });
  return place->second;
}

std::vector<std::string> Symbols::sortNames() const
{
  std::vector<std::string> names;
  addNames(description_.sorts, names);
  return names;
}

std::vector<std::string> Symbols::fluentAndSortNames() const
{
  std::vector<std::string> names = sortNames();
  addNames(description_.fluents, names);
  return names;
}

std::vector<std::string> Symbols::actionNames() const
{
  std::vector<std::string> names;
  addNames(description_.actions, names);
  return names;
}

}  // namespace kr3::reasoner
