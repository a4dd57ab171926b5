#pragma once

#include <string>
#include <vector>

#include "vocabulary.hpp"

namespace kr3::reasoner
{

/// A constant or a variable of a rule, by number. Private to the package, as all of this file.
struct Slot
{
  bool is_variable = false;
  int id = 0;
};

/// Values of a rule's variables, by number.
using RuleBinding = std::vector<ConstantId>;

/// `f(s1, ..., sn) = s` or `!=`; a boolean literal has the value true or false and `equal` set.
struct LiteralPattern
{
  int symbol = 0;  ///< index in Description::fluents
  std::vector<Slot> arguments;
  Slot value;
  bool equal = true;
};

/// What restricts the variables of a rule once and for all: the sorts of the positions they stand
/// in, statics, comparisons and sorts in the body.
struct Conditions
{
  struct Relation
  {
    Slot left;
    Comparison::Operator op;
    Slot right;
  };
  struct SortTest
  {
    int sort;
    Slot term;
    bool negated;
  };

  std::vector<std::vector<int>> variable_sorts;  ///< by variable
  std::vector<LiteralPattern> statics;
  std::vector<Relation> relations;
  std::vector<SortTest> sort_tests;

  [[nodiscard]] std::size_t numVariables() const { return variable_sorts.size(); }
};

/// The constant that a slot stands for, or kUnbound.
[[nodiscard]] inline ConstantId bound(const Slot& slot, const RuleBinding& binding)
{
  return slot.is_variable ? binding[static_cast<std::size_t>(slot.id)] : slot.id;
}

/// Takes the terms and conditions of one statement apart and numbers its variables.
class ConditionReader
{
public:
  static constexpr int kNoSort = -1;

  /// @param vocabulary  gets the constants that only rules mention; must outlive this
  explicit ConditionReader(Vocabulary& vocabulary) : vocabulary_(vocabulary) {}

  [[nodiscard]] const Conditions& conditions() const { return conditions_; }
  [[nodiscard]] const std::vector<std::string>& variables() const { return names_; }

  /// The number of a variable, or -1.
  [[nodiscard]] int variable(const std::string& name) const;

  Slot slot(const Term& term, int sort);
  std::vector<Slot> arguments(const Atom& atom, const std::vector<std::string>& sorts);
  std::vector<Slot> action(const Atom& atom);
  /// A literal, normalized so that boolean ones are equalities.
  LiteralPattern literal(const Literal& literal);

  /// Adds a condition that is a static, a comparison or a sort.
  void addStatic(const Literal& literal) { conditions_.statics.push_back(this->literal(literal)); }
  void add(const Comparison& comparison);
  void add(const Membership& membership);

private:
  Vocabulary& vocabulary_;
  Conditions conditions_;
  std::vector<std::string> names_;
};

}  // namespace kr3::reasoner
