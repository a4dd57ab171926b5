#include <algorithm>
#include <map>

#include "relevance.hpp"

namespace kr3::reasoner
{

// ---- What the history says ----

void Relevance::findOpenPositions()
{
  for (const ActionDeclaration& action : rules_.description().actions)
  {
    open_position_.emplace_back(action.argument_sorts.size(), true);
  }
  for (const GroundableRule& rule : rules_.rules())
  {
    for (const RuleAction& action : rule.actions)
    {
      for (std::size_t i = 0; i < action.arguments.size(); ++i)
      {
        const Slot& slot = action.arguments[i];
        if (slot.is_variable && rule.in_fluent[slot.id])
        {
          open_position_[action.symbol][i] = false;
        }
      }
    }
  }
}

void Relevance::readBeginning(const Beginning& beginning)
{
  for (const auto& level : beginning.levels)
  {
    for (const BeginningComponent& component : level->components)
    {
      if (component.fluents.size() < 2)
      {
        for (const OpenFluent& fluent : component.fluents)
        {
          open_at_first_.insert(rules_.ground(fluent.atom, false));
        }
        continue;
      }
      joined_.emplace_back();
      for (const OpenFluent& fluent : component.fluents)
      {
        joined_.back().push_back(rules_.ground(fluent.atom, false));
        open_at_first_.insert(joined_.back().back());
        ties_of_[joined_.back().back()].push_back(joined_.size() - 1);
      }
    }
  }
}

void Relevance::readRecords()
{
  std::unordered_set<GroundAtom, GroundAtomHash> contradicted;
  for (const CheckedRecord& checked : records_)
  {
    const bool initially = checked.record.step == first_step_ && checked.record.confidence >= 1.0;
    if (checked.isAction() || !initially || !checked.literal.equal)
    {
      continue;
    }
    const GroundAtom fluent = rules_.ground(checked.literal.atom, false);
    const FluentKind kind = rules_.description().fluents[fluent.symbol].kind;
    if (kind == FluentKind::kStatic || kind == FluentKind::kDefined)
    {
      continue;
    }
    const ConstantId value = rules_.constant(checked.literal.value.name);
    const auto [place, fresh] = known_.emplace(fluent, value);
    if (!fresh && place->second != value)
    {
      contradicted.insert(fluent);
    }
  }
  for (const GroundAtom& fluent : contradicted)
  {
    known_.erase(fluent);
  }
}

/// Which defined fluents can carry evidence about what defines them, by symbol; and what exogenous
/// actions can change.
void Relevance::findEvidence()
{
  const Description& description = rules_.description();
  evidence_.assign(description.fluents.size(), false);
  exogenous_.assign(description.fluents.size(), false);
  std::vector<bool> recorded(description.actions.size(), false);
  for (const CheckedRecord& checked : records_)
  {
    if (checked.isAction())
    {
      recorded[rules_.actionSymbol(checked.action.name)] = true;
    }
    else
    {
      evidence_[rules_.fluentSymbol(checked.literal.atom.name)] = true;
    }
  }
  for (std::size_t i = 0; i < recorded.size(); ++i)
  {
    recorded[i] = recorded[i] || (description.actions[i].exogenous && current_step_ > 0);
  }
  const auto isDefinition = [&](const GroundableRule& rule) {
    return rule.kind == Kind::kConstraint && !rule.literals.empty() &&
           rule.literals[0].role == Role::kHead && rules_.isDefined(rule.literals[0].symbol);
  };
  for (bool grown = true; grown;)
  {
    grown = false;
    for (const GroundableRule& rule : rules_.rules())
    {
      const bool happens =
          rule.actions.empty()
              ? rule.kind == Kind::kConstraint || rule.kind == Kind::kDefault
              : rule.kind != Kind::kCost &&
                    std::any_of(rule.actions.begin(), rule.actions.end(),
                                [&](const RuleAction& action) { return recorded[action.symbol]; });
      const bool informs =
          isDefinition(rule) ? evidence_[rule.literals[0].symbol] : happens || rule.any_action;
      const bool exogenous_law = rule.kind == Kind::kLaw && current_step_ > 0 &&
                                 description.actions[rule.actions[0].symbol].exogenous;
      bool spreads = exogenous_law;
      for (const RuleLiteral& literal : rule.literals)
      {
        spreads = spreads || (rule.kind == Kind::kConstraint && literal.role == Role::kBody &&
                              exogenous_[literal.symbol]);
        if (informs && !evidence_[literal.symbol])
        {
          evidence_[literal.symbol] = true;
          grown = true;
        }
      }
      for (const RuleLiteral& literal : rule.literals)
      {
        if (spreads && literal.role != Role::kBody && literal.role != Role::kChoice &&
            !exogenous_[literal.symbol])
        {
          exogenous_[literal.symbol] = true;
          grown = true;
        }
      }
    }
  }
}

/// What the occurred actions change.
void Relevance::expandOccurrences()
{
  for (const CheckedRecord& checked : records_)
  {
    if (!checked.isAction())
    {
      continue;
    }
    const GroundAtom action = rules_.ground(checked.action, true);
    for (const std::size_t index : rules_.rulesOfAction(action.symbol))
    {
      const GroundableRule& rule = rules_.rules()[index];
      RuleBinding binding;
      if (rule.kind == Kind::kLaw &&
          rules_.unify(rule, rule.actions[0].arguments, action.arguments, binding))
      {
        run([this, index, binding] {
          const GroundableRule& law = rules_.rules()[index];
          forEachLive(index, binding, Basis::kAlways, [&](const RuleBinding& instance) {
            for (const RuleLiteral& literal : law.literals)
            {
              if (literal.role == Role::kEffect)
              {
                affect(GroundRules::bound(literal, instance), -1);
              }
            }
          });
        });
      }
    }
  }
}

/// Ties the fluents of a rule's instances to an occurred action.
void Relevance::addTo(Occurrence& occurrence, std::size_t rule, const RuleBinding& binding)
{
  forEachLive(rule, binding, Basis::kHistory, [&](const RuleBinding& instance) {
    for (const RuleLiteral& literal : rules_.rules()[rule].literals)
    {
      occurrence.fluents.push_back(GroundRules::bound(literal, instance));
    }
  });
}

/// The fluents that the laws and conditions of each occurred action tie together.
void Relevance::collectOccurrences()
{
  std::map<int, std::vector<std::size_t>> at_step;
  for (std::size_t i = 0; i < records_.size(); ++i)
  {
    if (!records_[i].isAction())
    {
      continue;
    }
    Occurrence& occurrence = occurrences_[i];
    const GroundAtom action = rules_.ground(records_[i].action, true);
    at_step[records_[i].record.step].push_back(i);
    for (const std::size_t index : rules_.rulesOfAction(action.symbol))
    {
      const GroundableRule& rule = rules_.rules()[index];
      for (const RuleAction& mentioned : rule.actions)
      {
        RuleBinding binding;
        if (rule.kind == Kind::kCost || mentioned.symbol != action.symbol ||
            !rules_.unify(rule, mentioned.arguments, action.arguments, binding))
        {
          continue;
        }
        addTo(occurrence, index, binding);
      }
    }
    for (const std::size_t index : rules_.rulesOfAnyAction())
    {
      addTo(occurrence, index, RuleBinding(rules_.rules()[index].in_fluent.size(), kUnbound));
    }
  }
  for (const auto& [step, together] : at_step)  // they may exclude each other
  {
    for (const std::size_t record : together)
    {
      for (const std::size_t other : together)
      {
        if (other != record && !occurrences_[other].fluents.empty())
        {
          occurrences_[record].fluents.push_back(occurrences_[other].fluents.front());
        }
      }
    }
  }
  for (const auto& [record, occurrence] : occurrences_)
  {
    for (const GroundAtom& fluent : occurrence.fluents)
    {
      occurrences_of_[fluent].push_back(record);
    }
  }
}

// ---- Answers ----

bool Relevance::concerns(std::size_t record) const
{
  const CheckedRecord& checked = records_[record];
  if (checked.isAction())
  {
    const Occurrence& occurrence = occurrences_.at(record);
    return occurrence.asked ||
           std::any_of(occurrence.fluents.begin(), occurrence.fluents.end(),
                       [this](const GroundAtom& fluent) { return isRelevant(fluent); });
  }
  return isRelevant(rules_.ground(checked.literal.atom, false));
}

bool Relevance::isPlainFact(std::size_t record) const
{
  const CheckedRecord& checked = records_[record];
  if (checked.isAction() || !checked.literal.equal || checked.record.confidence < 1.0)
  {
    return false;
  }
  const GroundAtom fluent = rules_.ground(checked.literal.atom, false);
  const auto known = known_.find(fluent);
  const bool changes = exogenous_[fluent.symbol] || changed_.count(fluent) > 0;
  return known != known_.end() && known->second == rules_.constant(checked.literal.value.name) &&
         (!changes || checked.record.step == first_step_) && !isTied(fluent);
}

/// Whether a constraint or default that what is known initially does not satisfy ties a fluent to
/// something else, or a beginning gives its values prices.
bool Relevance::isTied(const GroundAtom& fluent) const
{
  if (open_at_first_.count(fluent) > 0)
  {
    return true;
  }
  const auto [place, fresh] = tied_.emplace(fluent, false);
  if (!fresh)
  {
    return place->second;
  }
  const auto refuted = [&](const RuleLiteral& literal, const RuleBinding& binding) {
    const auto other = known_.find(GroundRules::bound(literal, binding));
    const ConstantId value = GroundRules::bound(literal.value, binding);
    return other != known_.end() && value != kUnbound && (other->second == value) != literal.equal;
  };
  for (const std::size_t index : rules_.rulesOfFluent(fluent.symbol))
  {
    const GroundableRule& rule = rules_.rules()[index];
    const bool defines = rule.kind == Kind::kConstraint && rule.literals[0].role == Role::kHead &&
                         rules_.isDefined(rule.literals[0].symbol) &&
                         !evidence_[rule.literals[0].symbol];
    if ((rule.kind != Kind::kConstraint && rule.kind != Kind::kDefault) || defines)
    {
      continue;
    }
    for (const RuleLiteral& literal : rule.literals)
    {
      RuleBinding binding;
      if (literal.symbol != fluent.symbol ||
          !rules_.unify(rule, literal.arguments, fluent.arguments, binding))
      {
        continue;
      }
      bool tied = false;
      rules_.forEachInstance(rule, binding, {}, refuted, [&](const RuleBinding& instance) {
        for (const RuleLiteral& other : rule.literals)
        {
          tied = tied || !(GroundRules::bound(other, instance) == fluent) ||
                 rule.kind == Kind::kConstraint;
        }
      });
      if (tied)
      {
        place->second = true;
        return true;
      }
    }
  }
  return false;
}

}  // namespace kr3::reasoner
