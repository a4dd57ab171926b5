#include "semantics.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <kr3_common/error.hpp>

#include "matcher.hpp"
#include "rule_compiler.hpp"

namespace kr3::refinement
{
namespace
{

constexpr int kNone = Vocabulary::kNone;

/// The fluents that make most states, for people: "2 of loc with 16 values each, ...".
std::string largestFluents(const Signature& signature)
{
  struct Group
  {
    std::string symbol;
    std::size_t count = 0;
    std::size_t num_values = 0;  // of the fluent that has most

    [[nodiscard]] double size() const
    {
      return static_cast<double>(count) * std::log(static_cast<double>(num_values));
    }
  };
  constexpr std::size_t kMostGroups = 3;
  std::vector<Group> groups;
  for (std::size_t i = 0; i < signature.numInertial(); ++i)
  {
    const std::string& symbol = signature.symbols()[signature.fluents()[i].symbol].name;
    if (groups.empty() || groups.back().symbol != symbol)
    {
      groups.push_back({symbol, 0, 0});
    }
    ++groups.back().count;
    groups.back().num_values =
        std::max(groups.back().num_values, signature.fluents()[i].values.size());
  }
  std::stable_sort(groups.begin(), groups.end(),
                   [](const Group& a, const Group& b) { return a.size() > b.size(); });
  std::string text;
  for (std::size_t i = 0; i < std::min(groups.size(), kMostGroups); ++i)
  {
    text += (i == 0 ? "" : ", ") + std::to_string(groups[i].count) + " of " + groups[i].symbol +
            " with " + std::to_string(groups[i].num_values) + " values" +
            (groups[i].count > 1 ? " each" : "");
  }
  return text + (groups.size() > kMostGroups ? " and smaller ones" : "");
}

}  // namespace

Semantics::Semantics(const reasoner::Description& description,
                     const std::set<std::string>* constants,
                     const std::set<std::string>& with_elsewhere, const std::string& elsewhere)
  : signature_(description, constants, with_elsewhere, elsewhere)
{
  const RuleCompiler compiler(description, signature_);
  for (const reasoner::Literal& fact : description.static_facts)
  {
    const CompiledLiteral literal = compiler.fact(fact);
    signature_.setStatic(literal, {}, literal.value.id);
  }
  addConstraints(description);
  addActions(description);
}

void Semantics::addConstraints(const reasoner::Description& description)
{
  const RuleCompiler compiler(description, signature_);
  std::vector<CompiledConstraint> static_rules;
  for (const reasoner::StateConstraint& constraint : description.constraints)
  {
    std::optional<CompiledConstraint> compiled = compiler.constraint(constraint);
    if (!compiled)
    {
      continue;
    }
    const Symbol* head = compiled->head ? &signature_.symbols()[compiled->head->symbol] : nullptr;
    if (head != nullptr && head->is_static)
    {
      static_rules.push_back(std::move(*compiled));
    }
    else if (head != nullptr && head->defined)
    {
      definitions_.push_back(std::move(*compiled));
    }
    else
    {
      constraints_.push_back(std::move(*compiled));
    }
  }
  closeStatics(static_rules);
}

void Semantics::closeStatics(const std::vector<CompiledConstraint>& rules)
{
  const Values no_state;
  for (bool changed = !rules.empty(); changed;)
  {
    changed = false;
    for (const CompiledConstraint& rule : rules)
    {
      Variables whole = rule.variables;
      whole.domains = whole.full_domains;
      Binding binding(whole.domains.size(), kNone);
      forEachMatch(signature_, whole, rule.body, no_state, binding, [&](const Binding& match) {
        const int value = Signature::constantOf(rule.head->value, match);
        if (signature_.value(*rule.head, match, no_state) != value)
        {
          signature_.setStatic(*rule.head, match, value);
          changed = true;
        }
        return true;
      });
    }
  }
}

void Semantics::addActions(const reasoner::Description& description)
{
  const RuleCompiler compiler(description, signature_);
  for (const reasoner::ActionDeclaration& action : description.actions)
  {
    if (action.exogenous)
    {
      continue;
    }
    actions_.push_back(action);
    for (const reasoner::Executability& law : description.executabilities)
    {
      if (auto compiled = compiler.executability(law, action.name))
      {
        executabilities_[action.name].push_back(std::move(*compiled));
      }
    }
  }
  for (const reasoner::CausalLaw& law : description.causal_laws)
  {
    if (auto compiled = compiler.causalLaw(law))
    {
      laws_[law.action.name].push_back(std::move(*compiled));
    }
  }
  for (const auto& [action, laws] : laws_)
  {
    std::set<std::size_t>& mentioned = mentioned_[action];
    for (const CompiledLaw& law : laws)
    {
      addMentioned(law.body, mentioned);
      for (const CompiledOutcome& outcome : law.outcomes)
      {
        for (const CompiledEffect& effect : outcome.effects)
        {
          addMentioned(effect.choice, mentioned);
        }
      }
    }
  }
  for (const reasoner::ObservationLaw& law : description.observations)
  {
    if (auto compiled = compiler.observation(law))
    {
      observations_[law.action.name].push_back(std::move(*compiled));
    }
  }
}

std::vector<GroundAction> Semantics::actions() const
{
  std::vector<GroundAction> result;
  for (const reasoner::ActionDeclaration& declaration : actions_)
  {
    std::vector<std::vector<int>> tuples{{}};
    for (const std::string& sort : declaration.argument_sorts)
    {
      std::vector<std::vector<int>> longer;
      for (const std::vector<int>& tuple : tuples)
      {
        for (const int element : signature_.sort(sort).elements())
        {
          longer.push_back(tuple);
          longer.back().push_back(element);
        }
      }
      tuples = std::move(longer);
    }
    for (std::vector<int>& tuple : tuples)
    {
      reasoner::Atom atom{declaration.name, {}, {}};
      for (const int element : tuple)
      {
        atom.arguments.push_back({false, vocabulary().name(element)});
      }
      result.push_back({reasoner::toString(atom), declaration.name, std::move(tuple)});
    }
  }
  return result;
}

GroundAction Semantics::groundAction(const reasoner::Atom& action) const
{
  GroundAction result{reasoner::toString(action), action.name, {}};
  for (const reasoner::Term& argument : action.arguments)
  {
    result.arguments.push_back(vocabulary().find(argument.name));
  }
  return result;
}

std::optional<Binding> Semantics::bound(const Variables& variables, const std::vector<Slot>& slots,
                                        const std::vector<int>& arguments) const
{
  Binding binding(variables.domains.size(), kNone);
  for (std::size_t i = 0; i < slots.size(); ++i)
  {
    const auto id = static_cast<std::size_t>(slots[i].id);
    const int before = Signature::constantOf(slots[i], binding);
    const bool fits = before == kNone
                          ? slots[i].is_variable && variables.domains[id].contains(arguments[i])
                          : before == arguments[i];
    if (!fits)
    {
      return std::nullopt;
    }
    if (slots[i].is_variable)
    {
      binding[id] = arguments[i];
    }
  }
  return binding;
}

std::optional<reasoner::SourcePosition> Semantics::forbidden(const Values& state,
                                                             const GroundAction& action) const
{
  const auto entry = executabilities_.find(action.symbol);
  if (entry == executabilities_.end())
  {
    return std::nullopt;
  }
  for (const CompiledExecutability& law : entry->second)
  {
    std::optional<Binding> binding = bound(law.variables, law.arguments, action.arguments);
    const auto stop = [](const Binding&) { return false; };
    if (binding &&
        !forEachMatch(signature_, law.variables, law.body, state, *binding, stop, Truth::kPossibly))
    {
      return law.position;
    }
  }
  return std::nullopt;
}

bool Semantics::affects(const GroundAction& action, std::size_t fluent) const
{
  const auto entry = laws_.find(action.symbol);
  if (entry == laws_.end())
  {
    return false;
  }
  for (const CompiledLaw& law : entry->second)
  {
    const std::optional<Binding> binding = bound(law.variables, law.arguments, action.arguments);
    for (const CompiledOutcome& outcome : law.outcomes)
    {
      for (const CompiledEffect& effect : outcome.effects)
      {
        if (binding && signature_.fluentIndex(effect.fluent, *binding) == fluent)
        {
          return true;
        }
      }
    }
  }
  return false;
}

std::vector<GroundObservation> Semantics::observations(const GroundAction& action) const
{
  std::vector<GroundObservation> result;
  const auto entry = observations_.find(action.symbol);
  if (entry == observations_.end())
  {
    return result;
  }
  for (const CompiledObservation& law : entry->second)
  {
    const std::optional<Binding> binding = bound(law.variables, law.arguments, action.arguments);
    const std::optional<std::size_t> fluent =
        binding ? signature_.fluentIndex(law.fluent, *binding) : std::nullopt;
    if (fluent)
    {
      result.push_back(
          {*fluent, law.has_value ? Signature::constantOf(law.fluent.value, *binding) : kNone});
    }
  }
  return result;
}

std::vector<Values> Semantics::states(std::size_t max_states) const
{
  std::vector<Values> result;
  Values state(fluents().size(), kNone);
  extend(state, 0, max_states, result);
  return result;
}

void Semantics::extend(Values& state, std::size_t fluent, std::size_t max_states,
                       std::vector<Values>& found) const
{
  Values closed = state;
  if (close(closed))
  {
    return;
  }
  if (fluent == signature_.numInertial())
  {
    if (!complete(closed))
    {
      return;
    }
    if (found.size() == max_states)
    {
      throw ResourceExhausted("the zoomed description has more than " + std::to_string(max_states) +
                              " states. Its fluents: " + largestFluents(signature_) +
                              ". Keep fewer elements of their sorts (of the arguments, or of the "
                              "values), magnify into fewer components, or raise the limit");
    }
    found.push_back(std::move(closed));
    return;
  }
  for (const int value : fluents()[fluent].values)
  {
    if (closed[fluent] == kNone || closed[fluent] == value)
    {
      state[fluent] = value;
      extend(state, fluent + 1, max_states, found);
    }
  }
  state[fluent] = kNone;
}

}  // namespace kr3::refinement
