#include "conditions.hpp"

#include <algorithm>

namespace kr3::reasoner
{

int ConditionReader::variable(const std::string& name) const
{
  const auto found = std::find(names_.begin(), names_.end(), name);
  return found == names_.end() ? -1 : static_cast<int>(found - names_.begin());
}

Slot ConditionReader::slot(const Term& term, int sort)
{
  if (!term.is_variable)
  {
    return {false, vocabulary_.add(term.name)};
  }
  int number = variable(term.name);
  if (number < 0)
  {
    number = static_cast<int>(names_.size());
    names_.push_back(term.name);
    conditions_.variable_sorts.emplace_back();
  }
  auto& sorts = conditions_.variable_sorts[static_cast<std::size_t>(number)];
  if (sort != kNoSort && std::find(sorts.begin(), sorts.end(), sort) == sorts.end())
  {
    sorts.push_back(sort);
  }
  return {true, number};
}

std::vector<Slot> ConditionReader::arguments(const Atom& atom,
                                             const std::vector<std::string>& sorts)
{
  std::vector<Slot> slots;
  for (std::size_t i = 0; i < atom.arguments.size(); ++i)
  {
    slots.push_back(slot(atom.arguments[i], vocabulary_.sortIndex(sorts[i])));
  }
  return slots;
}

std::vector<Slot> ConditionReader::action(const Atom& atom)
{
  const int symbol = vocabulary_.actionSymbol(atom.name);
  return arguments(atom, vocabulary_.description().actions[symbol].argument_sorts);
}

LiteralPattern ConditionReader::literal(const Literal& literal)
{
  const int symbol = vocabulary_.fluentSymbol(literal.atom.name);
  const FluentDeclaration& fluent = vocabulary_.fluent(symbol);
  LiteralPattern pattern{symbol, arguments(literal.atom, fluent.argument_sorts), {}, true};
  if (fluent.value_sort)
  {
    pattern.value = slot(literal.value, vocabulary_.sortIndex(*fluent.value_sort));
    pattern.equal = literal.equal;
  }
  else
  {
    const bool positive = (literal.value.name == "true") == literal.equal;
    pattern.value = {false, positive ? Vocabulary::kTrue : Vocabulary::kFalse};
  }
  return pattern;
}

void ConditionReader::add(const Comparison& comparison)
{
  conditions_.relations.push_back(
      {slot(comparison.left, kNoSort), comparison.op, slot(comparison.right, kNoSort)});
}

void ConditionReader::add(const Membership& membership)
{
  const int sort = vocabulary_.sortIndex(membership.sort);
  conditions_.sort_tests.push_back(
      {sort, slot(membership.term, membership.negated ? kNoSort : sort), membership.negated});
}

}  // namespace kr3::reasoner
