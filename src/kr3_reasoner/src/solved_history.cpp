#include "solved_history.hpp"

#include <algorithm>
#include <cstdlib>
#include <unordered_set>

namespace kr3::reasoner
{

namespace
{

/// The open atoms of these literals, each once.
std::vector<Clingo::atom_t> openAtoms(const std::vector<SolverLiteral>& literals)
{
  std::vector<Clingo::atom_t> atoms;
  std::unordered_set<SolverLiteral> seen;
  for (const SolverLiteral literal : literals)
  {
    if (!isConstant(literal) && seen.insert(std::abs(literal)).second)
    {
      atoms.push_back(static_cast<Clingo::atom_t>(std::abs(literal)));
    }
  }
  return atoms;
}

}  // namespace

SolvedHistory::SolvedHistory(const HistoryProgram& program,
                             const std::vector<CheckedRecord>& records, int current_step,
                             const UnrolledHistory::Mode& mode,
                             const std::vector<std::string>& arguments, AtomComponents* components)
  : solver(arguments, program.limit())
{
  RuleSink sink(solver, components);
  history = std::make_unique<UnrolledHistory>(program, records, current_step, mode, sink);
  is_constant = sink.numRules() == 0;
}

SolvedHistory::SolvedHistory(const HistoryProgram& program,
                             const std::vector<CheckedRecord>& records, int current_step,
                             const Optimum& optimum, const std::vector<std::string>& arguments)
  : SolvedHistory(program, records, current_step,
                  UnrolledHistory::Mode{optimum.assumable,
                                        optimum.settled ? &*optimum.settled : nullptr, false},
                  arguments)
{
  RuleSink sink(solver);
  history->bound(optimum.price, sink);
  minimises = optimum.settled && history->minimize(sink);
  if (minimises)
  {
    solver.configure("solver.opt_strategy", "usc");
    solver.configure("solve.opt_mode", "optN");
  }
}

void SolvedHistory::forEachModel(const std::vector<SolverLiteral>& literals,
                                 const std::function<bool(const Clingo::Model&)>& visit)
{
  const std::vector<Clingo::atom_t> atoms = openAtoms(literals);
  solver.control().with_backend([&](Clingo::Backend& backend) {
    backend.project({atoms.data(), atoms.size()});
  });
  solver.solve([&](const Clingo::Model& model) {
    return (minimises && !model.optimality_proven()) || visit(model);
  });
}

std::vector<SolverLiteral> literalsOf(const std::vector<AssumedLiteral>& assumptions)
{
  std::vector<SolverLiteral> literals;
  for (const AssumedLiteral& assumption : assumptions)
  {
    literals.push_back(assumption.literal);
  }
  return literals;
}

bool isTrue(SolverLiteral literal, const Clingo::Model& model)
{
  return isConstant(literal) ? literal == kTrueLiteral : model.is_true(literal);
}

std::vector<Clingo::Symbol> assumedIn(const Clingo::Model& model, const UnrolledHistory& history)
{
  std::vector<Clingo::Symbol> assumed;
  for (const AssumedLiteral& assumption : history.assumptions())
  {
    if (isTrue(assumption.literal, model))
    {
      assumed.push_back(assumption.what);
    }
  }
  std::sort(assumed.begin(), assumed.end());
  return assumed;
}

}  // namespace kr3::reasoner
