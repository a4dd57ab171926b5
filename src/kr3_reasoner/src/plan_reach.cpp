#include "plan_reach.hpp"

#include <algorithm>
#include <map>
#include <unordered_map>

namespace kr3::reasoner
{

namespace
{

using Kind = GroundableRule::Kind;
using Role = RuleLiteral::Role;

const auto kAnything = [](const RuleLiteral&, const RuleBinding&) { return false; };

}  // namespace

PlanReach::PlanReach(const GroundRules& rules, const Consequences& consequences, int now)
  : rules_(rules), consequences_(consequences), now_(now)
{
}

Literal PlanReach::toLiteral(const GroundAtom& atom, ConstantId value) const
{
  Literal literal;
  literal.atom.name = rules_.description().fluents[atom.symbol].name;
  for (const ConstantId argument : atom.arguments)
  {
    literal.atom.arguments.push_back({false, rules_.name(argument)});
  }
  literal.value.name = rules_.name(value);
  return literal;
}

GroundFluent PlanReach::toFluent(const GroundAtom& atom) const
{
  const FluentDeclaration& declared = rules_.description().fluents[atom.symbol];
  GroundFluent fluent;
  fluent.name = rules_.fluentText(atom);
  fluent.symbol = declared.name;
  for (const ConstantId argument : atom.arguments)
  {
    fluent.arguments.push_back(rules_.name(argument));
  }
  fluent.kind = declared.kind;
  fluent.values = declared.value_sort
                      ? rules_.description().findSort(*declared.value_sort)->elements
                      : std::vector<std::string>{"false", "true"};
  return fluent;
}

/// Whether a literal is false in all states that matter: false now, and nothing changed it since.
bool PlanReach::refuted(const RuleLiteral& literal, const RuleBinding& binding,
                        const Fluents& changed) const
{
  const GroundAtom fluent = GroundRules::bound(literal, binding);
  const ConstantId value = GroundRules::bound(literal.value, binding);
  if (value == kUnbound || rules_.isDefined(fluent.symbol) || changed_.count(fluent) > 0 ||
      changed.count(fluent) > 0)
  {
    return false;
  }
  const Literal ground = toLiteral(fluent, value);
  return literal.equal ? !consequences_.inSome(ground, now_) : consequences_.inAll(ground, now_);
}

void PlanReach::followActions(Step& step) const
{
  std::unordered_map<GroundAtom, int, GroundAtomHash> effects;
  for (const GroundAtom& action : step.actions)
  {
    for (const std::size_t index : rules_.rulesOfAction(action.symbol))
    {
      const GroundableRule& rule = rules_.rules()[index];
      const bool joint =
          rule.kind == Kind::kExecutability && (rule.actions.size() > 1 || rule.any_action);
      if (rule.kind != Kind::kLaw && !(joint && step.actions.size() > 1))
      {
        continue;
      }
      for (const RuleAction& mentioned : rule.actions)
      {
        RuleBinding binding;
        if (mentioned.symbol != action.symbol ||
            !rules_.unify(rule, mentioned.arguments, action.arguments, binding))
        {
          continue;
        }
        rules_.forEachInstance(
            rule, binding, {},
            [&](const RuleLiteral& literal, const RuleBinding& bound) {
          return refuted(literal, bound, {});
            },
            [&](const RuleBinding& instance) {
          for (const RuleLiteral& literal : rule.literals)
          {
            const GroundAtom fluent = GroundRules::bound(literal, instance);
            if (literal.role == Role::kEffect)
            {
              step.changed.insert(fluent);
              step.harmless = step.harmless && ++effects[fluent] == 1;
            }
            else
            {
              step.relevant.insert(fluent);
              step.harmless = step.harmless && literal.role == Role::kBody && !joint;
            }
          }
          const bool chooses = rule.kind == Kind::kLaw &&
                               rules_.description().causal_laws[rule.index].outcomes.size() +
                                       std::count_if(
                                           rule.literals.begin(), rule.literals.end(),
                                           [&](const RuleLiteral& literal) {
            return literal.role == Role::kEffect && literal.value.is_variable &&
                   GroundRules::bound(literal.value, instance) == kUnbound;
                                           }) >
                               1;
          step.harmless = step.harmless && !chooses && !joint;
        });
      }
    }
  }
  for (const std::size_t index : rules_.rulesOfAnyAction())
  {
    const GroundableRule& rule = rules_.rules()[index];
    if (step.actions.size() > 1 || rule.actions.size() == 1)
    {
      rules_.forEachInstance(rule, RuleBinding(rule.in_fluent.size(), kUnbound), {}, kAnything,
                             [&](const RuleBinding& instance) {
        for (const RuleLiteral& literal : rule.literals)
        {
          step.relevant.insert(GroundRules::bound(literal, instance));
          step.harmless = false;
        }
      });
    }
  }
}

void PlanReach::followConstraints(Step& step) const
{
  for (std::size_t before = 0; before != step.changed.size();)
  {
    before = step.changed.size();
    const std::vector<GroundAtom> changed(step.changed.begin(), step.changed.end());
    for (const GroundAtom& fluent : changed)
    {
      for (const std::size_t index : rules_.rulesOfFluent(fluent.symbol))
      {
        const GroundableRule& rule = rules_.rules()[index];
        for (const RuleLiteral& literal : rule.literals)
        {
          RuleBinding binding;
          if (rule.kind != Kind::kConstraint || literal.symbol != fluent.symbol ||
              !rules_.unify(rule, literal.arguments, fluent.arguments, binding))
          {
            continue;
          }
          rules_.forEachInstance(
              rule, binding, {},
              [&](const RuleLiteral& part, const RuleBinding& bound) {
            return refuted(part, bound, step.changed);
              },
              [&](const RuleBinding& instance) {
            for (const RuleLiteral& part : rule.literals)
            {
              const GroundAtom other = GroundRules::bound(part, instance);
              step.relevant.insert(other);
              if (part.role == Role::kHead)
              {
                step.changed.insert(other);
                step.harmless = step.harmless && rules_.isDefined(other.symbol);
              }
            }
            step.harmless = step.harmless && rule.literals[0].role == Role::kHead;
          });
        }
      }
    }
  }
}

std::vector<GroundFluent> PlanReach::next(const std::vector<std::string>& actions)
{
  Step step;
  for (const std::string& text : actions)
  {
    step.actions.push_back(rules_.ground(parseGroundAction(text, rules_.description()), true));
  }
  followActions(step);
  followConstraints(step);
  std::map<std::string, GroundFluent> open;
  for (const Fluents* fluents : {&step.relevant, &step.changed})
  {
    for (const GroundAtom& atom : *fluents)
    {
      GroundFluent fluent = toFluent(atom);
      std::string name = fluent.name;
      open.emplace(std::move(name), std::move(fluent));
    }
  }
  changed_.insert(step.changed.begin(), step.changed.end());
  std::vector<GroundFluent> fluents;
  for (auto& [name, fluent] : open)
  {
    if (!step.harmless)
    {
      fluents.push_back(std::move(fluent));
    }
  }
  return fluents;
}

}  // namespace kr3::reasoner
