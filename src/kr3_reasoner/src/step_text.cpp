#include "step_text.hpp"

#include <algorithm>
#include <set>
#include <unordered_map>
#include <utility>

#include "encoding.hpp"
#include "solver.hpp"
#include "symbol_text.hpp"

namespace kr3::reasoner
{

namespace
{

using AtomId = StepProgram::AtomId;

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

/// The description as if there were no exogenous actions.
Description withoutExogenous(Description description)
{
  std::set<std::string> exogenous;
  for (const ActionDeclaration& action : description.actions)
  {
    if (action.exogenous)
    {
      exogenous.insert(action.name);
    }
  }
  const auto isExogenous = [&](const std::string& name) { return exogenous.count(name) > 0; };
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

/// Finds the atoms that a StepProgram names among those that clingo grounded.
class AtomReader
{
public:
  AtomReader(const std::vector<GroundFluent>& fluents, const std::vector<GroundAction>& actions)
    : fluents_(fluents)
  {
    std::size_t num_values = 0;
    for (const GroundFluent& fluent : fluents)
    {
      fluent_numbers_.emplace(toSymbol(fluent.symbol, fluent.arguments), first_value_.size());
      first_value_.push_back(num_values);
      num_values += fluent.values.size();
    }
    values_.resize(fluents.size());
    for (const GroundAction& action : actions)
    {
      action_numbers_.emplace(toSymbol(action.symbol, action.arguments), action_numbers_.size());
    }
    num_values_ = num_values;
  }

  void read(const Clingo::SymbolicAtoms& atoms, StepProgram& program)
  {
    program.before.assign(num_values_, 0);
    program.now.assign(num_values_, 0);
    program.occurs.assign(action_numbers_.size(), 0);
    program.impossible.assign(action_numbers_.size(), 0);
    program.prices_of.resize(action_numbers_.size());
    readValues(atoms, program);
    readUnequal(atoms, program);
    readActions(atoms, "occ", program.occurs);
    readActions(atoms, "imp", program.impossible);
    for (auto it = atoms.begin(Clingo::Signature("price", 3)); it; ++it)
    {
      const auto arguments = it->symbol().arguments();
      program.prices_of[action_numbers_.at(arguments[0])].push_back(
          {arguments[1].number(), static_cast<AtomId>(it->literal())});
    }
    for (auto& prices : program.prices_of)
    {
      std::sort(prices.begin(), prices.end(),
                [](const auto& a, const auto& b) { return a.cost_milli > b.cost_milli; });
    }
    for (auto it = atoms.begin(Clingo::Signature("out", 5)); it; ++it)
    {
      const auto arguments = it->symbol().arguments();
      program.outcomes.push_back({static_cast<std::size_t>(arguments[0].number()),
                                  static_cast<std::size_t>(arguments[1].number()),
                                  static_cast<int>(action_numbers_.at(arguments[3])),
                                  static_cast<AtomId>(it->literal())});
    }
  }

private:
  void readValues(const Clingo::SymbolicAtoms& atoms, StepProgram& program)
  {
    for (auto it = atoms.begin(Clingo::Signature("h", 3)); it; ++it)
    {
      const auto arguments = it->symbol().arguments();
      const std::size_t fluent = fluent_numbers_.at(arguments[0]);
      auto& numbered = arguments[2].number() == 0 ? program.before : program.now;
      numbered[first_value_[fluent] + valueOf(fluent, arguments[1])] =
          static_cast<AtomId>(it->literal());
    }
  }

  std::size_t valueOf(std::size_t fluent, Clingo::Symbol value)
  {
    auto& numbers = values_[fluent];
    if (numbers.empty())
    {
      for (const std::string& name : fluents_[fluent].values)
      {
        numbers.emplace(toSymbol(name), numbers.size());
      }
    }
    return numbers.at(value);
  }

  /// Further atoms that last from step to step follow the values of fluents.
  static void readUnequal(const Clingo::SymbolicAtoms& atoms, StepProgram& program)
  {
    std::unordered_map<std::string, std::size_t> carried;
    for (auto it = atoms.begin(Clingo::Signature("ne", 3)); it; ++it)
    {
      const auto arguments = it->symbol().arguments();
      const std::string name = arguments[0].to_string() + "!=" + arguments[1].to_string();
      const auto [place, fresh] = carried.emplace(name, program.now.size());
      if (fresh)
      {
        program.before.push_back(0);
        program.now.push_back(0);
      }
      (arguments[2].number() == 0 ? program.before : program.now)[place->second] =
          static_cast<AtomId>(it->literal());
    }
  }

  void readActions(const Clingo::SymbolicAtoms& atoms, const char* name,
                   std::vector<AtomId>& numbered) const
  {
    for (auto it = atoms.begin(Clingo::Signature(name, 2)); it; ++it)
    {
      numbered[action_numbers_.at(it->symbol().arguments()[0])] =
          static_cast<AtomId>(it->literal());
    }
  }

  const std::vector<GroundFluent>& fluents_;
  std::size_t num_values_ = 0;
  std::vector<std::size_t> first_value_;
  std::unordered_map<Clingo::Symbol, std::size_t> fluent_numbers_;
  std::unordered_map<Clingo::Symbol, std::size_t> action_numbers_;
  std::vector<std::unordered_map<Clingo::Symbol, std::size_t>> values_;  // by fluent
};

}  // namespace

StepProgram groundStepText(const Description& description, const std::vector<GroundFluent>& fluents,
                           const std::vector<GroundAction>& actions, const SearchLimit& limit)
{
  std::set<std::string> present;
  for (const GroundAction& action : actions)
  {
    present.insert(action.symbol);
  }
  const bool exogenous = std::any_of(description.actions.begin(), description.actions.end(),
                                     [&](const ActionDeclaration& action) {
    return action.exogenous && present.count(action.name) > 0;
  });
  const Description used = exogenous ? description : withoutExogenous(description);
  const Encoding encoding(used);
  GroundProgramRecorder recorder;
  Solver solver({"--warn=none"}, limit);
  solver.control().register_observer(recorder, true);
  solver.add("base", {}, encoding.signature() + kInputRules);
  solver.add("outputs", {}, kOutputRules);
  solver.add("executability", {"_t"}, encoding.executability());
  solver.add("prices", {"_t"}, encoding.prices());
  solver.add("effects", {"_t"}, encoding.effects());
  solver.add("state", {"_t"}, encoding.constraints());
  StepProgram program;
  GroundProgram facts;
  recorder.recordInto(facts);
  solver.ground({{"base", {}}, {"outputs", {}}});
  recorder.recordInto(program.executability);
  solver.ground({{"executability", {1}}});
  recorder.recordInto(program.prices);
  solver.ground({{"prices", {1}}});
  recorder.recordInto(program.effects);
  solver.ground({{"effects", {1}}});
  recorder.recordInto(program.state);
  solver.ground({{"state", {1}}});
  AtomReader(fluents, actions).read(solver.control().symbolic_atoms(), program);
  return program;
}

}  // namespace kr3::reasoner
