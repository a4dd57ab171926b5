#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <unordered_map>
#include <variant>
#include <vector>

#include <kr3_reasoner/language.hpp>

namespace kr3::refinement
{

/// Constants as numbers. Negative numbers are no constants.
class Vocabulary
{
public:
  int intern(const std::string& name);
  [[nodiscard]] int find(const std::string& name) const;  ///< kNone when unknown
  [[nodiscard]] const std::string& name(int constant) const
  {
    return names_[static_cast<std::size_t>(constant)];
  }
  [[nodiscard]] std::size_t size() const { return names_.size(); }

  static constexpr int kNone = -1;

private:
  std::vector<std::string> names_;
  std::unordered_map<std::string, int> index_;
};

/// A set of constants that keeps its order.
class ConstantSet
{
public:
  ConstantSet() = default;
  explicit ConstantSet(std::vector<int> elements);
  [[nodiscard]] const std::vector<int>& elements() const { return elements_; }
  [[nodiscard]] bool contains(int constant) const
  {
    const auto index = static_cast<std::size_t>(constant);
    return constant >= 0 && index < member_.size() && member_[index] != 0;
  }
  [[nodiscard]] ConstantSet intersection(const ConstantSet& other) const;
  [[nodiscard]] ConstantSet without(const ConstantSet& other) const;

private:
  std::vector<int> elements_;
  std::vector<char> member_;
};

/// A constant (>= 0) or a variable (slot of a binding) of a compiled rule.
struct Slot
{
  bool is_variable = false;
  int id = 0;
};

struct CompiledLiteral
{
  std::size_t symbol = 0;
  std::vector<Slot> arguments;
  Slot value;
  bool equal = true;
};

struct CompiledComparison
{
  Slot left;
  reasoner::Comparison::Operator op = reasoner::Comparison::Operator::kEqual;
  Slot right;
};

struct CompiledMembership
{
  const ConstantSet* sort = nullptr;
  Slot term;
  bool negated = false;
};

using CompiledCondition = std::variant<CompiledLiteral, CompiledComparison, CompiledMembership>;

/// The value of each variable of a rule, kNone while it has none.
using Binding = std::vector<int>;

/// The variables of one law and the elements each may stand for (typed by position).
struct Variables
{
  std::unordered_map<std::string, int> slots;
  std::vector<ConstantSet> domains;       ///< within the zoom
  std::vector<ConstantSet> full_domains;  ///< of the whole description
};

struct CompiledEffect
{
  CompiledLiteral fluent;  ///< its value is the effect's, in a choice the slot of the chosen value
  bool is_choice = false;
  bool choice_is_static = false;  ///< its condition mentions no fluent, so it can be remembered
  std::vector<CompiledCondition> choice;
};

struct CompiledOutcome
{
  std::string label;
  std::vector<CompiledEffect> effects;
};

struct CompiledLaw
{
  Variables variables;
  std::vector<Slot> arguments;  ///< of the action
  std::vector<CompiledCondition> body;
  std::vector<CompiledOutcome> outcomes;
};

struct CompiledConstraint
{
  Variables variables;
  std::optional<CompiledLiteral> head;
  std::vector<CompiledCondition> body;
  reasoner::SourcePosition position;
};

struct CompiledExecutability
{
  Variables variables;
  std::vector<Slot> arguments;
  std::vector<CompiledCondition> body;
  reasoner::SourcePosition position;
};

struct CompiledObservation
{
  Variables variables;
  std::vector<Slot> arguments;
  CompiledLiteral fluent;  ///< the value is meaningless unless `has_value`
  bool has_value = false;
};

}  // namespace kr3::refinement
