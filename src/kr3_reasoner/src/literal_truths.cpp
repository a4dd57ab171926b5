#include "literal_truths.hpp"

#include <cstdlib>

namespace kr3::reasoner
{

LiteralTruths::LiteralTruths(Solver& solver, const std::vector<SolverLiteral>& literals)
{
  std::vector<SolverLiteral> atoms;
  for (const SolverLiteral literal : literals)
  {
    if (!isConstant(literal) && truths_.emplace(std::abs(literal), Truth{}).second)
    {
      atoms.push_back(std::abs(literal));
    }
  }
  if (atoms.empty())
  {
    return;
  }
  // clingo computes consequences of what has a name.
  const char* const name = "asked";
  {
    Clingo::Backend backend = solver.control().backend();
    for (std::size_t i = 0; i < atoms.size(); ++i)
    {
      const Clingo::Symbol symbol = Clingo::Function(name, {Clingo::Number(static_cast<int>(i))});
      const Clingo::atom_t named = backend.add_atom(symbol);
      backend.rule(false, {&named, 1}, {&atoms[i], 1});
    }
  }
  solver.configure("solve.models", "0");
  for (const bool all : {true, false})
  {
    solver.configure("solve.enum_mode", all ? "cautious" : "brave");
    Clingo::SymbolVector last;
    solver.solve([&](const Clingo::Model& model) {
      last = model.symbols(Clingo::ShowType::Shown);  // the last is the answer
      return true;
    });
    for (const Clingo::Symbol symbol : last)
    {
      if (symbol.match(name, 1))
      {
        Truth& truth = truths_.at(atoms[static_cast<std::size_t>(symbol.arguments()[0].number())]);
        (all ? truth.in_all : truth.in_some) = true;
      }
    }
  }
  solver.configure("solve.enum_mode", "auto");
}

bool LiteralTruths::inAll(SolverLiteral literal) const
{
  if (isConstant(literal))
  {
    return literal == kTrueLiteral;
  }
  const Truth& truth = truths_.at(std::abs(literal));
  return literal > 0 ? truth.in_all : !truth.in_some;
}

}  // namespace kr3::reasoner
