#include "closure.hpp"

#include <algorithm>
#include <utility>

#include "solver.hpp"

namespace kr3::reasoner
{

namespace
{

// What may be assumed is the caller's choice.
const char* const kInputRules = "#external ab(_X) : abducible(_X).\n";

}  // namespace

Closure::Closure(const std::string& rules, std::vector<std::string> statements,
                 const SearchLimit& limit)
  : statements_(std::move(statements))
{
  std::string text = rules + kInputRules;
  for (std::size_t i = 0; i < statements_.size(); ++i)
  {
    const std::string record = "rec(" + std::to_string(i) + ")";
    text += "#external " + record + ".\n" + statements_[i] + " :- " + record + ".\n";
    statement_numbers_.emplace(statements_[i], i);
  }
  statement_atoms_.assign(statements_.size(), 0);
  GroundProgramRecorder recorder;
  GroundProgram program;
  recorder.recordInto(program);
  Solver solver({"--warn=none"}, limit);
  solver.control().register_observer(recorder, true);
  solver.add("base", {}, text);
  solver.ground({{"base", {}}});
  readAtoms(solver.control().symbolic_atoms());
  const std::size_t num_rules = program.rules().size();
  program_.emplace_back(std::move(program), num_rules, std::vector<std::vector<AtomId>>{});
}

void Closure::readAtoms(const Clingo::SymbolicAtoms& atoms)
{
  const auto forEach = [&](const char* name, unsigned arity, auto visit) {
    for (auto it = atoms.begin(Clingo::Signature(name, arity)); it; ++it)
    {
      visit(it->symbol().arguments(), static_cast<AtomId>(it->literal()));
    }
  };
  forEach("rec", 1, [&](const auto& arguments, AtomId atom) {
    statement_atoms_[static_cast<std::size_t>(arguments[0].number())] = atom;
  });
  for (const bool equal : {true, false})
  {
    forEach(equal ? "c" : "cn", 2, [&](const auto& arguments, AtomId atom) {
      entries_.push_back({arguments[0], arguments[1], equal, atom});
    });
  }
  std::unordered_map<Clingo::Symbol, int> prices;
  forEach("weight", 2, [&](const auto& arguments, AtomId) {
    prices.emplace(arguments[0], arguments[1].number());
  });
  forEach("ab", 1, [&](const auto& arguments, AtomId atom) {
    exceptions_.push_back({arguments[0], prices.at(arguments[0]), atom});
  });
  forEach("st", 2,
          [&](const auto& arguments, AtomId) { statics_[arguments[0]].push_back(arguments[1]); });
  std::unordered_map<Clingo::Symbol, Clingo::Symbol> fluent_of;
  forEach("hd", 4,
          [&](const auto& arguments, AtomId) { fluent_of.emplace(arguments[0], arguments[1]); });
  forEach("fires", 1, [&](const auto& arguments, AtomId atom) {
    const Clingo::Symbol instance = arguments[0];  // d(Name,Variables)
    defaults_[fluent_of.at(instance)].push_back({instance.arguments()[0], atom});
  });
}

bool Closure::covers(const std::vector<std::string>& statements) const
{
  return std::all_of(statements.begin(), statements.end(), [&](const std::string& statement) {
    return statement_numbers_.count(statement) > 0;
  });
}

const std::vector<Clingo::Symbol>& Closure::staticValues(Clingo::Symbol name) const
{
  static const std::vector<Clingo::Symbol> none;
  const auto found = statics_.find(name);
  return found == statics_.end() ? none : found->second;
}

std::vector<SolverLiteral> Closure::instantiate(const std::vector<SolverLiteral>& stated,
                                                const std::vector<SolverLiteral>& assumed,
                                                RuleSink& sink)
{
  PartialEvaluator& program = program_.front();
  std::vector<SolverLiteral> values(program.program().numAtoms() + 1, PartialEvaluator::kOpen);
  const auto set = [&](AtomId atom, SolverLiteral literal) {
    if (atom < values.size())  // else no rule speaks of it
    {
      values[atom] = literal;
    }
  };
  for (std::size_t i = 0; i < statement_atoms_.size(); ++i)
  {
    set(statement_atoms_[i], stated[i]);
  }
  for (std::size_t i = 0; i < exceptions_.size(); ++i)
  {
    set(exceptions_[i].atom, assumed[i]);
  }
  program.instantiate(values, sink);
  return values;
}

const std::vector<Closure::DefaultInstance>& Closure::defaultsAbout(Clingo::Symbol fluent) const
{
  static const std::vector<DefaultInstance> none;
  const auto found = defaults_.find(fluent);
  return found == defaults_.end() ? none : found->second;
}

}  // namespace kr3::reasoner
