#pragma once

#include <string>
#include <vector>

/// Pieces of printed text. Private to the package.
namespace kr3::reasoner
{

/// "a, b, c".
[[nodiscard]] inline std::string joined(const std::vector<std::string>& items,
                                        const std::string& separator)
{
  std::string text;
  for (const std::string& item : items)
  {
    text += (text.empty() ? "" : separator) + item;
  }
  return text;
}

/// `loc(thing, place)`.
[[nodiscard]] inline std::string signature(const std::string& name,
                                           const std::vector<std::string>& sorts)
{
  return sorts.empty() ? name : name + "(" + joined(sorts, ", ") + ")";
}

}  // namespace kr3::reasoner
