// Semantics: what an action leads to.

#include <algorithm>
#include <utility>

#include "matcher.hpp"
#include "semantics.hpp"

namespace kr3::refinement
{
namespace
{

constexpr int kNone = Vocabulary::kNone;

int number(const Vocabulary& vocabulary, int constant)
{
  return std::stoi(vocabulary.name(constant));
}

/// Variables that a condition mentions, for remembering its solutions.
struct Mentioned
{
  Binding key;
  const Binding& binding;

  void add(const Slot& slot)
  {
    if (slot.is_variable)
    {
      key.push_back(binding[static_cast<std::size_t>(slot.id)]);
    }
  }
  void operator()(const CompiledLiteral& literal)
  {
    std::for_each(literal.arguments.begin(), literal.arguments.end(),
                  [this](const Slot& slot) { add(slot); });
    add(literal.value);
  }
  void operator()(const CompiledComparison& comparison)
  {
    add(comparison.left);
    add(comparison.right);
  }
  void operator()(const CompiledMembership& membership) { add(membership.term); }
};

}  // namespace

bool holds(const Vocabulary& vocabulary, int left, reasoner::Comparison::Operator op, int right)
{
  using Operator = reasoner::Comparison::Operator;
  switch (op)
  {
    case Operator::kEqual:
      return left == right;
    case Operator::kNotEqual:
      return left != right;
    case Operator::kLess:
      return number(vocabulary, left) < number(vocabulary, right);
    case Operator::kLessEqual:
      return number(vocabulary, left) <= number(vocabulary, right);
    case Operator::kGreater:
      return number(vocabulary, left) > number(vocabulary, right);
    case Operator::kGreaterEqual:
      return number(vocabulary, left) >= number(vocabulary, right);
  }
  return false;
}

std::vector<int> Semantics::choiceValues(const CompiledEffect& effect, const Variables& variables,
                                         Binding& binding, const Values& state) const
{
  Mentioned mentioned{{}, binding};
  if (effect.choice_is_static)
  {
    for (const CompiledCondition& condition : effect.choice)
    {
      std::visit(mentioned, condition);
    }
    const auto remembered = remembered_choices_.find({&effect, mentioned.key});
    if (remembered != remembered_choices_.end())
    {
      return remembered->second;
    }
  }
  std::vector<int> result;
  const auto chosen = static_cast<std::size_t>(effect.fluent.value.id);
  for (const int element : variables.full_domains[chosen].elements())
  {
    binding[chosen] = element;
    if (!forEachMatch(signature_, variables, effect.choice, state, binding,
                      [](const Binding&) { return false; }))
    {
      result.push_back(element);
    }
  }
  binding[chosen] = kNone;
  if (effect.choice_is_static)
  {
    remembered_choices_.emplace(std::make_pair(&effect, mentioned.key), result);
  }
  return result;
}

std::vector<std::string> Semantics::labels(const std::vector<CompiledLaw>& laws,
                                           const Values& state, const GroundAction& action) const
{
  std::vector<std::string> result;
  for (const CompiledLaw& law : laws)
  {
    const auto labelled = [](const CompiledOutcome& outcome) { return !outcome.label.empty(); };
    if (std::none_of(law.outcomes.begin(), law.outcomes.end(), labelled))
    {
      continue;
    }
    std::optional<Binding> binding = bound(law.variables, law.arguments, action.arguments);
    const bool applies = binding && !forEachMatch(signature_, law.variables, law.body, state,
                                                  *binding, [](const Binding&) { return false; });
    for (const CompiledOutcome& outcome : law.outcomes)
    {
      if (applies && labelled(outcome) &&
          std::find(result.begin(), result.end(), outcome.label) == result.end())
      {
        result.push_back(outcome.label);
      }
    }
  }
  return result.empty() ? std::vector<std::string>{""} : result;
}

std::vector<Semantics::EffectSet> Semantics::effectSets(const std::vector<CompiledLaw>& laws,
                                                        const std::string& label,
                                                        const Values& state,
                                                        const GroundAction& action) const
{
  std::vector<EffectSet> sets{{}};
  const auto add = [&](const CompiledLaw& law, const CompiledEffect& effect, Binding& binding) {
    const std::optional<std::size_t> fluent = signature_.fluentIndex(effect.fluent, binding);
    if (!fluent)
    {
      return;  // about something outside the zoom
    }
    const std::vector<int> values =
        effect.is_choice ? choiceValues(effect, law.variables, binding, state)
                         : std::vector<int>{Signature::constantOf(effect.fluent.value, binding)};
    std::vector<EffectSet> longer;
    for (const EffectSet& set : sets)
    {
      for (const int value : values)
      {
        longer.push_back(set);
        longer.back().push_back({*fluent, value});
      }
    }
    sets = std::move(longer);
  };
  for (const CompiledLaw& law : laws)
  {
    std::optional<Binding> binding = bound(law.variables, law.arguments, action.arguments);
    if (!binding)
    {
      continue;
    }
    forEachMatch(signature_, law.variables, law.body, state, *binding, [&](const Binding& match) {
      Binding instance = match;
      for (const CompiledOutcome& outcome : law.outcomes)
      {
        if (outcome.label.empty() || outcome.label == label)
        {
          for (const CompiledEffect& effect : outcome.effects)
          {
            add(law, effect, instance);
          }
        }
      }
      return true;
    });
  }
  return sets;
}

bool Semantics::isValue(std::size_t fluent, int value) const
{
  const std::vector<int>& values = fluents()[fluent].values;
  return std::find(values.begin(), values.end(), value) != values.end();
}

bool Semantics::leavesZoom(const Effect& effect) const
{
  return !isValue(effect.fluent, effect.value);
}

std::vector<Result> Semantics::resultsWhenTold(const Values& state,
                                               const GroundAction& action) const
{
  static const std::vector<CompiledLaw> kNoLaws;
  const auto entry = laws_.find(action.symbol);
  const std::vector<CompiledLaw>& laws = entry == laws_.end() ? kNoLaws : entry->second;
  std::vector<Result> results;
  for (const std::string& label : labels(laws, state, action))
  {
    const std::size_t first = results.size();
    double total = 0.0;
    for (const EffectSet& effects : effectSets(laws, label, state, action))
    {
      if (std::any_of(effects.begin(), effects.end(),
                      [this](const Effect& effect) { return leavesZoom(effect); }))
      {
        results.push_back({label, 1.0, true, {}});
        total += 1.0;
        continue;
      }
      std::vector<Values> states = successors(state, effects);
      total += states.empty() ? 0.0 : 1.0;
      for (Values& next : states)
      {
        results.push_back(
            {label, 1.0 / static_cast<double>(states.size()), false, std::move(next)});
      }
    }
    for (std::size_t i = first; i < results.size(); ++i)
    {
      results[i].share /= total;
    }
  }
  return results;
}

Semantics::Conflict Semantics::involved(const CompiledConstraint& constraint,
                                        const Binding& binding) const
{
  Conflict fluents;
  const auto add = [&](const CompiledLiteral& literal) {
    if (const std::optional<std::size_t> fluent = signature_.fluentIndex(literal, binding))
    {
      fluents.push_back(*fluent);
    }
  };
  if (constraint.head)
  {
    add(*constraint.head);
  }
  for (const CompiledCondition& condition : constraint.body)
  {
    if (const auto* literal = std::get_if<CompiledLiteral>(&condition))
    {
      add(*literal);
    }
  }
  return fluents;
}

std::optional<Semantics::Conflict> Semantics::close(Values& state) const
{
  std::optional<Conflict> conflict;
  for (bool changed = true; changed && !conflict;)
  {
    changed = false;
    for (const CompiledConstraint& constraint : constraints_)
    {
      Binding binding(constraint.variables.domains.size(), kNone);
      forEachMatch(signature_, constraint.variables, constraint.body, state, binding,
                   [&](const Binding& match) {
        if (!constraint.head)
        {
          conflict = involved(constraint, match);
          return false;
        }
        const std::optional<std::size_t> fluent = signature_.fluentIndex(*constraint.head, match);
        if (!fluent)
        {
          return true;
        }
        const int value = Signature::constantOf(constraint.head->value, match);
        const int present = state[*fluent];
        const Equality violation = constraint.head->equal ? Equality::kDifferent : Equality::kEqual;
        if (present == kNone && constraint.head->equal)
        {
          state[*fluent] = !isValue(*fluent, value) && isValue(*fluent, signature_.elsewhere())
                               ? signature_.elsewhere()
                               : value;
          changed = true;
        }
        else if (present != kNone &&
                 signature_.equality(present, value,
                                     signature_.symbols()[constraint.head->symbol]) == violation)
        {
          conflict = involved(constraint, match);
        }
        return !conflict;
      });
    }
  }
  return conflict;
}

bool Semantics::complete(Values& state) const
{
  for (std::size_t fluent = signature_.numInertial(); fluent < fluents().size(); ++fluent)
  {
    state[fluent] = signature_.falseValue();
  }
  define(state, Truth::kSurely);
  if (signature_.elsewhere() != kNone)
  {
    define(state, Truth::kPossibly);
  }
  return !close(state);
}

void Semantics::define(Values& state, Truth truth) const
{
  const int value = truth == Truth::kSurely ? signature_.trueValue() : signature_.elsewhere();
  for (bool changed = !definitions_.empty(); changed;)
  {
    changed = false;
    for (const CompiledConstraint& definition : definitions_)
    {
      Binding binding(definition.variables.domains.size(), kNone);
      forEachMatch(
          signature_, definition.variables, definition.body, state, binding,
          [&](const Binding& match) {
        const std::optional<std::size_t> fluent = signature_.fluentIndex(*definition.head, match);
        if (fluent && state[*fluent] == signature_.falseValue())
        {
          state[*fluent] = value;
          changed = true;
        }
        return true;
          },
          truth);
    }
  }
}

std::vector<Values> Semantics::successors(const Values& state, const EffectSet& effects) const
{
  std::vector<Values> found;
  std::set<std::set<std::size_t>> tried;
  search(state, effects, {}, tried, found);
  return found;
}

void Semantics::search(const Values& state, const EffectSet& effects,
                       std::set<std::size_t> released, std::set<std::set<std::size_t>>& tried,
                       std::vector<Values>& found) const
{
  if (!tried.insert(released).second)
  {
    return;
  }
  Values next = state;
  std::fill(next.begin() + static_cast<std::ptrdiff_t>(signature_.numInertial()), next.end(),
            kNone);
  for (const std::size_t fluent : released)
  {
    next[fluent] = kNone;
  }
  std::set<std::size_t> fixed;
  for (const Effect& effect : effects)
  {
    if (!fixed.insert(effect.fluent).second && next[effect.fluent] != effect.value)
    {
      return;  // the effects contradict each other
    }
    next[effect.fluent] = effect.value;
  }
  std::optional<Conflict> conflict = close(next);
  if (!conflict)
  {
    for (const std::size_t fluent : released)
    {
      if (next[fluent] == kNone && state[fluent] != kNone)
      {
        return;  // nothing caused it to change
      }
    }
    if (complete(next) && std::find(found.begin(), found.end(), next) == found.end())
    {
      found.push_back(next);
    }
    return;
  }
  for (const std::size_t fluent : *conflict)
  {
    const bool kept = fluent < signature_.numInertial() && fixed.count(fluent) == 0 &&
                      released.count(fluent) == 0;
    if (kept && state[fluent] != kNone)
    {
      std::set<std::size_t> more = released;
      more.insert(fluent);
      search(state, effects, std::move(more), tried, found);
    }
  }
}

}  // namespace kr3::refinement
