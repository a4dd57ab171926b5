#include "grounder.hpp"

namespace kr3::reasoner::oracle
{

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

}  // namespace kr3::reasoner::oracle
