#pragma once

#include <algorithm>
#include <functional>
#include <map>

#include "ground_domain.hpp"

namespace kr3::reasoner::oracle
{

using Binding = std::map<std::string, std::string>;
using Domains = std::map<std::string, std::vector<std::string>>;  ///< of variables

inline std::string applied(const std::string& name, const std::vector<std::string>& arguments)
{
  std::string text = name;
  for (std::size_t i = 0; i < arguments.size(); ++i)
  {
    text += (i == 0 ? "(" : ", ") + arguments[i];
  }
  return arguments.empty() ? text : text + ")";
}

inline std::string valueOf(const Term& term, const Binding& binding)
{
  return term.is_variable ? binding.at(term.name) : term.name;
}

inline std::string applied(const Atom& atom, const Binding& binding)
{
  std::vector<std::string> arguments;
  for (const Term& term : atom.arguments)
  {
    arguments.push_back(valueOf(term, binding));
  }
  return applied(atom.name, arguments);
}

inline bool contains(const std::vector<std::string>& items, const std::string& item)
{
  return std::find(items.begin(), items.end(), item) != items.end();
}

inline bool compare(const Comparison& comparison, const Binding& binding)
{
  const std::string left = valueOf(comparison.left, binding);
  const std::string right = valueOf(comparison.right, binding);
  switch (comparison.op)
  {
    case Comparison::Operator::kEqual:
      return left == right;
    case Comparison::Operator::kNotEqual:
      return left != right;
    case Comparison::Operator::kLess:
      return std::stol(left) < std::stol(right);
    case Comparison::Operator::kLessEqual:
      return std::stol(left) <= std::stol(right);
    case Comparison::Operator::kGreater:
      return std::stol(left) > std::stol(right);
    case Comparison::Operator::kGreaterEqual:
      return std::stol(left) >= std::stol(right);
  }
  return false;
}

/// The elements that the positions of each variable of a statement have in common.
class Variables
{
public:
  explicit Variables(const Description& description) : description_(description) {}

  void narrow(const Term& term, const std::vector<std::string>& elements)
  {
    if (!term.is_variable)
    {
      return;
    }
    const auto [place, fresh] = domains_.emplace(term.name, elements);
    if (!fresh)
    {
      auto& kept = place->second;
      kept.erase(std::remove_if(kept.begin(), kept.end(),
                                [&](const auto& item) { return !contains(elements, item); }),
                 kept.end());
    }
  }

  void use(const Atom& atom, const std::vector<std::string>& sorts)
  {
    for (std::size_t i = 0; i < atom.arguments.size(); ++i)
    {
      narrow(atom.arguments[i], description_.findSort(sorts[i])->elements);
    }
  }

  void use(const Literal& literal)
  {
    const FluentDeclaration& fluent = *description_.findFluent(literal.atom.name);
    use(literal.atom, fluent.argument_sorts);
    if (fluent.value_sort)
    {
      narrow(literal.value, description_.findSort(*fluent.value_sort)->elements);
    }
  }

  void useAction(const Atom& atom)
  {
    use(atom, description_.findAction(atom.name)->argument_sorts);
  }

  void use(const Body& body)
  {
    for (const Condition& condition : body)
    {
      if (const auto* literal = std::get_if<Literal>(&condition))
      {
        use(*literal);
      }
      else if (const auto* membership = std::get_if<Membership>(&condition))
      {
        if (!membership->negated)
        {
          narrow(membership->term, description_.findSort(membership->sort)->elements);
        }
      }
    }
  }

  [[nodiscard]] const Domains& domains() const { return domains_; }

  /// Calls with every binding of the variables on top of `fixed`.
  void each(const Binding& fixed, const std::function<void(const Binding&)>& call) const
  {
    Binding binding = fixed;
    extend(domains_.begin(), binding, call);
  }

private:
  void extend(Domains::const_iterator next, Binding& binding,
              const std::function<void(const Binding&)>& call) const
  {
    if (next == domains_.end())
    {
      call(binding);
      return;
    }
    const auto& [name, elements] = *next;
    if (binding.count(name) > 0)
    {
      if (contains(elements, binding.at(name)))
      {
        extend(std::next(next), binding, call);
      }
      return;
    }
    for (const std::string& element : elements)
    {
      binding[name] = element;
      extend(std::next(next), binding, call);
    }
    binding.erase(name);
  }

  const Description& description_;
  Domains domains_;
};

}  // namespace kr3::reasoner::oracle
