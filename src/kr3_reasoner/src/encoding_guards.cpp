// The part of Encoding that gives the variables of a rule their sorts.

#include <algorithm>

#include "encoding.hpp"

namespace kr3::reasoner
{

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

std::string Encoding::Guards::text(const std::set<std::string>& without) const
{
  std::string text;
  for (const auto& [variable, sorts] : sorts_)
  {
    for (const std::string& sort : without.count(variable) > 0 ? std::vector<std::string>{} : sorts)
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
