#include <algorithm>
#include <set>
#include <sstream>

#include "kr3_reasoner/language.hpp"

namespace kr3::reasoner
{

namespace
{

std::string joined(const std::vector<std::string>& items, const std::string& separator)
{
  std::string text;
  for (const std::string& item : items)
  {
    text += (text.empty() ? "" : separator) + item;
  }
  return text;
}

std::string signature(const std::string& name, const std::vector<std::string>& sorts)
{
  return sorts.empty() ? name : name + "(" + joined(sorts, ", ") + ")";
}

std::string operatorText(Comparison::Operator op)
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
  return "?";
}

std::string conditionText(const Condition& condition)
{
  if (const auto* literal = std::get_if<Literal>(&condition))
  {
    return toString(*literal);
  }
  if (const auto* comparison = std::get_if<Comparison>(&condition))
  {
    return comparison->left.name + " " + operatorText(comparison->op) + " " +
           comparison->right.name;
  }
  const auto& membership = std::get<Membership>(condition);
  return (membership.negated ? "not " : "") + membership.sort + "(" + membership.term.name + ")";
}

std::string bodyText(const Body& body)
{
  std::vector<std::string> parts;
  for (const Condition& condition : body)
  {
    parts.push_back(conditionText(condition));
  }
  return joined(parts, ", ");
}

std::string ifText(const Body& body)
{
  return body.empty() ? "" : " if " + bodyText(body);
}

std::string outcomeText(const Outcome& outcome)
{
  std::vector<std::string> effects;
  for (const Effect& effect : outcome.effects)
  {
    effects.push_back(effect.is_choice ? toString(effect.fluent) + " = {" + effect.value.name +
                                             " : " + bodyText(effect.choice) + "}"
                                       : toString(Literal{effect.fluent, effect.value, true}));
  }
  return (effects.empty() ? "nothing" : joined(effects, ", ")) +
         (outcome.label.empty() ? "" : " [" + outcome.label + "]");
}

std::string sortText(const Sort& sort, const Description& description)
{
  std::set<std::string> inherited;
  for (const std::string& member : sort.member_sorts)
  {
    if (const Sort* found = description.findSort(member))
    {
      inherited.insert(found->elements.begin(), found->elements.end());
    }
  }
  std::vector<std::string> own;
  std::copy_if(sort.elements.begin(), sort.elements.end(), std::back_inserter(own),
               [&](const std::string& element) { return inherited.count(element) == 0; });
  std::vector<std::string> parts;
  if (!own.empty() || sort.member_sorts.empty())
  {
    parts.push_back("{" + joined(own, ", ") + "}");
  }
  parts.insert(parts.end(), sort.member_sorts.begin(), sort.member_sorts.end());
  return sort.name + " = " + joined(parts, " + ");
}

const char* kindText(FluentKind kind)
{
  switch (kind)
  {
    case FluentKind::kStatic:
      return "";
    case FluentKind::kInertial:
      return "inertial ";
    case FluentKind::kDefined:
      return "defined ";
    case FluentKind::kKnowledge:
      return "knowledge ";
  }
  return "";
}

/// Prints sections; an empty one is left out.
class Printer
{
public:
  void section(const std::string& name) { pending_ = name; }

  void statement(const std::string& text)
  {
    if (!pending_.empty())
    {
      text_ << (text_.tellp() > 0 ? "\n" : "") << pending_ << "\n";
      pending_.clear();
    }
    text_ << "  " << text << ".\n";
  }

  [[nodiscard]] std::string text() const { return text_.str(); }

private:
  std::ostringstream text_;
  std::string pending_;
};

void printDeclarations(const Description& description, Printer& printer)
{
  for (const Magnification& magnification : description.magnifications)
  {
    printer.statement("magnify " + magnification.coarse + " into " + magnification.fine + " by " +
                      magnification.component_static);
  }
  printer.section("sorts");
  for (const Sort& sort : description.sorts)
  {
    printer.statement(sortText(sort, description));
  }
  for (const bool statics : {true, false})
  {
    printer.section(statics ? "statics" : "fluents");
    for (const FluentDeclaration& fluent : description.fluents)
    {
      if ((fluent.kind == FluentKind::kStatic) == statics)
      {
        printer.statement(kindText(fluent.kind) + signature(fluent.name, fluent.argument_sorts) +
                          (fluent.value_sort ? " : " + *fluent.value_sort : ""));
      }
    }
  }
  printer.section("actions");
  for (const ActionDeclaration& action : description.actions)
  {
    printer.statement((action.exogenous ? "exogenous " : "") +
                      signature(action.name, action.argument_sorts));
  }
}

void printAxioms(const Description& description, Printer& printer)
{
  printer.section("axioms");
  for (const CausalLaw& law : description.causal_laws)
  {
    std::vector<std::string> outcomes;
    for (const Outcome& outcome : law.outcomes)
    {
      outcomes.push_back(outcomeText(outcome));
    }
    printer.statement(toString(law.action) + " causes " + joined(outcomes, " or ") +
                      ifText(law.body));
  }
  for (const StateConstraint& constraint : description.constraints)
  {
    printer.statement((constraint.head ? toString(*constraint.head) : "false") +
                      ifText(constraint.body));
  }
  for (const Executability& rule : description.executabilities)
  {
    std::vector<std::string> actions;
    for (const auto& action : rule.actions)
    {
      const auto* atom = std::get_if<Atom>(&action);
      actions.push_back(atom != nullptr ? toString(*atom) : toString(std::get<Term>(action)));
    }
    printer.statement("impossible " + joined(actions, ", ") + ifText(rule.body));
  }
}

std::string number(double value)
{
  std::ostringstream text;
  text.precision(15);
  text << value;
  return text.str();
}

void printRest(const Description& description, Printer& printer)
{
  printer.section("observations");
  for (const ObservationLaw& law : description.observations)
  {
    printer.statement(toString(law.action) + " observes " + toString(law.fluent) +
                      (law.value ? " = " + law.value->name : ""));
  }
  printer.section("facts");
  for (const Literal& fact : description.static_facts)
  {
    printer.statement(toString(fact));
  }
  printer.section("defaults");
  for (const Default& rule : description.defaults)
  {
    printer.statement(toString(rule.name) + ": " + toString(rule.head) + ifText(rule.body));
  }
  for (const Preference& preference : description.preferences)
  {
    printer.statement("prefer " + toString(preference.better) + " over " +
                      toString(preference.worse));
  }
  for (const ActionCost& cost : description.costs)
  {
    printer.statement("cost " + toString(cost.action) + " = " + number(cost.cost) +
                      ifText(cost.body));
  }
}

std::string formulaText(const Formula& formula, bool nested)
{
  switch (formula.kind)
  {
    case Formula::Kind::kLiteral:
      return toString(formula.literal);
    case Formula::Kind::kNot:
      return "not " + formulaText(formula.operands.front(), true);
    case Formula::Kind::kAnd:
    case Formula::Kind::kOr:
      break;
  }
  std::vector<std::string> parts;
  for (const Formula& operand : formula.operands)
  {
    parts.push_back(formulaText(operand, true));
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

std::string toString(const Description& description)
{
  Printer printer;
  printDeclarations(description, printer);
  printAxioms(description, printer);
  printRest(description, printer);
  return printer.text();
}

std::string toString(const Formula& formula)
{
  return formulaText(formula, false);
}

}  // namespace kr3::reasoner
