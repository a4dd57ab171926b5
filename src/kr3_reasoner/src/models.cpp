#include "models.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "solved_history.hpp"

namespace kr3::reasoner
{

namespace
{

using Records = std::vector<CheckedRecord>;

std::vector<SolverLiteral> stateLiterals(const UnrolledHistory& history)
{
  std::vector<SolverLiteral> literals;
  for (int step = history.firstStep(); step <= history.currentStep(); ++step)
  {
    const StateLiterals& state = history.state(step);
    literals.insert(literals.end(), state.begin(), state.end());
  }
  return literals;
}

}  // namespace

Consequences::Consequences(const Description& /*description*/, const HistoryProgram& program,
                           const Records& records, int current_step, const Optimum& optimum)
  : history_(optimum.constant_history)
{
  if (history_)
  {
    return;
  }
  SolvedHistory solved(program, records, current_step, optimum, {"0", "--warn=none"});
  truths_ = LiteralTruths(solved.solver, stateLiterals(*solved.history));
  history_ = std::move(solved.history);
}

bool Consequences::inAll(const Literal& literal, int step) const
{
  return truths_.inAll(history_->literal(literal, step));
}

bool Consequences::inSome(const Literal& literal, int step) const
{
  return truths_.inSome(history_->literal(literal, step));
}

StateLiterals Consequences::known(int step, StateLiterals state) const
{
  const StateLiterals& own = history_->state(step);
  for (std::size_t i = 0; i < history_->dynamics().numValues(); ++i)
  {
    if (truths_.inAll(own[i]))
    {
      state[i] = kTrueLiteral;
    }
    else if (!truths_.inSome(own[i]))
    {
      state[i] = kFalseLiteral;
    }
  }
  return state;
}

std::vector<SymbolicModel> modelsOf(const HistoryProgram& program, const Records& records,
                                    int current_step, const Optimum& optimum, std::size_t limit)
{
  SolvedHistory solved(program, records, current_step, optimum,
                       {std::to_string(limit), "--project=project", "--warn=none"});
  const UnrolledHistory& history = *solved.history;
  const Dynamics& dynamics = history.dynamics();
  std::vector<SolverLiteral> literals = stateLiterals(history);
  const std::vector<SolverLiteral> assumed = literalsOf(history.assumptions());
  literals.insert(literals.end(), assumed.begin(), assumed.end());
  std::vector<SymbolicModel> models;
  solved.forEachModel(literals, [&](const Clingo::Model& model) {
    SymbolicModel read;
    read.assumed = assumedIn(model, history);
    for (int step = history.firstStep(); step <= current_step; ++step)
    {
      for (std::size_t f = 0; f < dynamics.fluents().size(); ++f)
      {
        const GroundFluent& fluent = dynamics.fluents()[f];
        for (std::size_t v = 0; v < fluent.values.size(); ++v)
        {
          const SolverLiteral literal = history.state(step)[dynamics.firstValue(f) + v];
          const bool is_atom = fluent.kind != FluentKind::kDefined || v == 1;
          if (is_atom && isTrue(literal, model))
          {
            read.holds.push_back(
                Clingo::Function("h", {toSymbol(fluent.symbol, fluent.arguments),
                                       toSymbol(fluent.values[v]), Clingo::Number(step)}));
          }
        }
      }
    }
    for (int step = history.firstStep(); step < current_step; ++step)
    {
      const std::vector<SolverLiteral>& occurs = history.occurrences(step);
      for (std::size_t a = 0; a < occurs.size(); ++a)
      {
        if (isTrue(occurs[a], model))
        {
          read.occurs.push_back(
              Clingo::Function("occ", {dynamics.actions()[a].symbol, Clingo::Number(step)}));
        }
      }
    }
    std::sort(read.occurs.begin(), read.occurs.end());
    models.push_back(std::move(read));
    return true;
  });
  return models;
}

std::vector<std::size_t> minimalConflict(const HistoryProgram& program, const Records& records,
                                         int current_step)
{
  SolvedHistory solved(program, records, current_step,
                       UnrolledHistory::Mode{{true, true}, nullptr, true}, {"1", "--warn=none"});
  const std::vector<SolverLiteral>& switches = solved.history->switches();
  std::vector<bool> kept(records.size(), true);
  const auto consistent = [&] {
    std::vector<SolverLiteral> assumed;
    for (std::size_t i = 0; i < records.size(); ++i)
    {
      assumed.push_back(kept[i] ? switches[i] : -switches[i]);
    }
    return solved.solver.isSatisfiable(assumed);
  };
  // Whatever is not needed for the conflict goes, one record after the other.
  for (std::size_t i = 0; i < records.size(); ++i)
  {
    kept[i] = false;
    if (consistent())
    {
      kept[i] = true;
    }
  }
  std::vector<std::size_t> conflict;
  for (std::size_t i = 0; i < records.size(); ++i)
  {
    if (kept[i])
    {
      conflict.push_back(i);
    }
  }
  return conflict;
}

}  // namespace kr3::reasoner
