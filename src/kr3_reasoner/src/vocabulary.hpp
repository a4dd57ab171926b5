#pragma once

#include <limits>
#include <string>
#include <unordered_map>
#include <vector>

#include "kr3_reasoner/language.hpp"

namespace kr3::reasoner
{

/// Whether a comparison holds of terms in this order: negative, zero or positive.
[[nodiscard]] bool satisfies(int order, Comparison::Operator op);

/// A constant by number; kUnbound: not bound to any. Private to the package, as all of this file.
using ConstantId = int;
constexpr ConstantId kUnbound = -1;

/// Numbers for the constants, sorts, fluents and actions of a description, so that rules are
/// instantiated over integers. Cost of construction: linear in the number of elements of all sorts.
class Vocabulary
{
public:
  static constexpr ConstantId kFalse = 0;
  static constexpr ConstantId kTrue = 1;

  /// @param description  must outlive this
  explicit Vocabulary(const Description& description);

  [[nodiscard]] const Description& description() const { return description_; }

  /// The number of a constant, or kUnbound when neither a sort nor a rule has it.
  [[nodiscard]] ConstantId constant(const std::string& name) const;
  /// The same, but a constant that is new gets a number.
  ConstantId add(const std::string& name);
  [[nodiscard]] const std::string& name(ConstantId constant) const { return names_[constant]; }
  [[nodiscard]] std::size_t numConstants() const { return names_.size(); }

  /// Whether a comparison is true: of numbers by value, of others by name.
  [[nodiscard]] bool holds(ConstantId left, Comparison::Operator op, ConstantId right) const;

  /// @throws std::out_of_range  there is none of that name
  [[nodiscard]] int fluentSymbol(const std::string& name) const { return fluents_.at(name); }
  [[nodiscard]] int actionSymbol(const std::string& name) const { return actions_.at(name); }
  [[nodiscard]] int sortIndex(const std::string& name) const { return sorts_.at(name); }
  [[nodiscard]] const FluentDeclaration& fluent(int symbol) const
  {
    return description_.fluents[symbol];
  }
  [[nodiscard]] bool isStatic(int symbol) const
  {
    return fluent(symbol).kind == FluentKind::kStatic;
  }
  [[nodiscard]] bool isDefined(int symbol) const
  {
    return fluent(symbol).kind == FluentKind::kDefined;
  }

  [[nodiscard]] const std::vector<ConstantId>& elements(int sort) const { return elements_[sort]; }
  [[nodiscard]] bool inSort(ConstantId constant, int sort) const
  {
    return position(constant, sort) >= 0;
  }
  /// Where a constant stands among the elements of a sort, or -1.
  [[nodiscard]] int position(ConstantId constant, int sort) const
  {
    const std::vector<int>& positions = positions_[sort];
    return static_cast<std::size_t>(constant) < positions.size() ? positions[constant] : -1;
  }

private:
  static constexpr long kNoNumber = std::numeric_limits<long>::min();

  const Description& description_;
  std::unordered_map<std::string, ConstantId> constants_;
  std::vector<std::string> names_;
  std::vector<long> numbers_;  // by constant, kNoNumber for names
  std::unordered_map<std::string, int> fluents_;
  std::unordered_map<std::string, int> actions_;
  std::unordered_map<std::string, int> sorts_;
  std::vector<std::vector<ConstantId>> elements_;
  std::vector<std::vector<int>> positions_;  // [sort][constant]
};

}  // namespace kr3::reasoner
