#include "relevant_rules.hpp"

#include <algorithm>

namespace kr3::reasoner
{

namespace
{

std::string keyOf(const std::vector<Literal>& literals)
{
  std::string key;
  for (const Literal& literal : literals)
  {
    key += toString(literal) + ";";
  }
  return key;
}

std::string keyOf(const SourcePosition& position)
{
  return position.file + ":" + std::to_string(position.line) + ":" +
         std::to_string(position.column) + "|";
}

/// Binds the literal's atom to a ground fluent.
std::optional<Binding> about(const Literal& literal, const Atom& fluent, const Binding& start = {})
{
  Binding binding = start;
  if (!unify(literal.atom, fluent, binding))
  {
    return std::nullopt;
  }
  return binding;
}

}  // namespace

RelevantRules::RelevantRules(const Description& description, const Words& words,
                             const Instances& instances, const std::vector<CheckedRecord>& records,
                             const Laws& laws, const Cited& kept, const InitialWorld& world,
                             const Atom& fluent, bool wide, const SearchLimit& limit)
  : description_(description)
  , words_(words)
  , instances_(instances)
  , records_(records)
  , statements_(laws)
  , kept_(kept)
  , wide_(wide)
{
  findOccurrences(world);
  findLaws();
  want(fluent);
  for (std::size_t next = 0; next < fluents_.size(); ++next)
  {
    limit.check();
    const Atom here = fluents_[next];
    expand(here);
  }
}

bool RelevantRules::isRelevant(const Atom& fluent) const
{
  return wanted_.count(toString(fluent)) > 0;
}

void RelevantRules::findOccurrences(const InitialWorld& world)
{
  for (std::size_t i = 0; i < records_.size(); ++i)
  {
    if (records_[i].isAction() && kept_.records.count(i) > 0)
    {
      const Atom& action = records_[i].action;
      occurrences_.push_back({action, records_[i].record.step, i, std::nullopt, false,
                              description_.findAction(action.name)->exogenous});
    }
  }
  for (std::size_t i = 0; i < world.assumed.size(); ++i)
  {
    const AssumedAction assumed = words_.assumedAction(world.assumed[i]);
    if (assumed.step < 0)
    {
      continue;
    }
    const auto attempt =
        std::find_if(occurrences_.begin(), occurrences_.end(), [&](const Occurrence& occurrence) {
          return occurrence.step == assumed.step && occurrence.record != kNoRecord &&
                 records_[occurrence.record].record.kind == RecordKind::kAttempted &&
                 toString(occurrence.action) == toString(assumed.action);
        });
    if (!assumed.failed)
    {
      occurrences_.push_back({assumed.action, assumed.step, kNoRecord, i, false, true});
    }
    else if (attempt != occurrences_.end())
    {
      attempt->failed = true;
      attempt->assumed = i;
    }
  }
}

void RelevantRules::findLaws()
{
  for (std::size_t i = 0; i < occurrences_.size(); ++i)
  {
    for (std::size_t number = 0; number < description_.causal_laws.size(); ++number)
    {
      const CausalLaw& law = description_.causal_laws[number];
      Binding start;
      if (!kept_.hasLaw(statements_.ofCausalLaw(number)) ||
          !unify(law.action, occurrences_[i].action, start))
      {
        continue;
      }
      StatementParts parts{{&law.action}, {}, {}, {&law.body}};
      std::vector<Literal> effects;  // kept alive below
      for (const Outcome& outcome : law.outcomes)
      {
        for (const Effect& effect : outcome.effects)
        {
          if (!effect.is_choice)
          {
            effects.push_back({effect.fluent, effect.value, true});
          }
          else
          {
            parts.fluents.push_back(&effect.fluent);
          }
        }
      }
      for (const Literal& effect : effects)
      {
        parts.literals.push_back(&effect);
      }
      const std::size_t first = laws_.size();
      instances_.forEach(parts, start, [&](const Binding& binding) {
        addLaw(i, law, statements_.ofCausalLaw(number), binding);
      });
      // instances that differ in their conditions only are one law that applies if one of them
      // holds
      std::map<std::string, std::size_t> by_effects;
      std::vector<GroundLaw> merged;
      for (std::size_t k = first; k < laws_.size(); ++k)
      {
        std::string key;
        for (const auto& outcome : laws_[k].outcomes)
        {
          for (const GroundEffect& effect : outcome)
          {
            key += toString(effect.fluent) + "=";
            for (const GroundEffect::Option& option : effect.options)
            {
              key += option.value + "{" + keyOf(option.condition) + "}";
            }
          }
          key += "|";
        }
        const auto known = by_effects.emplace(key, merged.size());
        if (known.second)
        {
          merged.push_back(laws_[k]);
        }
        else
        {
          merged[known.first->second].bodies.push_back(laws_[k].bodies.front());
        }
      }
      laws_.resize(first);
      laws_.insert(laws_.end(), merged.begin(), merged.end());
    }
  }
}

void RelevantRules::addLaw(std::size_t occurrence, const CausalLaw& law, std::size_t number,
                           const Binding& binding)
{
  GroundLaw ground;
  ground.occurrence = occurrence;
  ground.position = law.position;
  ground.law = number;
  ground.bodies.push_back(instances_.literals(law.body, binding));
  for (const Outcome& outcome : law.outcomes)
  {
    ground.outcomes.emplace_back();
    for (const Effect& effect : outcome.effects)
    {
      GroundEffect ground_effect{bound(effect.fluent, binding), {}};
      if (!effect.is_choice)
      {
        const auto value = binding.find(effect.value.name);
        ground_effect.options.push_back(
            {effect.value.is_variable && value != binding.end() ? value->second : effect.value.name,
             {}});
      }
      else
      {
        const Literal picked{effect.fluent, effect.value, true};
        instances_.forEach({{}, {}, {&picked}, {&effect.choice}}, binding,
                           [&](const Binding& choice) {
          const std::string value = bound(picked, choice).value.name;
          std::vector<Literal> condition = instances_.literals(effect.choice, choice);
          auto known = std::find_if(
              ground_effect.options.begin(), ground_effect.options.end(),
              [&](const GroundEffect::Option& option) { return option.value == value; });
          if (known == ground_effect.options.end())
          {
            ground_effect.options.push_back({value, std::move(condition)});
          }
          else
          {
            known->condition.clear();  // one of several conditions: none of them is needed
          }
        });
      }
      ground.outcomes.back().push_back(std::move(ground_effect));
    }
  }
  laws_.push_back(std::move(ground));
}

void RelevantRules::want(const Atom& fluent)
{
  if (description_.findFluent(fluent.name)->kind != FluentKind::kStatic &&
      wanted_.insert(toString(fluent)).second)
  {
    fluents_.push_back(fluent);
  }
}

void RelevantRules::want(const std::vector<Literal>& literals)
{
  for (const Literal& literal : literals)
  {
    want(literal.atom);
  }
}

void RelevantRules::expand(const Atom& fluent)
{
  for (std::size_t i = 0; i < description_.constraints.size(); ++i)
  {
    if (kept_.hasLaw(statements_.ofConstraint(i)))
    {
      expandConstraint(description_.constraints[i], statements_.ofConstraint(i), fluent);
    }
  }
  for (std::size_t i = 0; i < description_.executabilities.size(); ++i)
  {
    if (kept_.hasLaw(statements_.ofExecutability(i)))
    {
      expandBans(description_.executabilities[i], statements_.ofExecutability(i), fluent);
    }
  }
  for (const Default& rule : description_.defaults)
  {
    expandDefault(rule, fluent);
  }
  const std::string name = toString(fluent);
  for (const GroundLaw& law : laws_)
  {
    bool affects = false;
    bool reads = false;
    std::vector<Atom> affected;
    for (const auto& outcome : law.outcomes)
    {
      for (const GroundEffect& effect : outcome)
      {
        affects = affects || toString(effect.fluent) == name;
        affected.push_back(effect.fluent);
      }
    }
    for (const auto& body : law.bodies)
    {
      for (const Literal& literal : body)
      {
        reads = reads || toString(literal.atom) == name;
      }
    }
    if (affects)
    {
      std::for_each(law.bodies.begin(), law.bodies.end(),
                    [&](const std::vector<Literal>& body) { want(body); });
      for (const auto& outcome : law.outcomes)
      {
        for (const GroundEffect& effect : outcome)
        {
          std::for_each(effect.options.begin(), effect.options.end(),
                        [&](const GroundEffect::Option& option) { want(option.condition); });
        }
      }
    }
    if (wide_ && (reads || affects))
    {
      std::for_each(affected.begin(), affected.end(), [&](const Atom& atom) { want(atom); });
    }
  }
}

void RelevantRules::addRule(GroundRule rule)
{
  const std::string key =
      keyOf(rule.position) + keyOf(rule.body) + (rule.head ? ">" + toString(*rule.head) : "");
  if (seen_.insert(key).second)
  {
    if (rule.head)
    {
      want(rule.head->atom);
    }
    want(rule.body);
    rules_.push_back(std::move(rule));
  }
}

void RelevantRules::expandConstraint(const StateConstraint& constraint, std::size_t law,
                                     const Atom& fluent)
{
  if (constraint.head && instances_.isStatic(*constraint.head))
  {
    return;
  }
  StatementParts parts{{}, {}, {}, {&constraint.body}};
  if (constraint.head)
  {
    parts.literals.push_back(&*constraint.head);
  }
  const auto add = [&](const Binding& binding) {
    GroundRule rule;
    if (constraint.head)
    {
      rule.head = normalized(bound(*constraint.head, binding), description_);
    }
    rule.body = instances_.literals(constraint.body, binding);
    rule.position = constraint.position;
    rule.law = law;
    addRule(std::move(rule));
  };
  if (constraint.head)
  {
    if (const auto start = about(*constraint.head, fluent))
    {
      instances_.forEach(parts, *start, add);
    }
  }
  if (constraint.head && !wide_)
  {
    return;
  }
  for (const Condition& condition : constraint.body)
  {
    const auto* literal = std::get_if<Literal>(&condition);
    if (literal != nullptr && !instances_.isStatic(*literal))
    {
      if (const auto start = about(*literal, fluent))
      {
        instances_.forEach(parts, *start, add);
      }
    }
  }
}

void RelevantRules::expandBans(const Executability& rule, std::size_t law, const Atom& fluent)
{
  for (const Condition& condition : rule.body)
  {
    const auto* literal = std::get_if<Literal>(&condition);
    if (literal != nullptr && !instances_.isStatic(*literal) && about(*literal, fluent))
    {
      addBans(rule, law, *literal, fluent, {});
    }
  }
}

/// Extends a choice of one occurrence for each action of the rule; all at the same step.
void RelevantRules::addBans(const Executability& rule, std::size_t law, const Literal& literal,
                            const Atom& fluent, const std::vector<std::size_t>& happened)
{
  if (happened.size() < rule.actions.size())
  {
    for (std::size_t i = 0; i < occurrences_.size(); ++i)
    {
      if (happened.empty() || occurrences_[i].step == occurrences_[happened.front()].step)
      {
        std::vector<std::size_t> longer = happened;
        longer.push_back(i);
        addBans(rule, law, literal, fluent, longer);
      }
    }
    return;
  }
  Binding start;
  StatementParts parts{{}, {}, {}, {&rule.body}};
  for (std::size_t i = 0; i < happened.size(); ++i)
  {
    const Occurrence& occurrence = occurrences_[happened[i]];
    if (const auto* atom = std::get_if<Atom>(&rule.actions[i]))
    {
      if (!unify(*atom, occurrence.action, start))
      {
        return;
      }
      parts.actions.push_back(atom);
    }
    else
    {
      const Term& variable = std::get<Term>(rule.actions[i]);
      const std::string action = toString(occurrence.action);
      if (occurrence.exogenous || start.emplace(variable.name, action).first->second != action)
      {
        return;  // a variable stands for agent actions
      }
    }
  }
  const auto binding = about(literal, fluent, start);
  if (!binding)
  {
    return;
  }
  instances_.forEach(parts, *binding, [&](const Binding& whole) {
    GroundBan ban{happened, instances_.literals(rule.body, whole), rule.position, law};
    std::string key = keyOf(ban.position) + keyOf(ban.body);
    for (const std::size_t i : happened)
    {
      key += std::to_string(i) + ",";
    }
    if (seen_.insert(key).second)
    {
      want(ban.body);
      bans_.push_back(std::move(ban));
    }
  });
}

void RelevantRules::expandDefault(const Default& rule, const Atom& fluent)
{
  const auto start = about(rule.head, fluent);
  if (!start)
  {
    return;
  }
  instances_.forEach({{}, {}, {&rule.head}, {&rule.body}}, *start, [&](const Binding& binding) {
    GroundDefault instance{&rule, toString(bound(rule.name, binding)),
                           normalized(bound(rule.head, binding), description_),
                           instances_.literals(rule.body, binding)};
    if (kept_.hasDefault(instance.name) &&
        seen_.insert("d" + instance.name + keyOf(instance.body) + toString(instance.head)).second)
    {
      want(instance.body);
      defaults_.push_back(std::move(instance));
    }
  });
}

}  // namespace kr3::reasoner
