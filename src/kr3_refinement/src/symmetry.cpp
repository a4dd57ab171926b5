#include "symmetry.hpp"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <optional>
#include <set>

#include <kr3_reasoner/language.hpp>

namespace kr3::refinement
{
namespace
{

constexpr int kRounds = 4;  // of telling components apart by their neighbours

void addWords(const std::string& text, std::set<std::string>& words)
{
  std::string word;
  for (const char c : text + " ")
  {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_')
    {
      word += c;
    }
    else if (!word.empty())
    {
      words.insert(word);
      word.clear();
    }
  }
}

/// Every word of the laws and facts, and no word of declarations.
std::set<std::string> namedIn(const reasoner::Description& description)
{
  reasoner::Description laws = description;
  laws.sorts.clear();
  laws.defaults.clear();
  laws.preferences.clear();
  laws.magnifications.clear();
  std::set<std::string> words;
  addWords(reasoner::toString(laws), words);
  return words;
}

/// What each component looks like from its neighbours: those of its own whole, and of others.
std::vector<std::string> looks(const ComponentMap& map)
{
  std::vector<std::string> looks(map.size());
  for (int round = 0; round < kRounds; ++round)
  {
    std::map<std::string, std::size_t> number;
    for (const std::string& look : looks)
    {
      number.emplace(look, 0);
    }
    std::size_t next = 0;
    for (auto& [look, index] : number)
    {
      index = next++;
    }
    std::vector<std::string> better(map.size());
    for (std::size_t i = 0; i < map.size(); ++i)
    {
      std::vector<std::string> around;
      for (const std::size_t j : map.neighbors(i))
      {
        const bool own = map.components()[i].part_of == map.components()[j].part_of;
        around.push_back((own ? "own" : "other") + std::to_string(number.at(looks[j])));
      }
      std::sort(around.begin(), around.end());
      better[i] = std::to_string(number.at(looks[i]));
      for (const std::string& neighbour : around)
      {
        better[i] += " " + neighbour;
      }
    }
    looks = std::move(better);
  }
  return looks;
}

}  // namespace

Symmetry::Symmetry(const LowLevelDomain& domain)
{
  std::set<std::string> named = namedIn(domain.highLevel());
  const std::set<std::string> named_below = namedIn(domain.refinement());
  named.insert(named_below.begin(), named_below.end());
  for (const std::string& fact : domain.map().facts())
  {
    addWords(fact, named);
  }
  const std::vector<std::string> component_looks = looks(domain.map());
  std::map<std::string, std::set<std::string>> sorts;
  for (const reasoner::Sort& sort : domain.highLevel().sorts)
  {
    for (const std::string& element : sort.elements)
    {
      sorts[element].insert(sort.name);
    }
  }
  for (const auto& [constant, in] : sorts)
  {
    std::string kind;
    for (const std::string& sort : in)
    {
      kind += sort + " ";
    }
    bool has_name = named.count(constant) > 0;
    std::vector<std::string> parts;
    for (const std::string& component : domain.components(constant))
    {
      has_name = has_name || named.count(component) > 0;
      const std::optional<std::size_t> index = domain.map().find(component);
      parts.push_back(index ? component_looks[*index] : "");
    }
    std::sort(parts.begin(), parts.end());
    for (const std::string& part : parts)
    {
      kind += "(" + part + ")";
    }
    kinds_.emplace(constant, has_name ? "named " + constant : kind);
  }
}

std::string Symmetry::pattern(const std::vector<std::string>& constants) const
{
  std::string result;
  for (const std::string& constant : constants)
  {
    const auto first = std::find(constants.begin(), constants.end(), constant);
    result += kind(constant) + "#" + std::to_string(first - constants.begin()) + ";";
  }
  return result;
}

}  // namespace kr3::refinement
