#include "dynamics.hpp"

#include <algorithm>
#include <utility>

#include "ground_fluents.hpp"
#include "step_grounder.hpp"
#include "step_text.hpp"

namespace kr3::reasoner
{

namespace
{

using AtomId = GroundProgram::AtomId;

enum Programs
{
  kInitial,
  kExecutability,
  kPrices,
  kTransition
};

StepProgram groundedStep(const Description& description, bool exogenous,
                         const std::vector<GroundFluent>& fluents,
                         const std::vector<Dynamics::Action>& actions, const SearchLimit& limit)
{
  if (canGroundStep(description))
  {
    Vocabulary vocabulary(description);
    const Statics statics(vocabulary, limit);
    return groundStep(vocabulary, statics, Signature(vocabulary, exogenous), limit);
  }
  std::vector<GroundAction> used;
  for (const Dynamics::Action& action : actions)
  {
    used.push_back({action.name, action.symbol.name(), action.arguments});
  }
  return groundStepText(description, fluents, used, limit);
}

}  // namespace

Dynamics::Dynamics(const Description& description, bool exogenous, const SearchLimit& limit)
  : fluents_(groundFluents(description))
{
  numberFluents();
  numberActions(description, exogenous);
  buildPrograms(groundedStep(description, exogenous, fluents_, actions_, limit));
}

void Dynamics::numberFluents()
{
  for (std::size_t f = 0; f < fluents_.size(); ++f)
  {
    const auto number = static_cast<int>(f);
    fluent_numbers_.emplace(fluents_[f].name, number);
    fluent_symbols_.emplace(toSymbol(fluents_[f].symbol, fluents_[f].arguments), number);
    first_value_.push_back(num_values_);
    num_values_ += fluents_[f].values.size();
  }
}

void Dynamics::numberActions(const Description& description, bool exogenous)
{
  for (const ActionDeclaration& action : description.actions)
  {
    if (action.exogenous && !exogenous)
    {
      continue;
    }
    for (const auto& arguments : argumentTuples(action.argument_sorts, description))
    {
      const auto number = static_cast<int>(actions_.size());
      actions_.push_back({groundName(action.name, arguments), arguments,
                          toSymbol(action.name, arguments), action.exogenous, 0, 0});
      action_numbers_.emplace(actions_.back().name, number);
    }
  }
}

/// Adds what holds for every description: that a fluent has one value, and that it keeps it.
void Dynamics::buildPrograms(StepProgram rules)
{
  before_ = std::move(rules.before);
  now_ = std::move(rules.now);
  prices_ = std::move(rules.prices_of);
  for (std::size_t a = 0; a < actions_.size(); ++a)
  {
    actions_[a].occurs = rules.occurs[a];
    actions_[a].impossible = rules.impossible[a];
  }
  std::vector<std::vector<AtomId>> groups;
  GroundProgram initial = rules.state;
  GroundProgram transition = std::move(rules.effects);
  transition.append(rules.state);
  const std::size_t frame_begin = transition.rules().size();
  for (std::size_t f = 0; f < fluents_.size(); ++f)
  {
    if (fluents_[f].kind == FluentKind::kDefined)
    {
      continue;
    }
    groups.emplace_back();
    for (std::size_t v = 0; v < fluents_[f].values.size(); ++v)
    {
      const std::size_t index = first_value_[f] + v;
      groups.back().push_back(now_[index]);
      const auto before = static_cast<std::int32_t>(before_[index]);
      initial.addRule(true, {&now_[index], &now_[index] + 1}, {nullptr, nullptr});
      transition.addRule(true, {&now_[index], &now_[index] + 1}, {&before, &before + 1});
    }
  }
  const std::size_t num_initial = initial.rules().size();
  const std::size_t num_executability = rules.executability.rules().size();
  programs_.emplace_back(std::move(initial), num_initial, groups);
  programs_.emplace_back(std::move(rules.executability), num_executability,
                         std::vector<std::vector<AtomId>>{});
  const std::size_t num_prices = rules.prices.rules().size();
  programs_.emplace_back(std::move(rules.prices), num_prices, std::vector<std::vector<AtomId>>{});
  programs_.emplace_back(std::move(transition), frame_begin, std::move(groups));
}

// ---- Numbers ----

int Dynamics::fluentNumber(const std::string& name) const
{
  const auto found = fluent_numbers_.find(name);
  return found == fluent_numbers_.end() ? -1 : found->second;
}

int Dynamics::fluentNumber(Clingo::Symbol symbol) const
{
  const auto found = fluent_symbols_.find(symbol);
  return found == fluent_symbols_.end() ? -1 : found->second;
}

int Dynamics::actionNumber(const std::string& name) const
{
  const auto found = action_numbers_.find(name);
  return found == action_numbers_.end() ? -1 : found->second;
}

int Dynamics::valueIndex(int fluent, const std::string& value) const
{
  const auto number = static_cast<std::size_t>(fluent);
  const auto& values = fluents_[number].values;
  const auto found = std::find(values.begin(), values.end(), value);
  return found == values.end()
             ? -1
             : static_cast<int>(first_value_[number]) + static_cast<int>(found - values.begin());
}

// ---- Instances ----

StateLiterals Dynamics::read(const std::vector<SolverLiteral>& values) const
{
  StateLiterals state(now_.size(), kFalseLiteral);
  for (std::size_t i = 0; i < now_.size(); ++i)
  {
    if (now_[i] != 0 && now_[i] < values.size())
    {
      state[i] = values[now_[i]];
    }
  }
  for (std::size_t f = 0; f < fluents_.size(); ++f)
  {
    if (fluents_[f].kind == FluentKind::kDefined)
    {
      state[first_value_[f]] = -state[first_value_[f] + 1];  // {false, true}
    }
  }
  return state;
}

void Dynamics::write(const StateLiterals& state, std::vector<SolverLiteral>& values) const
{
  for (std::size_t i = 0; i < before_.size(); ++i)
  {
    if (before_[i] != 0 && before_[i] < values.size())
    {
      values[before_[i]] = state[i];
    }
  }
}

StateLiterals Dynamics::initialState(const StateLiterals& known, RuleSink& sink)
{
  PartialEvaluator& program = programs_[kInitial];
  std::vector<SolverLiteral> values(program.program().numAtoms() + 1, PartialEvaluator::kOpen);
  for (std::size_t i = 0; i < now_.size(); ++i)
  {
    if (i < known.size() && now_[i] != 0 && now_[i] < values.size())
    {
      values[now_[i]] = known[i];
    }
  }
  program.instantiate(values, sink);
  return read(values);
}

std::vector<SolverLiteral> Dynamics::impossible(const StateLiterals& state,
                                                const std::vector<int>& wanted, RuleSink& sink)
{
  PartialEvaluator& program = programs_[kExecutability];
  std::vector<SolverLiteral> values(program.program().numAtoms() + 1, PartialEvaluator::kOpen);
  write(state, values);
  std::vector<AtomId> needed;
  for (const int action : wanted)
  {
    const AtomId atom = actions_[static_cast<std::size_t>(action)].impossible;
    if (atom != 0)
    {
      needed.push_back(atom);
    }
  }
  if (!needed.empty())
  {
    program.instantiate(values, sink, &needed);
  }
  std::vector<SolverLiteral> impossible(actions_.size(), kFalseLiteral);
  for (const int action : wanted)
  {
    const AtomId atom = actions_[static_cast<std::size_t>(action)].impossible;
    impossible[static_cast<std::size_t>(action)] = atom != 0 ? values[atom] : kFalseLiteral;
  }
  return impossible;
}

std::vector<std::vector<ActionPrice>> Dynamics::prices(const StateLiterals& state, RuleSink& sink)
{
  PartialEvaluator& program = programs_[kPrices];
  std::vector<SolverLiteral> values(program.program().numAtoms() + 1, PartialEvaluator::kOpen);
  write(state, values);
  program.instantiate(values, sink);
  std::vector<std::vector<ActionPrice>> prices(actions_.size());
  for (std::size_t a = 0; a < actions_.size(); ++a)
  {
    for (const StepProgram::Price& price : prices_[a])
    {
      prices[a].push_back({price.cost_milli, values[price.atom]});
    }
  }
  return prices;
}

StateLiterals Dynamics::successor(const StateLiterals& state,
                                  const std::vector<SolverLiteral>& occurs, RuleSink& sink)
{
  PartialEvaluator& program = programs_[kTransition];
  std::vector<SolverLiteral> values(program.program().numAtoms() + 1, PartialEvaluator::kOpen);
  write(state, values);
  for (std::size_t a = 0; a < actions_.size(); ++a)
  {
    if (actions_[a].occurs < values.size())
    {
      values[actions_[a].occurs] = occurs[a];
    }
  }
  program.instantiate(values, sink);
  return read(values);
}

}  // namespace kr3::reasoner
