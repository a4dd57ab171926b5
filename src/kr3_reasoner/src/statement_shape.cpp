#include "statement_shape.hpp"

#include <algorithm>

namespace kr3::reasoner
{

namespace
{

/// Whether constraints may make a fluent depend on another (or itself), by names.
bool dependsOn(const Description& description, const std::string& fluent, const std::string& other)
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
    for (const StateConstraint& constraint : description.constraints)
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

}  // namespace

std::map<std::string, int> variableUses(const Body& body)
{
  std::map<std::string, int> uses;
  const auto use = [&](const Term& term) {
    if (term.is_variable)
    {
      ++uses[term.name];
    }
  };
  for (const Condition& condition : body)
  {
    if (const auto* literal = std::get_if<Literal>(&condition))
    {
      std::for_each(literal->atom.arguments.begin(), literal->atom.arguments.end(), use);
      use(literal->value);
    }
    else if (const auto* comparison = std::get_if<Comparison>(&condition))
    {
      use(comparison->left);
      use(comparison->right);
    }
    else
    {
      use(std::get<Membership>(condition).term);
    }
  }
  return uses;
}

std::set<std::string> variablesOf(const std::vector<Term>& terms)
{
  std::set<std::string> names;
  for (const Term& term : terms)
  {
    if (term.is_variable)
    {
      names.insert(term.name);
    }
  }
  return names;
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

bool isCircular(const Description& description, const StateConstraint& constraint,
                const Condition& condition)
{
  const auto* literal = std::get_if<Literal>(&condition);
  if (literal == nullptr || !constraint.head || literal->equal)
  {
    return false;
  }
  const FluentDeclaration& fluent = *description.findFluent(literal->atom.name);
  return fluent.value_sort && fluent.kind != FluentKind::kStatic &&
         dependsOn(description, literal->atom.name, constraint.head->atom.name);
}

}  // namespace kr3::reasoner
