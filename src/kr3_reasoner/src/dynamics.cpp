#include "dynamics.hpp"

#include <algorithm>
#include <utility>

#include "ground_fluents.hpp"
#include "solver.hpp"

namespace kr3::reasoner
{

namespace
{

using AtomId = GroundProgram::AtomId;

// The state before the transition and the occurrences are inputs, so nothing may be simplified
// away. The state after it may have any value, since inertia is added only later.
const char* const kInputRules = R"(
#external h(_F,_V,0) : fv(_F,_V).
#external h(_F,true,0) : defined(_F).
#external ne(_F,_V,0) : watched(_F,_V).
#external occ(_A,0) : agent(_A).
#external occ(_A,0) : exog(_A).
)";
const char* const kOutputRules = "#external h(_F,_V,1) : fv(_F,_V).\n";

enum Programs
{
  kInitial,
  kExecutability,
  kPrices,
  kTransition
};

/// The description as if there were no exogenous actions.
Description withoutExogenous(Description description)
{
  const auto isExogenous = [&](const std::string& name) {
    const ActionDeclaration* action = description.findAction(name);
    return action != nullptr && action->exogenous;
  };
  auto& laws = description.causal_laws;
  laws.erase(std::remove_if(laws.begin(), laws.end(),
                            [&](const CausalLaw& law) { return isExogenous(law.action.name); }),
             laws.end());
  auto& rules = description.executabilities;
  rules.erase(std::remove_if(
                  rules.begin(), rules.end(),
                  [&](const Executability& rule) {
    return std::any_of(rule.actions.begin(), rule.actions.end(), [&](const auto& action) {
      const auto* atom = std::get_if<Atom>(&action);
      return atom != nullptr && isExogenous(atom->name);
    });
                  }),
              rules.end());
  auto& actions = description.actions;
  actions.erase(std::remove_if(actions.begin(), actions.end(),
                               [](const ActionDeclaration& action) { return action.exogenous; }),
                actions.end());
  return description;
}

}  // namespace

Clingo::Symbol toSymbol(const std::string& constant)
{
  const bool number =
      constant.find_first_not_of("0123456789", constant[0] == '-' ? 1 : 0) == std::string::npos;
  return number ? Clingo::Number(std::stoi(constant)) : Clingo::Id(constant.c_str());
}

Clingo::Symbol toSymbol(const std::string& name, const std::vector<std::string>& arguments)
{
  Clingo::SymbolVector symbols;
  for (const std::string& argument : arguments)
  {
    symbols.push_back(toSymbol(argument));
  }
  return Clingo::Function(name.c_str(), {symbols.data(), symbols.size()});
}

Clingo::Symbol toSymbol(const Atom& ground)
{
  std::vector<std::string> arguments;
  for (const Term& argument : ground.arguments)
  {
    arguments.push_back(argument.name);
  }
  return toSymbol(ground.name, arguments);
}

Dynamics::Dynamics(const Description& description, bool exogenous, const SearchLimit& limit)
  : fluents_(groundFluents(description))
{
  numberFluents();
  const Description used = exogenous ? description : withoutExogenous(description);
  numberActions(used);
  buildPrograms(ground(used, limit));
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
  before_.assign(num_values_, 0);
  now_.assign(num_values_, 0);
}

void Dynamics::numberActions(const Description& description)
{
  for (const ActionDeclaration& action : description.actions)
  {
    for (const auto& arguments : argumentTuples(action.argument_sorts, description))
    {
      const auto number = static_cast<int>(actions_.size());
      actions_.push_back({groundName(action.name, arguments), arguments,
                          toSymbol(action.name, arguments), action.exogenous, 0, 0});
      action_numbers_.emplace(actions_.back().name, number);
      action_symbols_.emplace(actions_.back().symbol, number);
    }
  }
}

Dynamics::Rules Dynamics::ground(const Description& description, const SearchLimit& limit)
{
  const Encoding encoding(description);
  GroundProgramRecorder recorder;
  Solver solver({"--warn=none"}, limit);
  solver.control().register_observer(recorder, true);
  solver.add("base", {}, encoding.signature() + kInputRules);
  solver.add("outputs", {}, kOutputRules);
  solver.add("executability", {"_t"}, encoding.executability());
  solver.add("prices", {"_t"}, encoding.prices());
  solver.add("effects", {"_t"}, encoding.effects());
  solver.add("state", {"_t"}, encoding.constraints());
  Rules rules;
  GroundProgram facts;
  recorder.recordInto(facts);
  solver.ground({{"base", {}}, {"outputs", {}}});
  recorder.recordInto(rules.executability);
  solver.ground({{"executability", {1}}});
  recorder.recordInto(rules.prices);
  solver.ground({{"prices", {1}}});
  recorder.recordInto(rules.effects);
  solver.ground({{"effects", {1}}});
  recorder.recordInto(rules.state);
  solver.ground({{"state", {1}}});
  readAtoms(solver.control().symbolic_atoms());
  return rules;
}

void Dynamics::readAtoms(const Clingo::SymbolicAtoms& atoms)
{
  std::vector<std::unordered_map<Clingo::Symbol, std::size_t>> values(fluents_.size());
  const auto valueOf = [&](std::size_t fluent, Clingo::Symbol value) {
    auto& numbers = values[fluent];
    if (numbers.empty())
    {
      for (const std::string& name : fluents_[fluent].values)
      {
        numbers.emplace(toSymbol(name), numbers.size());
      }
    }
    return numbers.at(value);
  };
  for (auto it = atoms.begin(Clingo::Signature("h", 3)); it; ++it)
  {
    const auto arguments = it->symbol().arguments();
    const auto fluent = static_cast<std::size_t>(fluent_symbols_.at(arguments[0]));
    auto& numbered = arguments[2].number() == 0 ? before_ : now_;
    numbered[first_value_[fluent] + valueOf(fluent, arguments[1])] =
        static_cast<AtomId>(it->literal());
  }
  // Further atoms that last from step to step follow the values of fluents.
  std::unordered_map<std::string, std::size_t> carried;
  for (const bool before : {true, false})
  {
    for (auto it = atoms.begin(Clingo::Signature("ne", 3)); it; ++it)
    {
      const auto arguments = it->symbol().arguments();
      if ((arguments[2].number() == 0) != before)
      {
        continue;
      }
      const std::string name = arguments[0].to_string() + "!=" + arguments[1].to_string();
      const auto [place, fresh] = carried.emplace(name, now_.size());
      if (fresh)
      {
        before_.push_back(0);
        now_.push_back(0);
      }
      (before ? before_ : now_)[place->second] = static_cast<AtomId>(it->literal());
    }
  }
  const auto readActions = [&](const char* name, AtomId Action::*atom) {
    for (auto it = atoms.begin(Clingo::Signature(name, 2)); it; ++it)
    {
      const auto found = action_symbols_.find(it->symbol().arguments()[0]);
      actions_[static_cast<std::size_t>(found->second)].*atom = static_cast<AtomId>(it->literal());
    }
  };
  readActions("occ", &Action::occurs);
  readActions("imp", &Action::impossible);
  prices_.resize(actions_.size());
  for (auto it = atoms.begin(Clingo::Signature("price", 3)); it; ++it)
  {
    const auto arguments = it->symbol().arguments();
    prices_[static_cast<std::size_t>(action_symbols_.at(arguments[0]))].push_back(
        {arguments[1].number(), static_cast<AtomId>(it->literal())});
  }
  for (std::vector<PriceAtom>& prices : prices_)
  {
    std::sort(prices.begin(), prices.end(),
              [](const PriceAtom& a, const PriceAtom& b) { return a.cost_milli > b.cost_milli; });
  }
}

/// Adds what holds for every description: that a fluent has one value, and that it keeps it.
void Dynamics::buildPrograms(Rules rules)
{
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
    for (const PriceAtom& price : prices_[a])
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
