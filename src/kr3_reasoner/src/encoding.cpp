#include "encoding.hpp"

#include <algorithm>
#include <cctype>
#include <set>

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
  return "=";
}

std::string tuple(const std::vector<std::string>& items)
{
  std::string text = "(";
  for (const std::string& item : items)
  {
    text += item + ",";
  }
  return items.empty() ? "()" : text + ")";
}

bool isPairwiseExclusion(const Executability& rule)
{
  if (rule.actions.size() != 2 || rule.body.size() != 1)
  {
    return false;
  }
  const auto* first = std::get_if<Term>(&rule.actions[0]);
  const auto* second = std::get_if<Term>(&rule.actions[1]);
  const auto* unequal = std::get_if<Comparison>(&rule.body[0]);
  return first != nullptr && second != nullptr && unequal != nullptr && !(*first == *second) &&
         unequal->op == Comparison::Operator::kNotEqual && !(unequal->left == unequal->right) &&
         unequal->left.is_variable && unequal->right.is_variable;
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

std::string Encoding::body(const Body& body, const std::string& step) const
{
  std::string text;
  for (const Condition& condition : body)
  {
    text += ", ";
    if (const auto* part = std::get_if<Literal>(&condition))
    {
      text += literal(*part, step);
    }
    else if (const auto* comparison = std::get_if<Comparison>(&condition))
    {
      text +=
          comparison->left.name + " " + operatorText(comparison->op) + " " + comparison->right.name;
    }
    else
    {
      const auto& membership = std::get<Membership>(condition);
      text += (membership.negated ? "not sort(" : "sort(") + membership.sort + "," +
              membership.term.name + ")";
    }
  }
  return text;
}

std::string Encoding::signature() const
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
      text += "fv(" + open.term + "," + (fluent.value_sort ? "_V" : "(false;true)") + ") :- #true" +
              open.guards + (fluent.value_sort ? ", sort(" + *fluent.value_sort + ",_V)" : "") +
              ".\n";
    }
  }
  text += "basic(_F) :- fv(_F,_).\n";  // a fluent whose values all went is no fluent
  for (const ActionDeclaration& action : description_.actions)
  {
    const OpenAtom open(action.name, action.argument_sorts);
    text +=
        (action.exogenous ? "exog(" : "agent(") + open.term + ") :- #true" + open.guards + ".\n";
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
  text +=
      "#defined sort/2. #defined defined/1. #defined fv/2. #defined agent/1. "
      "#defined exog/1. "
      "#defined st/2. #defined occ/2. #defined imp/2.\n";
  return text;
}

bool Encoding::dependsOn(const std::string& fluent, const std::string& other) const
{
  std::set<std::string> reached;
  std::vector<std::string> open = {fluent};
  while (!open.empty())
  {
    const std::string name = open.back();
    open.pop_back();
    if (name == other)
    {
      return true;
    }
    if (!reached.insert(name).second)
    {
      continue;
    }
    for (const StateConstraint& constraint : description_.constraints)
    {
      if (!constraint.head || constraint.head->atom.name != name)
      {
        continue;
      }
      for (const Condition& condition : constraint.body)
      {
        if (const auto* literal = std::get_if<Literal>(&condition))
        {
          open.push_back(literal->atom.name);
        }
      }
    }
  }
  return false;
}

bool Encoding::isCircular(const StateConstraint& constraint, const Condition& condition) const
{
  const auto* literal = std::get_if<Literal>(&condition);
  return literal != nullptr && constraint.head && !literal->equal && !isBoolean(*literal) &&
         description_.findFluent(literal->atom.name)->kind != FluentKind::kStatic &&
         dependsOn(literal->atom.name, constraint.head->atom.name);
}

std::string Encoding::stateBody(const StateConstraint& constraint) const
{
  std::string text;
  for (const Condition& condition : constraint.body)
  {
    if (isCircular(constraint, condition))
    {
      const auto& literal = std::get<Literal>(condition);
      text += ", ne(" + term(literal.atom) + "," + literal.value.name + ",t)";
    }
    else
    {
      text += body({condition}, "t");
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
      if (isCircular(constraint, condition))
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
  std::string text = ":- basic(_F), not 1 { h(_F,_V,t) : fv(_F,_V) } 1.\n";
  if (!unequalRules().empty())
  {
    text += "ne(_F,_V,t) :- watched(_F,_V), h(_F,_W,t), _W != _V.\n:- ne(_F,_V,t), h(_F,_V,t).\n";
  }
  for (const StateConstraint& constraint : description_.constraints)
  {
    Guards guards(description_);
    guards.body(constraint.body);
    text += comment(constraint.position);
    if (!constraint.head)
    {
      text += ":- #true" + guards.text() + body(constraint.body, "t") + ".\n";
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
      text += literal(head, "t") + " :- #true" + conditions;
    }
    else
    {
      text += ":- h(" + term(head.atom) + "," + head.value.name + ",t)" + conditions;
    }
  }
  return text;
}

std::string Encoding::lawRules(const CausalLaw& law, std::size_t index) const
{
  Guards guards(description_);
  guards.action(law.action).body(law.body);
  std::string text = comment(law.position);
  const std::string fired = "occ(" + term(law.action) + ",t-1)";
  const bool deterministic =
      law.outcomes.size() == 1 &&
      std::none_of(law.outcomes[0].effects.begin(), law.outcomes[0].effects.end(),
                   [](const Effect& effect) { return effect.is_choice; }) &&
      law.outcomes[0].label.empty();
  if (deterministic)
  {
    for (const Effect& effect : law.outcomes[0].effects)
    {
      Guards here = guards;
      here.literal({effect.fluent, effect.value, true});
      text += "h(" + term(effect.fluent) + "," + effect.value.name + ",t) :- " + fired +
              here.text() + body(law.body, "t-1") + ".\n";
    }
    return text;
  }
  // One choice for each instance of the action and of the effects' own variables.
  Guards key(description_);
  key.action(law.action);
  for (const Outcome& outcome : law.outcomes)
  {
    for (const Effect& effect : outcome.effects)
    {
      key.fluent(effect.fluent);
      if (effect.is_choice)
      {
        Guards choice(description_);
        key.shared(choice.body(effect.choice), guards);
      }
      else
      {
        key.literal({effect.fluent, effect.value, true});
      }
    }
  }
  const std::string number = std::to_string(index);
  const std::string keys = tuple(key.variables());
  const std::string fire = "fire(" + number + "," + keys + "," + term(law.action) + ",t)";
  text += fire + " :- " + fired + key.text() + guards.text() + body(law.body, "t-1") + ".\n";
  for (std::size_t i = 0; i < law.outcomes.size(); ++i)
  {
    const std::string label = number + "," + std::to_string(i) + "," + keys;
    std::string possible;
    for (std::size_t j = 0; j < law.outcomes[i].effects.size(); ++j)
    {
      const Effect& effect = law.outcomes[i].effects[j];
      const std::string out = "out(" + label + "," + term(law.action) + ",t)";
      if (!effect.is_choice)
      {
        text += "h(" + term(effect.fluent) + "," + effect.value.name + ",t) :- " + out + ".\n";
        continue;
      }
      const std::string picked = label + "," + std::to_string(j);
      Guards choice = key;
      choice.literal({effect.fluent, effect.value, true}).body(effect.choice);
      text += "cand(" + picked + "," + effect.value.name + ",t) :- " + fire + choice.text() +
              body(effect.choice, "t-1") + ".\n";
      text += "1 { pick(" + picked + ",_Z,t) : cand(" + picked + ",_Z,t) } 1 :- " + out + ".\n";
      text +=
          "h(" + term(effect.fluent) + ",_Z,t) :- pick(" + picked + ",_Z,t)" + key.text() + ".\n";
      possible += ", cand(" + picked + ",_Z" + std::to_string(j) + ",t)";
    }
    text += "can(" + label + "," + term(law.action) + ",t) :- " + fire + possible + ".\n";
  }
  text += "1 { out(" + number + ",_O," + keys + "," + term(law.action) + ",t) : can(" + number +
          ",_O," + keys + "," + term(law.action) + ",t) } 1 :- " + fire + ".\n";
  return text;
}

std::string Encoding::executabilityRules(const Executability& rule) const
{
  if (isPairwiseExclusion(rule))
  {
    return comment(rule.position) + ":- 2 { occ(_A,t-1) : agent(_A) }.\n";
  }
  Guards guards(description_);
  guards.body(rule.body);
  std::string occurrences;
  for (const auto& action : rule.actions)
  {
    if (const auto* atom = std::get_if<Atom>(&action))
    {
      guards.action(*atom);
      occurrences += ", occ(" + term(*atom) + ",t-1)";
    }
    else
    {
      const std::string variable = std::get<Term>(action).name;
      occurrences += ", occ(" + variable + ",t-1), agent(" + variable + ")";
    }
  }
  const std::string conditions = guards.text() + body(rule.body, "t-1") + ".\n";
  if (rule.actions.size() == 1)
  {
    const auto* atom = std::get_if<Atom>(&rule.actions[0]);
    const std::string only = atom != nullptr ? term(*atom) : std::get<Term>(rule.actions[0]).name;
    return comment(rule.position) + "imp(" + only + ",t-1) :- " +
           (atom != nullptr ? "#true" : "agent(" + only + ")") + conditions;
  }
  return comment(rule.position) + ":- #true" + occurrences + conditions;
}

std::string Encoding::transition() const
{
  std::string text = "{ h(_F,_V,t) } :- h(_F,_V,t-1), basic(_F).\n";
  if (!unequalRules().empty())
  {
    text += "{ ne(_F,_V,t) } :- ne(_F,_V,t-1).\n";  // f != v stays as it was, too
  }
  for (std::size_t i = 0; i < description_.causal_laws.size(); ++i)
  {
    text += lawRules(description_.causal_laws[i], i);
  }
  for (const Executability& rule : description_.executabilities)
  {
    text += executabilityRules(rule);
  }
  text += ":- occ(_A,t-1), imp(_A,t-1).\n";
  return text;
}

std::string Encoding::anyState()
{
  return "1 { h(_F,_V,0) : fv(_F,_V) } 1 :- basic(_F).\n";
}

void Encoding::Guards::add(const Term& term, const std::string& sort)
{
  if (term.is_variable)
  {
    auto& sorts = sorts_[term.name];
    if (std::find(sorts.begin(), sorts.end(), sort) == sorts.end())
    {
      sorts.push_back(sort);
    }
  }
}

Encoding::Guards& Encoding::Guards::fluent(const Atom& atom)
{
  const FluentDeclaration& declared = *description_.findFluent(atom.name);
  for (std::size_t i = 0; i < atom.arguments.size(); ++i)
  {
    add(atom.arguments[i], declared.argument_sorts[i]);
  }
  return *this;
}

Encoding::Guards& Encoding::Guards::literal(const Literal& literal)
{
  const FluentDeclaration& declared = *description_.findFluent(literal.atom.name);
  if (declared.value_sort)
  {
    add(literal.value, *declared.value_sort);
  }
  return fluent(literal.atom);
}

Encoding::Guards& Encoding::Guards::action(const Atom& atom)
{
  const ActionDeclaration& declared = *description_.findAction(atom.name);
  for (std::size_t i = 0; i < atom.arguments.size(); ++i)
  {
    add(atom.arguments[i], declared.argument_sorts[i]);
  }
  return *this;
}

Encoding::Guards& Encoding::Guards::body(const Body& body)
{
  for (const Condition& condition : body)
  {
    if (const auto* part = std::get_if<Literal>(&condition))
    {
      literal(*part);
    }
    else if (const auto* membership = std::get_if<Membership>(&condition))
    {
      if (!membership->negated)
      {
        add(membership->term, membership->sort);
      }
    }
  }
  return *this;
}

Encoding::Guards& Encoding::Guards::shared(const Guards& other, const Guards& known)
{
  for (const auto& [variable, sorts] : other.sorts_)
  {
    if (known.sorts_.count(variable) > 0)
    {
      for (const std::string& sort : sorts)
      {
        add({true, variable}, sort);
      }
    }
  }
  return *this;
}

std::string Encoding::Guards::text() const
{
  std::string text;
  for (const auto& [variable, sorts] : sorts_)
  {
    for (const std::string& sort : sorts)
    {
      text += ", sort(" + sort + "," + variable + ")";
    }
  }
  return text;
}

std::vector<std::string> Encoding::Guards::variables() const
{
  std::vector<std::string> names;
  for (const auto& [variable, sorts] : sorts_)
  {
    names.push_back(variable);
  }
  return names;
}

}  // namespace kr3::reasoner
