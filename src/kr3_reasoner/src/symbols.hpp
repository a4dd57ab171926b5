#pragma once

#include <map>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "kr3_reasoner/language.hpp"

namespace kr3::reasoner
{

/// Fast look-up of a description's names and elements, for checks of large files. Private to the
/// package. Not thread-safe: it indexes the elements of a sort when it is first asked about them.
class Symbols
{
public:
  /// @param description  must outlive the symbols, and not change
  explicit Symbols(const Description& description);

  [[nodiscard]] const Description& description() const { return description_; }
  [[nodiscard]] const Sort* sort(const std::string& name) const;
  [[nodiscard]] const FluentDeclaration* fluent(const std::string& name) const;
  [[nodiscard]] const ActionDeclaration* action(const std::string& name) const;

  [[nodiscard]] bool hasElement(const Sort& sort, const std::string& element) const;

  /// Whether some element is in all of the sorts. Sorts that are empty or unknown count as open:
  /// the answer is then true.
  [[nodiscard]] bool haveCommonElement(std::vector<std::string> sorts) const;

  /// All names of a kind, in the order of declaration, for suggestions.
  [[nodiscard]] std::vector<std::string> sortNames() const;
  [[nodiscard]] std::vector<std::string> fluentAndSortNames() const;
  [[nodiscard]] std::vector<std::string> actionNames() const;

private:
  const Description& description_;
  std::unordered_map<std::string_view, const Sort*> sorts_;
  std::unordered_map<std::string_view, const FluentDeclaration*> fluents_;
  std::unordered_map<std::string_view, const ActionDeclaration*> actions_;
  mutable std::unordered_map<const Sort*, std::unordered_set<std::string_view>> elements_;
  mutable std::map<std::vector<std::string>, bool> common_;
};

}  // namespace kr3::reasoner
