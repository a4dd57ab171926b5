#include "ground_domain.hpp"

#include <algorithm>
#include <functional>
#include <map>

#include <kr3_common/error.hpp>

namespace kr3::reasoner::oracle
{

namespace
{

using Binding = std::map<std::string, std::string>;
using Domains = std::map<std::string, std::vector<std::string>>;  ///< of variables

std::string applied(const std::string& name, const std::vector<std::string>& arguments)
{
  std::string text = name;
  for (std::size_t i = 0; i < arguments.size(); ++i)
  {
    text += (i == 0 ? "(" : ", ") + arguments[i];
  }
  return arguments.empty() ? text : text + ")";
}

std::string valueOf(const Term& term, const Binding& binding)
{
  return term.is_variable ? binding.at(term.name) : term.name;
}

std::string applied(const Atom& atom, const Binding& binding)
{
  std::vector<std::string> arguments;
  for (const Term& term : atom.arguments)
  {
    arguments.push_back(valueOf(term, binding));
  }
  return applied(atom.name, arguments);
}

bool contains(const std::vector<std::string>& items, const std::string& item)
{
  return std::find(items.begin(), items.end(), item) != items.end();
}

bool compare(const Comparison& comparison, const Binding& binding)
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

void Grounder::groundLaw(const CausalLaw& law)
{
  Variables body(description_);
  body.useAction(law.action);
  body.use(law.body);
  // The variables on which a choice depends: those of the action and of the effects.
  Variables key(description_);
  key.useAction(law.action);
  for (const Outcome& outcome : law.outcomes)
  {
    for (const Effect& effect : outcome.effects)
    {
      const FluentDeclaration& fluent = *description_.findFluent(effect.fluent.name);
      key.use(effect.fluent, fluent.argument_sorts);
      if (!effect.is_choice)
      {
        key.use(Literal{effect.fluent, effect.value, true});
        continue;
      }
      Variables choice(description_);
      choice.use(effect.choice);
      for (const auto& [name, elements] : choice.domains())
      {
        if (body.domains().count(name) > 0)
        {
          key.narrow({true, name}, elements);
        }
      }
    }
  }
  key.each({}, [&](const Binding& bound) {
    GroundLaw instance;
    instance.action = action_index_.at(applied(law.action, bound));
    body.each(bound, [&](const Binding& binding) {
      if (auto literals = bodyOf(law.body, binding))
      {
        instance.bodies.push_back(*literals);
      }
    });
    if (instance.bodies.empty())
    {
      return;
    }
    for (const Outcome& outcome : law.outcomes)
    {
      instance.outcomes.emplace_back();
      for (const Effect& effect : outcome.effects)
      {
        GroundEffect ground;
        ground.fluent = index_.at(applied(effect.fluent, bound));
        ground.is_choice = effect.is_choice;
        const GroundFluentInfo& fluent = domain_.fluents[static_cast<std::size_t>(ground.fluent)];
        if (!effect.is_choice)
        {
          ground.value = literalAt({effect.fluent, effect.value, true}, bound)->value;
        }
        for (std::size_t v = 0; effect.is_choice && v < fluent.values.size(); ++v)
        {
          Variables choice(description_);
          choice.use(Literal{effect.fluent, effect.value, true});
          choice.use(effect.choice);
          Binding with_value = bound;
          with_value[effect.value.name] = fluent.values[v];
          GroundEffect::Candidate candidate{static_cast<int>(v), {}};
          choice.each(with_value, [&](const Binding& binding) {
            if (auto literals = bodyOf(effect.choice, binding))
            {
              candidate.bodies.push_back(*literals);
            }
          });
          ground.candidates.push_back(std::move(candidate));
        }
        instance.outcomes.back().push_back(std::move(ground));
      }
    }
    domain_.laws.push_back(std::move(instance));
  });
}

void Grounder::groundExecutability(const Executability& rule)
{
  // An action variable stands for each of the robot's actions.
  std::vector<std::string> agent_actions;
  for (const GroundActionInfo& action : domain_.actions)
  {
    if (!action.exogenous)
    {
      agent_actions.push_back(action.name);
    }
  }
  Variables variables(description_);
  for (const auto& action : rule.actions)
  {
    if (const auto* atom = std::get_if<Atom>(&action))
    {
      variables.useAction(*atom);
    }
    else
    {
      variables.narrow(std::get<Term>(action), agent_actions);
    }
  }
  variables.use(rule.body);
  variables.each({}, [&](const Binding& binding) {
    const auto body = bodyOf(rule.body, binding);
    if (!body)
    {
      return;
    }
    GroundExecutability instance{{}, *body};
    for (const auto& action : rule.actions)
    {
      const auto* atom = std::get_if<Atom>(&action);
      const std::string name =
          atom != nullptr ? applied(*atom, binding) : binding.at(std::get<Term>(action).name);
      instance.actions.push_back(action_index_.at(name));
    }
    domain_.executabilities.push_back(std::move(instance));
  });
}

void Grounder::groundDefault(const Default& rule)
{
  Variables variables(description_);
  variables.use(rule.head);
  variables.use(rule.body);
  variables.each({}, [&](const Binding& binding) {
    if (auto body = bodyOf(rule.body, binding))
    {
      std::vector<std::string> arguments;
      for (const Term& term : rule.name.arguments)
      {
        arguments.push_back(valueOf(term, binding));
      }
      domain_.defaults.push_back(
          {rule.name.name, std::move(arguments), *literalAt(rule.head, binding), *body});
    }
  });
}

void Grounder::rank()
{
  // `prefer d1(X) over d2(X)` relates the instances of the two in which X is the same.
  const auto fits = [](const Atom& open, const GroundDefault& instance, Binding& binding) {
    bool same = open.name == instance.name;
    for (std::size_t i = 0; same && i < open.arguments.size(); ++i)
    {
      const Term& term = open.arguments[i];
      const std::string& argument = instance.arguments[i];
      same = (term.is_variable ? binding.emplace(term.name, argument).first->second : term.name) ==
             argument;
    }
    return same;
  };
  const int count = static_cast<int>(domain_.defaults.size());
  const auto at = [&](int i) { return domain_.defaults[static_cast<std::size_t>(i)]; };
  for (const Preference& preference : description_.preferences)
  {
    for (int i = 0; i < count; ++i)
    {
      for (int j = 0; j < count; ++j)
      {
        Binding binding;
        if (fits(preference.better, at(i), binding) && fits(preference.worse, at(j), binding))
        {
          domain_.better.emplace(i, j);
        }
      }
    }
  }
  for (int k = 0; k < count; ++k)
  {
    for (int i = 0; i < count; ++i)
    {
      for (int j = 0; j < count; ++j)
      {
        if (domain_.better.count({i, k}) > 0 && domain_.better.count({k, j}) > 0)
        {
          domain_.better.emplace(i, j);
        }
      }
    }
  }
}

}  // namespace

GroundDomain grounded(const Description& description)
{
  return Grounder(description).run();
}

std::optional<GroundLiteral> literalOf(const Literal& literal, const GroundDomain& domain)
{
  const std::string name = applied(literal.atom, {});
  for (std::size_t i = 0; i < domain.fluents.size(); ++i)
  {
    const GroundFluentInfo& fluent = domain.fluents[i];
    if (fluent.name == name)
    {
      const auto value = std::find(fluent.values.begin(), fluent.values.end(), literal.value.name);
      GroundLiteral result{static_cast<int>(i), static_cast<int>(value - fluent.values.begin()),
                           literal.equal};
      return fluent.boolean && !literal.equal ? GroundLiteral{result.fluent, 1 - result.value, true}
                                              : result;
    }
  }
  return std::nullopt;
}

int actionOf(const std::string& name, const GroundDomain& domain)
{
  const auto found = std::find_if(domain.actions.begin(), domain.actions.end(),
                                  [&](const GroundActionInfo& each) { return each.name == name; });
  if (found == domain.actions.end())
  {
    throw InternalError("unknown action " + name);
  }
  return static_cast<int>(found - domain.actions.begin());
}

bool staticHolds(const Literal& literal, const Description& description, const GroundDomain& domain)
{
  const std::string name = applied(literal.atom, {});
  const FluentDeclaration& fluent = *description.findFluent(literal.atom.name);
  if (!fluent.value_sort)
  {
    return (domain.true_statics.count(name) > 0) ==
           ((literal.value.name == "true") == literal.equal);
  }
  return (domain.true_statics.count(name + " = " + literal.value.name) > 0) == literal.equal;
}

std::string toString(const GroundLiteral& literal, const GroundDomain& domain)
{
  const GroundFluentInfo& fluent = domain.fluents[static_cast<std::size_t>(literal.fluent)];
  const std::string& value = fluent.values[static_cast<std::size_t>(literal.value)];
  if (fluent.boolean)
  {
    return (value == "false" ? "-" : "") + fluent.name;
  }
  return fluent.name + (literal.equal ? " = " : " != ") + value;
}

}  // namespace kr3::reasoner::oracle
