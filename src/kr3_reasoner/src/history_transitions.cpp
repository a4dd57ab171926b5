#include <algorithm>
#include <utility>

#include "history_theory.hpp"

// What the clauses of a HistoryTheory say of one step and the next: effects and inertia.
namespace kr3::reasoner
{

void HistoryTheory::addTransitions()
{
  for (int step = 1; step <= current_step_; ++step)
  {
    Supports supports;
    for (const GroundLaw& law : rules_.laws())
    {
      if (rules_.occurrences()[law.occurrence].step + 1 == step)
      {
        addLaw(law, supports);
      }
    }
    for (const GroundRule& rule : rules_.rules())
    {
      if (!rule.head || !rule.head->equal || !changes(*fluentIndex(rule.head->atom), step))
      {
        continue;
      }
      const bool touched = std::any_of(
          rule.body.begin(), rule.body.end(),
          [&](const Literal& literal) { return changes(*fluentIndex(literal.atom), step); });
      if (touched)
      {
        supports[*fluentIndex(rule.head->atom)].push_back(
            {rule.head->value.name, at(rule.body, step), "", rule.law});
      }
    }
    for (std::size_t fluent = 0; fluent < values_.size(); ++fluent)
    {
      const FluentKind kind = description_.findFluent(rules_.fluents()[fluent].name)->kind;
      if (changes(fluent, step) && kind != FluentKind::kDefined)
      {
        addFrame(fluent, step, supports[fluent]);
      }
    }
  }
}

void HistoryTheory::addLaw(const GroundLaw& law, Supports& supports)
{
  const bool matters =
      std::any_of(law.outcomes.begin(), law.outcomes.end(), [&](const auto& outcome) {
        return std::any_of(outcome.begin(), outcome.end(), [&](const GroundEffect& effect) {
          return fluentIndex(effect.fluent).has_value();
        });
      });
  if (!matters)
  {
    return;
  }
  const Occurrence& occurrence = rules_.occurrences()[law.occurrence];
  const int step = occurrence.step + 1;
  const FiniteLiteral happens{occurrence_variables_[law.occurrence], 1, true, occurrence.step};
  ClauseOrigin origin;
  origin.kind = ReasonKind::kCaused;
  origin.step = step;
  origin.position = law.position;
  origin.law = law.law;
  origin.action = toString(occurrence.action);
  const int caused = addOrigin(origin);
  origin.silent = true;
  const int silent = addOrigin(origin);
  if (law.outcomes.size() == 1 &&
      std::all_of(law.outcomes[0].begin(), law.outcomes[0].end(), [](const GroundEffect& effect) {
        return effect.options.size() == 1 && effect.options[0].condition.empty();
      }))
  {
    for (const auto& conditions : law.bodies)
    {
      Body body = {happens};
      const Body more = at(conditions, step - 1);
      body.insert(body.end(), more.begin(), more.end());
      for (const GroundEffect& effect : law.outcomes[0])
      {
        if (const auto fluent = fluentIndex(effect.fluent))
        {
          const std::string& value = effect.options[0].value;
          addImplication(body, at({effect.fluent, {false, value}, true}, step), caused);
          supports[*fluent].push_back({value, body, origin.action, law.law});
        }
      }
    }
    return;
  }
  // applies <-> happens and one of the bodies
  Body bodies;
  const int variable = propagation_.addVariable(2);
  meanings_.emplace_back();
  meanings_.back().action = origin.action;
  const FiniteLiteral applies{variable, 1, true, step};
  for (const auto& conditions : law.bodies)
  {
    Body body = {happens};
    const Body more = at(conditions, step - 1);
    body.insert(body.end(), more.begin(), more.end());
    addImplication(body, applies, silent);
    bodies.push_back(conjunction(body, origin.action, silent));
  }
  Body clause = bodies;
  clause.push_back({variable, 1, false, step});
  propagation_.addClause(clause, silent);
  addEffects(law, applies, supports);
}

/// One outcome of several happens, and in it one value of each choice.
void HistoryTheory::addEffects(const GroundLaw& law, const FiniteLiteral& applies,
                               Supports& supports)
{
  const int step = applies.step;
  ClauseOrigin origin;
  origin.kind = ReasonKind::kCaused;
  origin.step = step;
  origin.position = law.position;
  origin.law = law.law;
  origin.action = toString(rules_.occurrences()[law.occurrence].action);
  const int caused = addOrigin(origin);
  origin.silent = true;
  const int silent = addOrigin(origin);
  const auto auxiliary = [&] {
    const int variable = propagation_.addVariable(2);
    meanings_.emplace_back();
    meanings_.back().action = origin.action;
    return FiniteLiteral{variable, 1, true, step};
  };
  Body outcomes = {{applies.variable, 1, false, step}};
  for (const auto& outcome : law.outcomes)
  {
    const FiniteLiteral taken = law.outcomes.size() == 1 ? applies : auxiliary();
    if (law.outcomes.size() > 1)
    {
      addImplication({taken}, applies, silent);
      outcomes.push_back(taken);
    }
    for (const GroundEffect& effect : outcome)
    {
      const auto fluent = fluentIndex(effect.fluent);
      if (!fluent)
      {
        continue;
      }
      Body options = {{taken.variable, 1, false, step}};
      for (const GroundEffect::Option& option : effect.options)
      {
        const FiniteLiteral picked = effect.options.size() == 1 ? taken : auxiliary();
        if (effect.options.size() > 1)
        {
          addImplication({picked}, taken, silent);
          options.push_back(picked);
        }
        for (const FiniteLiteral& condition : at(option.condition, step - 1))
        {
          addImplication({picked}, condition, silent);
        }
        addImplication({picked}, at({effect.fluent, {false, option.value}, true}, step), caused);
        supports[*fluent].push_back({option.value, {picked}, origin.action, law.law});
      }
      if (effect.options.size() != 1)
      {
        propagation_.addClause(options, silent);
      }
    }
  }
  if (law.outcomes.size() > 1)
  {
    propagation_.addClause(outcomes, silent);
  }
}

/// A value stays unless something gives another one.
void HistoryTheory::addFrame(std::size_t fluent, int step, const std::vector<Support>& supports)
{
  const int now = variable(fluent, step);
  const int before = variable(fluent, step - 1);
  ClauseOrigin origin;
  origin.kind = ReasonKind::kInertia;
  origin.step = step;
  origin.fluent_variable = now;
  origin.earlier_variable = before;
  const int frame = addOrigin(origin);
  origin.silent = true;
  std::map<std::string, Body> by_value;
  for (const Support& support : supports)
  {
    ClauseOrigin supported = origin;
    supported.law = support.law;  // only this law can have brought about the change
    by_value[support.value].push_back(
        conjunction(support.body, support.action, addOrigin(std::move(supported))));
  }
  for (std::size_t i = 0; i < values_[fluent].size(); ++i)
  {
    const int value = static_cast<int>(i);
    Body given = {{now, value, false, step}, {before, value, true, step - 1}};
    Body kept = {{before, value, false, step - 1}, {now, value, true, step}};
    for (const auto& [supported, literals] : by_value)
    {
      Body& clause = supported == values_[fluent][i] ? given : kept;
      clause.insert(clause.end(), literals.begin(), literals.end());
    }
    propagation_.addClause(given, frame);
    if (values_[fluent].size() > 2)
    {
      propagation_.addClause(kept, frame);
    }
  }
}

}  // namespace kr3::reasoner
