#include "kr3_refinement/low_level_files.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <sstream>
#include <vector>

#include "yaml_file.hpp"

namespace kr3::refinement
{
namespace
{

using reasoner::Description;

/// The text between the first two of some quotation marks behind `before`.
std::optional<std::string> quotedBehind(const std::string& before, const std::string& line)
{
  const std::size_t found = line.find(before + "'");
  if (found == std::string::npos)
  {
    return std::nullopt;
  }
  const std::size_t begin = found + before.size() + 1;
  return line.substr(begin, line.find('\'', begin) - begin);
}

/// The fluent that a name of the theory of observations is about.
std::optional<std::string> observedFluent(const std::string& name)
{
  for (const std::string prefix : {"tested_", "observed_", "found_", "may_discover_", "failure_"})
  {
    if (name.rfind(prefix, 0) == 0 && name.size() > prefix.size())
    {
      return name.substr(prefix.size());
    }
  }
  return std::nullopt;
}

std::string wayOut(const std::string& line, const std::string& text, const Description& high_level)
{
  if (const auto name = quotedBehind("unknown fluent, static or sort ", line))
  {
    const std::optional<std::string> fluent = observedFluent(*name);
    const bool declared = fluent && (high_level.findFluent(*fluent) != nullptr ||
                                     text.find(" " + *fluent + "(") != std::string::npos);
    return declared ? "; it belongs to the theory of observations, which is made from the "
                      "refinement: POMDPs keep a belief about '" +
                          *fluent +
                          "' in its place, so leave the condition out (the belief decides), or "
                          "declare 'knowledge' and 'defined' fluents of your own"
                    : "";
  }
  if (const auto constant = quotedBehind("found ", line))
  {
    for (const reasoner::Sort& sort : high_level.sorts)
    {
      const auto magnified = text.find("magnify " + sort.name + " into ");
      const bool is_whole =
          std::find(sort.elements.begin(), sort.elements.end(), *constant) != sort.elements.end();
      if (is_whole && magnified != std::string::npos &&
          line.find("expected an element of the sort") != std::string::npos)
      {
        std::istringstream words(text.substr(magnified));
        std::string word;
        for (int i = 0; i < 6; ++i)
        {
          words >> word;  // magnify COARSE into FINE by STATIC.
        }
        word = word.substr(0, word.find('.'));
        return "; '" + *constant +
               "' is a whole, and here a component is meant: write a variable, "
               "as X, and add '" +
               word + "(X) = " + *constant + "' to the conditions";
      }
    }
  }
  return "";
}

}  // namespace

Description parseRefinementText(const std::string& text, const std::string& file,
                                const Description& high_level)
{
  try
  {
    return reasoner::parseRefinement(text, file, high_level);
  }
  catch (const InvalidArgument& error)
  {
    std::istringstream lines(error.what());
    std::string told;
    for (std::string line; std::getline(lines, line);)
    {
      told += (told.empty() ? "" : "\n") + line + wayOut(line, text, high_level);
    }
    throw InvalidArgument(told);
  }
}

Description readRefinementFile(const std::string& path, const Description& high_level)
{
  return parseRefinementText(fileText(path), path, high_level);
}

Description namesOfLowLevel(const Description& high_level, const Description& refinement,
                            const ComponentMap& map)
{
  Description result = high_level;
  std::map<std::string, std::string> fine;
  for (const reasoner::Magnification& magnification : refinement.magnifications)
  {
    fine.emplace(magnification.coarse, magnification.fine);
    const reasoner::Sort* coarse = high_level.findSort(magnification.coarse);
    reasoner::Sort sort{magnification.fine, {}, {}, magnification.position};
    for (const Component& component : map.components())
    {
      if (coarse != nullptr && std::find(coarse->elements.begin(), coarse->elements.end(),
                                         component.part_of) != coarse->elements.end())
      {
        sort.elements.push_back(component.name);
      }
    }
    if (result.findSort(sort.name) == nullptr)
    {
      result.sorts.push_back(std::move(sort));
    }
  }
  const auto replace = [&](std::string& sort) {
    const auto entry = fine.find(sort);
    sort = entry == fine.end() ? sort : entry->second;
  };
  for (reasoner::FluentDeclaration& fluent : result.fluents)
  {
    if (fluent.kind != reasoner::FluentKind::kStatic)
    {
      std::for_each(fluent.argument_sorts.begin(), fluent.argument_sorts.end(), replace);
      if (fluent.value_sort)
      {
        replace(*fluent.value_sort);
      }
    }
  }
  for (reasoner::ActionDeclaration& action : result.actions)
  {
    std::for_each(action.argument_sorts.begin(), action.argument_sorts.end(), replace);
  }
  const auto append = [](auto& to, const auto& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  for (const reasoner::Sort& sort : refinement.sorts)
  {
    if (result.findSort(sort.name) == nullptr)
    {
      result.sorts.push_back(sort);
    }
  }
  append(result.fluents, refinement.fluents);
  append(result.actions, refinement.actions);
  append(result.causal_laws, refinement.causal_laws);
  append(result.observations, refinement.observations);
  return result;
}

}  // namespace kr3::refinement
