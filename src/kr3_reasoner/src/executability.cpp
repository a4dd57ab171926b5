#include <algorithm>
#include <functional>
#include <map>

#include "instances.hpp"
#include "kr3_reasoner/transition_system.hpp"

namespace kr3::reasoner
{

namespace
{

class BodyInstances
{
public:
  BodyInstances(const Description& description, const Body& body)
    : description_(description), body_(body)
  {
  }

  [[nodiscard]] std::vector<std::vector<Literal>> under(const Binding& binding)
  {
    instances_.clear();
    std::map<std::string, std::string> open;  // variable -> a sort it stands in
    const auto note = [&](const Term& term, const std::string& sort) {
      if (term.is_variable && binding.count(term.name) == 0)
      {
        open.emplace(term.name, sort);
      }
    };
    for (const Condition& condition : body_)
    {
      if (const auto* literal = std::get_if<Literal>(&condition))
      {
        const FluentDeclaration& fluent = *description_.findFluent(literal->atom.name);
        for (std::size_t i = 0; i < literal->atom.arguments.size(); ++i)
        {
          note(literal->atom.arguments[i], fluent.argument_sorts[i]);
        }
        if (fluent.value_sort)
        {
          note(literal->value, *fluent.value_sort);
        }
      }
      else if (const auto* membership = std::get_if<Membership>(&condition))
      {
        note(membership->term, membership->sort);
      }
    }
    bind({open.begin(), open.end()}, binding);
    return std::move(instances_);
  }

private:
  struct OpenVariable
  {
    OpenVariable(const std::pair<const std::string, std::string>& item)
      : name(item.first), sort(item.second)
    {
    }
    std::string name;
    std::string sort;
  };

  void bind(std::vector<OpenVariable> open, const Binding& binding)
  {
    if (open.empty())
    {
      finish(binding);
      return;
    }
    const OpenVariable variable = open.back();
    open.pop_back();
    for (const std::string& element : description_.findSort(variable.sort)->elements)
    {
      Binding longer = binding;
      longer.emplace(variable.name, element);
      bind(open, longer);
    }
  }

  [[nodiscard]] bool inSort(const std::string& constant, const std::string& sort) const
  {
    const auto& elements = description_.findSort(sort)->elements;
    return std::find(elements.begin(), elements.end(), constant) != elements.end();
  }

  [[nodiscard]] bool fits(const Literal& literal) const
  {
    const FluentDeclaration& fluent = *description_.findFluent(literal.atom.name);
    for (std::size_t i = 0; i < literal.atom.arguments.size(); ++i)
    {
      if (!inSort(literal.atom.arguments[i].name, fluent.argument_sorts[i]))
      {
        return false;
      }
    }
    return !fluent.value_sort || inSort(literal.value.name, *fluent.value_sort);
  }

  void finish(const Binding& binding)
  {
    std::vector<Literal> literals;
    for (const Condition& condition : body_)
    {
      if (const auto* literal = std::get_if<Literal>(&condition))
      {
        literals.push_back(bound(*literal, binding));
        if (!fits(literals.back()))
        {
          return;
        }
      }
      else if (const auto* comparison = std::get_if<Comparison>(&condition))
      {
        if (!holds(bound(comparison->left, binding).name, comparison->op,
                   bound(comparison->right, binding).name))
        {
          return;
        }
      }
      else
      {
        const auto& membership = std::get<Membership>(condition);
        if (inSort(bound(membership.term, binding).name, membership.sort) == membership.negated)
        {
          return;
        }
      }
    }
    instances_.push_back(std::move(literals));
  }

  const Description& description_;
  const Body& body_;
  std::vector<std::vector<Literal>> instances_;
};

}  // namespace

std::vector<std::vector<Literal>> executabilityBodies(const Description& description,
                                                      const Atom& ground_action)
{
  std::vector<std::vector<Literal>> bodies;
  for (const Executability& rule : description.executabilities)
  {
    const auto* open = rule.actions.size() == 1 ? std::get_if<Atom>(&rule.actions[0]) : nullptr;
    Binding binding;
    if (open != nullptr && unify(*open, ground_action, binding))
    {
      const auto instances = BodyInstances(description, rule.body).under(binding);
      bodies.insert(bodies.end(), instances.begin(), instances.end());
    }
  }
  return bodies;
}

}  // namespace kr3::reasoner
