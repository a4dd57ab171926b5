#include <string>
#include <vector>

#include "kr3_reasoner/language.hpp"
#include "print_text.hpp"

namespace kr3::reasoner
{

namespace
{

std::string formulaText(const Formula& formula, const Description& description, bool nested)
{
  switch (formula.kind)
  {
    case Formula::Kind::kLiteral:
      return toString(formula.literal, description);
    case Formula::Kind::kNot:
      return "not " + formulaText(formula.operands.front(), description, true);
    case Formula::Kind::kAnd:
    case Formula::Kind::kOr:
      break;
  }
  std::vector<std::string> parts;
  for (const Formula& operand : formula.operands)
  {
    parts.push_back(formulaText(operand, description, true));
  }
  const std::string text = joined(parts, formula.kind == Formula::Kind::kAnd ? " and " : " or ");
  return nested ? "(" + text + ")" : text;
}

}  // namespace

std::string toString(const Term& term)
{
  return term.name;
}

std::string toString(const Atom& atom)
{
  std::vector<std::string> arguments;
  for (const Term& argument : atom.arguments)
  {
    arguments.push_back(argument.name);
  }
  return signature(atom.name, arguments);
}

std::string toString(const Literal& literal)
{
  if (!literal.value.is_variable && literal.equal && literal.value.name == "true")
  {
    return toString(literal.atom);
  }
  if (!literal.value.is_variable && literal.equal && literal.value.name == "false")
  {
    return "-" + toString(literal.atom);
  }
  return toString(literal.atom) + (literal.equal ? " = " : " != ") + literal.value.name;
}

std::string toString(const Literal& literal, const Description& description)
{
  const FluentDeclaration* fluent = description.findFluent(literal.atom.name);
  if (fluent == nullptr || !fluent->predicate_form || literal.value.name == fluent->no_value ||
      literal.atom.arguments.size() != fluent->argument_sorts.size())
  {
    return toString(literal);
  }
  Atom predicate = literal.atom;
  predicate.arguments.push_back(literal.value);
  return (literal.equal ? "" : "-") + toString(predicate);
}

const char* toString(Comparison::Operator op)
{
  switch (op)
  {
    case Comparison::Operator::kEqual:
      return "=";
    case Comparison::Operator::kNotEqual:
      return "!=";
    case Comparison::Operator::kLess:
      return "<";
    case Comparison::Operator::kLessEqual:
      return "<=";
    case Comparison::Operator::kGreater:
      return ">";
    case Comparison::Operator::kGreaterEqual:
      return ">=";
  }
  return "=";
}

std::string toString(const Formula& formula)
{
  return formulaText(formula, {}, false);
}

std::string toString(const Formula& formula, const Description& description)
{
  return formulaText(formula, description, false);
}

}  // namespace kr3::reasoner
