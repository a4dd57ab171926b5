#include "preferences.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <unordered_map>

#include "components.hpp"
#include "diagnostics.hpp"

namespace kr3::reasoner
{

void checkPreferences(const Description& description, std::vector<Diagnostic>& problems)
{
  std::unordered_map<std::string, std::size_t> index;
  std::vector<std::size_t> arity;
  std::vector<std::string> names;
  for (const Default& rule : description.defaults)
  {
    if (!index.emplace(rule.name.name, names.size()).second)
    {
      problems.push_back({rule.position, "the default '" + rule.name.name + "' is declared twice"});
      continue;
    }
    arity.push_back(rule.name.arguments.size());
    names.push_back(rule.name.name);
  }
  constexpr std::size_t kEnough = 100;
  const auto isKnown = [&](const Atom& atom) {
    const auto found = index.find(atom.name);
    if (found == index.end())
    {
      problems.push_back(
          {atom.position, "unknown default '" + atom.name + "'" +
                              (problems.size() < kEnough ? suggestion(atom.name, names) : "")});
      return false;
    }
    if (arity[found->second] != atom.arguments.size())
    {
      problems.push_back({atom.position, "found " + std::to_string(atom.arguments.size()) +
                                             " arguments of the default " + atom.name +
                                             ", expected " + std::to_string(arity[found->second])});
    }
    return true;
  };
  std::vector<std::vector<std::size_t>> worse(names.size());
  std::vector<const Preference*> known;
  for (const Preference& preference : description.preferences)
  {
    const bool better_known = isKnown(preference.better);
    if (isKnown(preference.worse) && better_known)
    {
      worse[index.at(preference.better.name)].push_back(index.at(preference.worse.name));
      known.push_back(&preference);
    }
  }
  const Components components(worse);
  for (const Preference* preference : known)
  {
    if (components.together(index.at(preference->better.name), index.at(preference->worse.name)))
    {
      problems.push_back({preference->position, "the preference of " + preference->better.name +
                                                    " over " + preference->worse.name +
                                                    " closes a cycle, expected an order"});
    }
  }
}

}  // namespace kr3::reasoner
