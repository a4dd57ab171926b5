#include <algorithm>
#include <map>

#include "step_parts.hpp"

namespace kr3::reasoner
{

namespace
{

using AtomId = StepProgram::AtomId;

void addRule(const StepContext& context, bool choice, AtomId head,
             const std::vector<AtomId>& positive)
{
  const std::vector<std::int32_t> body(positive.begin(), positive.end());
  context.program.effects.addRule(choice, {&head, &head + (head == 0 ? 0 : 1)},
                                  {body.data(), body.data() + body.size()});
}

bool isDeterministic(const CausalLaw& law)
{
  return law.outcomes.size() == 1 && law.outcomes[0].label.empty() &&
         std::none_of(law.outcomes[0].effects.begin(), law.outcomes[0].effects.end(),
                      [](const Effect& effect) { return effect.is_choice; });
}

void groundDeterministic(const StepContext& context, const CausalLaw& law)
{
  const int action = context.vocabulary.actionSymbol(law.action.name);
  for (const Effect& effect : law.outcomes[0].effects)
  {
    StepBody body(context);
    const std::vector<Slot> arguments = body.reader().action(law.action);
    const LiteralPattern head = body.reader().literal({effect.fluent, effect.value, true});
    std::set<std::string> used = variablesOf(law.action.arguments);
    used.merge(variablesOf(effect.fluent.arguments));
    used.merge(variablesOf({effect.value}));
    body.addBefore(law.body, used);
    std::vector<bool> wanted(body.reader().variables().size(), false);
    markVariables(arguments, wanted);
    markVariables(head.arguments, wanted);
    markVariables({head.value}, wanted);
    std::vector<std::int32_t> literals;
    body.forEach(wanted, [&](const RuleBinding& binding) {
      literals.clear();
      const int value = context.signature.value(head.symbol, head.arguments, head.value, binding);
      if (value < 0 || !body.write(binding, literals))
      {
        return;
      }
      literals.push_back(static_cast<std::int32_t>(
          context.atoms.occurs(context.signature.action(action, arguments, binding))));
      const AtomId atom = context.atoms.now(value);
      context.program.effects.addRule(false, {&atom, &atom + 1},
                                      {literals.data(), literals.data() + literals.size()});
    });
  }
}

/// A law with several outcomes, or one that chooses a value: for each instance of the action and of
/// the effects' own variables one outcome is taken, of those whose choices have a candidate.
class NondeterministicLaw
{
public:
  NondeterministicLaw(const StepContext& context, const CausalLaw& law, std::size_t index)
    : context_(context), law_(law), index_(index), body_(context)
  {
    action_ = context.vocabulary.actionSymbol(law.action.name);
    arguments_ = body_.reader().action(law.action);
    readKey();
  }

  void ground()
  {
    const std::size_t num_variables = body_.reader().variables().size();
    std::vector<bool> wanted(num_variables, false);
    for (const std::size_t variable : key_)
    {
      wanted[variable] = true;
    }
    std::map<std::vector<ConstantId>, AtomId> fired;
    std::vector<std::int32_t> literals;
    body_.forEach(wanted, [&](const RuleBinding& binding) {
      literals.clear();
      if (!body_.write(binding, literals))
      {
        return;
      }
      std::vector<ConstantId> key;
      for (const std::size_t variable : key_)
      {
        key.push_back(binding[variable]);
      }
      AtomId& fires = fired[std::move(key)];
      fires = fires == 0 ? context_.atoms.fresh() : fires;
      literals.push_back(static_cast<std::int32_t>(
          context_.atoms.occurs(context_.signature.action(action_, arguments_, binding))));
      context_.program.effects.addRule(false, {&fires, &fires + 1},
                                       {literals.data(), literals.data() + literals.size()});
    });
    for (const auto& [key, fires] : fired)
    {
      RuleBinding binding(num_variables, kUnbound);
      for (std::size_t i = 0; i < key_.size(); ++i)
      {
        binding[key_[i]] = key[i];
      }
      addOutcomes(binding, fires);
    }
  }

private:
  /// Variables of body and action that a choice speaks of: it is made for each of their values,
  /// which must be of the sorts that they have there.
  void addShared(const Effect& effect, const std::set<std::string>& known,
                 std::set<std::string>& key)
  {
    StepBody choice(context_);
    for (const Condition& condition : effect.choice)
    {
      choice.addBefore(condition);
    }
    const ConditionReader& reader = choice.reader();
    for (std::size_t v = 0; v < reader.variables().size(); ++v)
    {
      if (known.count(reader.variables()[v]) > 0)
      {
        key.insert(reader.variables()[v]);
        for (const int sort : reader.conditions().variable_sorts[v])
        {
          static_cast<void>(body_.reader().slot({true, reader.variables()[v]}, sort));
        }
      }
    }
  }

  /// Reads body and effects; finds the variables that tell one choice from another.
  void readKey()
  {
    ConditionReader& reader = body_.reader();
    std::set<std::string> known = variablesOf(law_.action.arguments);
    for (const auto& [name, uses] : variableUses(law_.body))
    {
      known.insert(name);
    }
    std::set<std::string> key = variablesOf(law_.action.arguments);
    for (const Outcome& outcome : law_.outcomes)
    {
      for (const Effect& effect : outcome.effects)
      {
        key.merge(variablesOf(effect.fluent.arguments));
        if (!effect.is_choice)
        {
          key.merge(variablesOf({effect.value}));
          static_cast<void>(reader.literal({effect.fluent, effect.value, true}));
          continue;
        }
        const FluentDeclaration& fluent =
            *context_.vocabulary.description().findFluent(effect.fluent.name);
        static_cast<void>(reader.arguments(effect.fluent, fluent.argument_sorts));
        addShared(effect, known, key);
      }
    }
    body_.addBefore(law_.body, key);
    for (const std::string& name : key)
    {
      const int variable = reader.variable(name);
      if (variable >= 0)
      {
        key_.push_back(static_cast<std::size_t>(variable));
      }
    }
  }

  void addOutcomes(const RuleBinding& binding, AtomId fires)
  {
    std::vector<AtomId> taken;
    for (std::size_t i = 0; i < law_.outcomes.size(); ++i)
    {
      const AtomId out = context_.atoms.fresh();
      const AtomId can = context_.atoms.fresh();
      std::vector<AtomId> possible = {fires};
      for (const Effect& effect : law_.outcomes[i].effects)
      {
        if (effect.is_choice)
        {
          possible.push_back(addChoice(effect, binding, fires, out));
          continue;
        }
        addCertain(effect, binding, out);
      }
      addRule(context_, false, can, possible);
      addRule(context_, true, out, {fires, can});
      context_.program.outcomes.push_back(
          {index_, i, context_.signature.action(action_, arguments_, binding), out});
      taken.push_back(out);
    }
    addExactlyOne(taken, fires);
  }

  void addCertain(const Effect& effect, const RuleBinding& binding, AtomId out)
  {
    ConditionReader reader = body_.reader();
    const LiteralPattern head = reader.literal({effect.fluent, effect.value, true});
    const int value = context_.signature.value(head.symbol, head.arguments, head.value, binding);
    if (value >= 0)
    {
      addRule(context_, false, context_.atoms.now(value), {out});
    }
  }

  /// One of the values that fulfil the condition. @return that there is one
  AtomId addChoice(const Effect& effect, const RuleBinding& binding, AtomId fires, AtomId out)
  {
    StepBody body(context_);
    const LiteralPattern head = body.reader().literal({effect.fluent, effect.value, true});
    for (const Condition& condition : effect.choice)
    {
      body.addBefore(condition);
    }
    const ConditionReader& reader = body.reader();
    std::vector<bool> given(reader.variables().size(), false);
    RuleBinding start(given.size(), kUnbound);
    for (const std::size_t variable : key_)
    {
      const int here = reader.variable(body_.reader().variables()[variable]);
      if (here >= 0)
      {
        given[static_cast<std::size_t>(here)] = true;
        start[static_cast<std::size_t>(here)] = binding[variable];
      }
    }
    std::vector<bool> wanted(given.size(), false);
    markVariables(head.arguments, wanted);
    markVariables({head.value}, wanted);
    body.markLiterals(wanted);
    const AtomId any = context_.atoms.fresh();
    std::map<int, AtomId> candidates;  // by value
    std::vector<std::int32_t> literals;
    Join(reader.conditions(), context_.statics, given, wanted, context_.limit)
        .forEach(start, [&](const RuleBinding& instance) {
          literals.assign({static_cast<std::int32_t>(fires)});
          const int value =
              context_.signature.value(head.symbol, head.arguments, head.value, instance);
          if (value < 0 || !body.write(instance, literals))
          {
            return;
          }
          AtomId& candidate = candidates[value];
          candidate = candidate == 0 ? context_.atoms.fresh() : candidate;
          context_.program.effects.addRule(false, {&candidate, &candidate + 1},
                                           {literals.data(), literals.data() + literals.size()});
        });
    std::vector<AtomId> picked;
    for (const auto& [value, candidate] : candidates)
    {
      picked.push_back(context_.atoms.fresh());
      addRule(context_, false, any, {candidate});
      addRule(context_, true, picked.back(), {out, candidate});
      addRule(context_, false, context_.atoms.now(value), {picked.back()});
    }
    addExactlyOne(picked, out);
    return any;
  }

  /// If the condition holds, exactly one of the atoms, which need it.
  void addExactlyOne(const std::vector<AtomId>& atoms, AtomId condition)
  {
    std::vector<std::int32_t> none = {static_cast<std::int32_t>(condition)};
    std::vector<GroundProgram::BodyLiteral> two;
    for (const AtomId atom : atoms)
    {
      none.push_back(-static_cast<std::int32_t>(atom));
      two.push_back({static_cast<std::int32_t>(atom), 1});
    }
    context_.program.effects.addRule(false, {nullptr, nullptr},
                                     {none.data(), none.data() + none.size()});
    if (two.size() > 1)
    {
      context_.program.effects.addWeightRule(false, {nullptr, nullptr}, 2,
                                             {two.data(), two.data() + two.size()});
    }
  }

  const StepContext& context_;
  const CausalLaw& law_;
  std::size_t index_;
  StepBody body_;
  int action_ = 0;
  std::vector<Slot> arguments_;
  std::vector<std::size_t> key_;  // variables
};

}  // namespace

void groundLaw(const StepContext& context, const CausalLaw& law, std::size_t index)
{
  if (!context.signature.hasAction(context.vocabulary.actionSymbol(law.action.name)))
  {
    return;
  }
  if (isDeterministic(law))
  {
    groundDeterministic(context, law);
    return;
  }
  NondeterministicLaw(context, law, index).ground();
}

}  // namespace kr3::reasoner
