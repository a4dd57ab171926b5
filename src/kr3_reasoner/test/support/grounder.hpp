#pragma once

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bindings.hpp"

namespace kr3::reasoner::oracle
{

/// Instantiates the statements of a description.
class Grounder
{
public:
  explicit Grounder(const Description& description) : description_(description) {}

  GroundDomain run()
  {
    declare();
    deriveStatics();
    for (const StateConstraint& constraint : description_.constraints)
    {
      if (!isStatic(constraint.head))
      {
        groundConstraint(constraint);
      }
    }
    for (const CausalLaw& law : description_.causal_laws)
    {
      groundLaw(law);
    }
    for (const Executability& rule : description_.executabilities)
    {
      groundExecutability(rule);
    }
    for (const Default& rule : description_.defaults)
    {
      groundDefault(rule);
    }
    rank();
    return std::move(domain_);
  }

private:
  [[nodiscard]] bool isStatic(const std::optional<Literal>& literal) const
  {
    return literal && description_.findFluent(literal->atom.name)->kind == FluentKind::kStatic;
  }

  void declare()
  {
    for (const FluentDeclaration& fluent : description_.fluents)
    {
      if (fluent.kind == FluentKind::kStatic)
      {
        continue;
      }
      const std::vector<std::string> values =
          fluent.value_sort ? description_.findSort(*fluent.value_sort)->elements
                            : std::vector<std::string>{"false", "true"};
      for (const std::string& name : instances(fluent.name, fluent.argument_sorts))
      {
        if (!values.empty())
        {
          index_[name] = static_cast<int>(domain_.fluents.size());
          domain_.fluents.push_back(
              {name, values, !fluent.value_sort, fluent.kind == FluentKind::kDefined});
        }
      }
    }
    for (const ActionDeclaration& action : description_.actions)
    {
      for (const std::string& name : instances(action.name, action.argument_sorts))
      {
        action_index_[name] = static_cast<int>(domain_.actions.size());
        domain_.actions.push_back({name, action.exogenous});
      }
    }
  }

  [[nodiscard]] std::vector<std::string> instances(const std::string& symbol,
                                                   const std::vector<std::string>& sorts) const
  {
    Variables variables(description_);
    Atom atom{symbol, {}, {}};
    for (std::size_t i = 0; i < sorts.size(); ++i)
    {
      atom.arguments.push_back({true, "_" + std::to_string(i)});
    }
    variables.use(atom, sorts);
    std::vector<std::string> names;
    variables.each({}, [&](const Binding& binding) { names.push_back(applied(atom, binding)); });
    return names;
  }

  void deriveStatics()
  {
    for (const Literal& fact : description_.static_facts)
    {
      if (fact.equal && fact.value.name != "false")
      {
        domain_.true_statics.insert(staticText(fact, {}));
      }
    }
    // A static defined through the falsity of another is defined after it in the file.
    for (std::size_t before = 0; before != domain_.true_statics.size() + 1;)
    {
      before = domain_.true_statics.size() + 1;
      for (const StateConstraint& constraint : description_.constraints)
      {
        if (!isStatic(constraint.head))
        {
          continue;
        }
        Variables variables(description_);
        variables.use(*constraint.head);
        variables.use(constraint.body);
        variables.each({}, [&](const Binding& binding) {
          if (bodyOf(constraint.body, binding))
          {
            domain_.true_statics.insert(staticText(*constraint.head, binding));
          }
        });
      }
    }
  }

  [[nodiscard]] static std::string staticText(const Literal& literal, const Binding& binding)
  {
    const std::string value = valueOf(literal.value, binding);
    return applied(literal.atom, binding) + (value == "true" ? "" : " = " + value);
  }

  [[nodiscard]] std::optional<GroundLiteral> literalAt(const Literal& literal,
                                                       const Binding& binding) const
  {
    const auto found = index_.find(applied(literal.atom, binding));
    if (found == index_.end())
    {
      return std::nullopt;
    }
    const GroundFluentInfo& fluent = domain_.fluents[static_cast<std::size_t>(found->second)];
    const auto value =
        std::find(fluent.values.begin(), fluent.values.end(), valueOf(literal.value, binding));
    GroundLiteral result{found->second, static_cast<int>(value - fluent.values.begin()),
                         literal.equal};
    if (fluent.boolean && !result.equal)
    {
      result = {result.fluent, 1 - result.value, true};
    }
    return result;
  }

  /// The fluents' literals of a body whose other conditions hold; nothing when one does not.
  [[nodiscard]] std::optional<GroundBody> bodyOf(const Body& body, const Binding& binding) const
  {
    GroundBody literals;
    for (const Condition& condition : body)
    {
      bool holds = true;
      if (const auto* comparison = std::get_if<Comparison>(&condition))
      {
        holds = compare(*comparison, binding);
      }
      else if (const auto* membership = std::get_if<Membership>(&condition))
      {
        holds = contains(description_.findSort(membership->sort)->elements,
                         valueOf(membership->term, binding)) != membership->negated;
      }
      else
      {
        const auto& literal = std::get<Literal>(condition);
        if (isStatic(literal))
        {
          Literal bound = literal;
          for (Term& term : bound.atom.arguments)
          {
            term = {false, valueOf(term, binding)};
          }
          bound.value = {false, valueOf(bound.value, binding)};
          holds = staticHolds(bound, description_, domain_);
        }
        else if (const auto fluent = literalAt(literal, binding))
        {
          literals.push_back(*fluent);
        }
        else
        {
          holds = false;  // a fluent without values
        }
      }
      if (!holds)
      {
        return std::nullopt;
      }
    }
    return literals;
  }

  void groundConstraint(const StateConstraint& constraint)
  {
    Variables variables(description_);
    if (constraint.head)
    {
      variables.use(*constraint.head);
    }
    variables.use(constraint.body);
    variables.each({}, [&](const Binding& binding) {
      const auto body = bodyOf(constraint.body, binding);
      if (body && constraint.head)
      {
        domain_.constraints.push_back({literalAt(*constraint.head, binding), *body});
      }
      else if (body)
      {
        domain_.constraints.push_back({std::nullopt, *body});
      }
    });
  }

  void groundLaw(const CausalLaw& law);
  void groundExecutability(const Executability& rule);
  void groundDefault(const Default& rule);
  void rank();

  const Description& description_;
  GroundDomain domain_;
  std::map<std::string, int> index_;
  std::map<std::string, int> action_index_;
};

}  // namespace kr3::reasoner::oracle
