#include "encoding.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <set>

#include "statement_shape.hpp"

namespace kr3::reasoner
{

namespace
{

std::string call(const std::string& name, const std::vector<std::string>& arguments)
{
  std::string text = name;
  for (std::size_t i = 0; i < arguments.size(); ++i)
  {
    text += (i == 0 ? "(" : ",") + arguments[i];
  }
  return arguments.empty() ? text : text + ")";
}

/// `loc(_X0)` with `sort(thing,_X0)`, for the arguments of a declaration.
struct OpenAtom
{
  OpenAtom(const std::string& name, const std::vector<std::string>& sorts)
  {
    std::vector<std::string> variables;
    for (const std::string& sort : sorts)
    {
      variables.push_back("_X" + std::to_string(variables.size()));
      guards += ", sort(" + sort + "," + variables.back() + ")";
    }
    term = call(name, variables);
  }

  std::string term;
  std::string guards;
};

/// An expert's code, where the step is `t`, with the step called `_t` as in our own rules: a
/// constant of the description may be called `t`, and would be taken for the step.
std::string withOurStep(const std::string& code)
{
  const auto inWord = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '\'';
  };
  std::string text;
  for (std::size_t i = 0; i < code.size();)
  {
    std::size_t end = i + 1;
    if (code[i] == '%' || code[i] == '"')  // comments and strings stay
    {
      end = std::min(code.find(code[i] == '%' ? '\n' : '"', end), code.size() - 1) + 1;
    }
    else if (inWord(code[i]))
    {
      end = static_cast<std::size_t>(
          std::find_if_not(code.begin() + static_cast<std::ptrdiff_t>(i), code.end(), inWord) -
          code.begin());
    }
    const std::string token = code.substr(i, end - i);
    text += token == "t" ? "_t" : token;
    i = end;
  }
  return text;
}

}  // namespace

std::string Encoding::comment(const SourcePosition& position)
{
  return position.line == 0 ? ""
                            : "% " + position.file + ":" + std::to_string(position.line) + "\n";
}

std::string Encoding::term(const Atom& atom)
{
  std::vector<std::string> arguments;
  for (const Term& argument : atom.arguments)
  {
    arguments.push_back(argument.name);
  }
  return call(atom.name, arguments);
}

bool Encoding::isBoolean(const Literal& literal) const
{
  const FluentDeclaration* fluent = description_.findFluent(literal.atom.name);
  return fluent != nullptr && !fluent->value_sort;
}

std::string Encoding::literal(const Literal& literal, const std::string& step) const
{
  const FluentDeclaration& fluent = *description_.findFluent(literal.atom.name);
  const bool is_static = fluent.kind == FluentKind::kStatic;
  const std::string name = term(literal.atom);
  const auto holds = [&](const std::string& value) {
    return is_static ? "st(" + name + "," + value + ")"
                     : "h(" + name + "," + value + "," + step + ")";
  };
  if (!fluent.value_sort)
  {
    const bool positive = (literal.value.name == "true") == literal.equal;
    if (!positive && (is_static || fluent.kind == FluentKind::kDefined))
    {
      return "not " + holds("true");
    }
    return holds(positive ? "true" : "false");
  }
  if (literal.equal)
  {
    return holds(literal.value.name);
  }
  if (is_static)
  {
    return "not " + holds(literal.value.name);  // a static may have no value at all
  }
  // A value of its own for each such literal: two of them in one body may differ.
  std::string other = "_V_";
  for (const char c : name + "_" + literal.value.name)
  {
    other += std::isalnum(static_cast<unsigned char>(c)) != 0 ? std::string(1, c)
             : c == '_'                                       ? "__"
                                                              : "_" + std::to_string(c) + "_";
  }
  return holds(other) + ", " + other + " != " + literal.value.name;
}

std::string Encoding::condition(const Condition& condition, const std::string& step) const
{
  if (const auto* part = std::get_if<Literal>(&condition))
  {
    return literal(*part, step);
  }
  if (const auto* comparison = std::get_if<Comparison>(&condition))
  {
    return comparison->left.name + " " + toString(comparison->op) + " " + comparison->right.name;
  }
  const auto& membership = std::get<Membership>(condition);
  return (membership.negated ? "not sort(" : "sort(") + membership.sort + "," +
         membership.term.name + ")";
}

std::string Encoding::body(const Body& body, const std::string& step) const
{
  std::string text;
  for (const Condition& part : body)
  {
    text += ", " + condition(part, step);
  }
  return text;
}

/// The fluent has another value than this one, one step before: a negation, which keeps the number
/// of ground rules linear. Only what refers to the step before may be said so: in a rule within one
/// step it would not be founded.
std::string Encoding::differs(const Literal& literal, const Term& value) const
{
  const std::string fluent = term(literal.atom);
  return "basic(" + fluent + "), not h(" + fluent + "," + value.name + ",_t-1)";
}

/// Guards and body at t-1. `F != V`, and `F = V` with `V != W` where V stands nowhere else, are
/// said by negation. @param used  variables that stand outside the body, too
std::string Encoding::conditionsBefore(const Body& body, const Guards& guards,
                                       const std::set<std::string>& used) const
{
  const auto isFunctional = [&](const Literal& literal) {
    const FluentDeclaration& fluent = *description_.findFluent(literal.atom.name);
    return fluent.value_sort && fluent.kind != FluentKind::kStatic;
  };
  const std::map<std::string, int> uses = variableUses(body);
  const auto comparedOnly = [&](const Literal& literal) {
    return literal.equal && isFunctional(literal) && literal.value.is_variable &&
           used.count(literal.value.name) == 0 && uses.at(literal.value.name) == 2;
  };
  std::vector<bool> done(body.size(), false);
  std::set<std::string> gone;
  std::string text;
  for (std::size_t i = 0; i < body.size(); ++i)
  {
    const auto* comparison = std::get_if<Comparison>(&body[i]);
    if (comparison == nullptr || comparison->op != Comparison::Operator::kNotEqual)
    {
      continue;
    }
    for (std::size_t j = 0; j < body.size() && !done[i]; ++j)
    {
      const auto* part = std::get_if<Literal>(&body[j]);
      if (part == nullptr || done[j] || !comparedOnly(*part) ||
          (comparison->left == part->value) == (comparison->right == part->value))
      {
        continue;
      }
      const bool left = comparison->left == part->value;
      text += ", " + differs(*part, left ? comparison->right : comparison->left);
      gone.insert(part->value.name);
      done[i] = done[j] = true;
    }
  }
  for (std::size_t i = 0; i < body.size(); ++i)
  {
    const auto* part = std::get_if<Literal>(&body[i]);
    if (!done[i])
    {
      text += ", " + (part != nullptr && !part->equal && isFunctional(*part)
                          ? differs(*part, part->value)
                          : condition(body[i], "_t-1"));
    }
  }
  return guards.text(gone) + text;
}

std::string Encoding::vocabulary() const
{
  std::string text;
  for (const Sort& sort : description_.sorts)
  {
    for (const std::string& element : sort.elements)
    {
      text += "sort(" + sort.name + "," + element + "). ";
    }
    text += "\n";
  }
  for (const FluentDeclaration& fluent : description_.fluents)
  {
    const OpenAtom open(fluent.name, fluent.argument_sorts);
    if (fluent.kind == FluentKind::kDefined)
    {
      text += "defined(" + open.term + ") :- #true" + open.guards + ".\n";
    }
    else if (fluent.kind != FluentKind::kStatic)
    {
      // a fluent whose values all went is no fluent
      text += "basic(" + open.term + ") :- #true" + open.guards +
              (fluent.value_sort ? ", sort(" + *fluent.value_sort + ",_)" : "") + ".\n";
    }
  }
  for (const Literal& fact : description_.static_facts)
  {
    if (fact.equal && fact.value.name != "false")
    {
      text += "st(" + term(fact.atom) + "," + fact.value.name + ").\n";
    }
  }
  for (const StateConstraint& constraint : description_.constraints)
  {
    if (constraint.head &&
        description_.findFluent(constraint.head->atom.name)->kind == FluentKind::kStatic)
    {
      Guards guards(description_);
      guards.literal(*constraint.head).body(constraint.body);
      text += comment(constraint.position) + literal(*constraint.head, "0") + " :- #true" +
              guards.text() + body(constraint.body, "0") + ".\n";
    }
  }
  text += unequalRules();
  return text +
         "#defined sort/2. #defined defined/1. #defined basic/1. #defined st/2. #defined "
         "watched/2.\n" +
         rawBlocks(AspPart::kBase);
}

std::string Encoding::values() const
{
  std::string text;
  for (const FluentDeclaration& fluent : description_.fluents)
  {
    if (fluent.kind != FluentKind::kStatic && fluent.kind != FluentKind::kDefined)
    {
      const OpenAtom open(fluent.name, fluent.argument_sorts);
      text += "fv(" + open.term + "," + (fluent.value_sort ? "_V" : "(false;true)") + ") :- #true" +
              open.guards + (fluent.value_sort ? ", sort(" + *fluent.value_sort + ",_V)" : "") +
              ".\n";
    }
  }
  return text + "#defined fv/2.\n";
}

std::string Encoding::actions() const
{
  std::string text;
  for (const ActionDeclaration& action : description_.actions)
  {
    const OpenAtom open(action.name, action.argument_sorts);
    text +=
        (action.exogenous ? "exog(" : "agent(") + open.term + ") :- #true" + open.guards + ".\n";
  }
  return text + "#defined agent/1. #defined exog/1. #defined occ/2. #defined imp/2.\n";
}

std::string Encoding::stateBody(const StateConstraint& constraint) const
{
  std::string text;
  for (const Condition& condition : constraint.body)
  {
    if (isCircular(description_, constraint, condition))
    {
      const auto& literal = std::get<Literal>(condition);
      text += ", ne(" + term(literal.atom) + "," + literal.value.name + ",_t)";
    }
    else
    {
      text += body({condition}, "_t");
    }
  }
  return text;
}

std::string Encoding::unequalRules() const
{
  std::string text;
  for (const StateConstraint& constraint : description_.constraints)
  {
    for (const Condition& condition : constraint.body)
    {
      if (isCircular(description_, constraint, condition))
      {
        const auto& literal = std::get<Literal>(condition);
        Guards guards(description_);
        guards.literal(literal);
        text += "watched(" + term(literal.atom) + "," + literal.value.name + ") :- #true" +
                guards.text() + ".\n";
      }
    }
  }
  return text;
}

std::string Encoding::state() const
{
  return ":- basic(_F), not 1 { h(_F,_V,_t) : fv(_F,_V) } 1.\n" + constraints();
}

std::string Encoding::constraints() const
{
  std::string text;
  if (!unequalRules().empty())
  {
    text +=
        "ne(_F,_V,_t) :- watched(_F,_V), h(_F,_W,_t), _W != _V.\n:- ne(_F,_V,_t), h(_F,_V,_t).\n";
  }
  for (const StateConstraint& constraint : description_.constraints)
  {
    Guards guards(description_);
    guards.body(constraint.body);
    text += comment(constraint.position);
    if (!constraint.head)
    {
      text += ":- #true" + guards.text() + body(constraint.body, "_t") + ".\n";
      continue;
    }
    const Literal& head = *constraint.head;
    guards.literal(head);
    if (description_.findFluent(head.atom.name)->kind == FluentKind::kStatic)
    {
      continue;
    }
    const std::string conditions = guards.text() + stateBody(constraint) + ".\n";
    if (head.equal || isBoolean(head))
    {
      text += literal(head, "_t") + " :- #true" + conditions;
    }
    else
    {
      text += ":- h(" + term(head.atom) + "," + head.value.name + ",_t)" + conditions;
    }
  }
  return text + rawBlocks(AspPart::kState);
}

std::string Encoding::rawBlocks(AspPart part) const
{
  std::string text;
  for (const AspBlock& block : description_.asp_blocks)
  {
    if (block.part == part)
    {
      text += comment(block.position) +
              (part == AspPart::kBase ? block.text : withOurStep(block.text)) + "\n";
    }
  }
  return text;
}

std::string Encoding::anyState()
{
  return "1 { h(_F,_V,0) : fv(_F,_V) } 1 :- basic(_F).\n";
}

}  // namespace kr3::reasoner
