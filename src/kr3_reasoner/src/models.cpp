#include "models.hpp"

#include <algorithm>
#include <cstdlib>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include <kr3_common/error.hpp>

namespace kr3::reasoner
{

namespace
{

using Records = std::vector<CheckedRecord>;

/// A history in a solver of its own.
struct SolvedHistory
{
  SolvedHistory(const HistoryProgram& program, const Records& records, int current_step,
                const UnrolledHistory::Mode& mode, const std::vector<std::string>& arguments,
                AtomComponents* components = nullptr)
    : solver(arguments, program.limit())
  {
    RuleSink sink(solver, components);
    history = std::make_unique<UnrolledHistory>(program, records, current_step, mode, sink);
    is_constant = sink.numRules() == 0;
  }

  /// With minimal explanations only.
  SolvedHistory(const HistoryProgram& program, const Records& records, int current_step,
                const Optimum& optimum, const std::vector<std::string>& arguments)
    : SolvedHistory(program, records, current_step,
                    UnrolledHistory::Mode{optimum.assumable,
                                          optimum.settled ? &*optimum.settled : nullptr, false},
                    arguments)
  {
    RuleSink sink(solver);
    history->bound(optimum.price, sink);
  }

  [[nodiscard]] bool isConsistent() { return is_constant || solver.isSatisfiable(); }

  Solver solver;
  std::unique_ptr<UnrolledHistory> history;
  bool is_constant = false;  ///< nothing is left to solve
};

std::vector<SolverLiteral> literalsOf(const std::vector<AssumedLiteral>& assumptions)
{
  std::vector<SolverLiteral> literals;
  for (const AssumedLiteral& assumption : assumptions)
  {
    literals.push_back(assumption.literal);
  }
  return literals;
}

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

/// Calls visit(model) for each model that differs in these literals, until it returns false.
template <typename Visit>
void forEachModel(SolvedHistory& solved, const std::vector<SolverLiteral>& literals,
                  const Visit& visit)
{
  const std::vector<Clingo::atom_t> atoms = openAtoms(literals);
  solved.solver.control().with_backend([&](Clingo::Backend& backend) {
    backend.project({atoms.data(), atoms.size()});
  });
  solved.solver.solve(visit);
}

/// The assumptions in those components of the program that are not settled without any; the others
/// make none in a minimal explanation. Found without a solver; nothing where that does not tell.
///
/// A component in which everything is constant when nothing is assumed, and no constraint violated,
/// is consistent with nothing assumed.
std::optional<SettledAssumptions> suspects(const HistoryProgram& program, const Records& records,
                                           int current_step, const Assumable& assumable)
{
  if (program.beginning() != nullptr)
  {
    return std::nullopt;
  }
  const SettledAssumptions nothing;
  RuleSink counted;
  const UnrolledHistory plain(program, records, current_step,
                              UnrolledHistory::Mode{assumable, &nothing, false}, counted);
  AtomComponents components;
  RuleSink joined(&components);
  const UnrolledHistory full(program, records, current_step, UnrolledHistory::Mode{assumable},
                             joined);
  std::unordered_set<AtomComponents::Atom> suspected;
  const auto suspect = [&](SolverLiteral literal) {
    if (!isConstant(literal))
    {
      suspected.insert(
          components.representative(static_cast<AtomComponents::Atom>(std::abs(literal))));
    }
  };
  std::size_t refuted = 0;
  for (std::size_t i = 0; i < records.size(); ++i)
  {
    const CheckedRecord& checked = records[i];
    if (!checked.isAction() && plain.literal(checked.literal, checked.record.step) == kFalseLiteral)
    {
      ++refuted;
      suspect(full.literal(checked.literal, checked.record.step));
      suspect(full.recorded()[i]);
    }
  }
  if (refuted != counted.numContradictions() ||
      plain.closureValues().size() != full.closureValues().size())
  {
    return std::nullopt;  // something else is violated
  }
  const auto compare =
      [&](const std::vector<SolverLiteral>& without, const std::vector<SolverLiteral>& with) {
    for (std::size_t i = 0; i < without.size(); ++i)
    {
      if (!isConstant(without[i]))
      {
        suspect(with[i]);
      }
    }
  };
  compare(plain.closureValues(), full.closureValues());
  for (int step = full.firstStep(); step <= current_step; ++step)
  {
    compare(plain.state(step), full.state(step));
  }
  for (int step = full.firstStep(); step < current_step; ++step)
  {
    compare(plain.occurrences(step), full.occurrences(step));
  }
  SettledAssumptions open;
  for (const AssumedLiteral& assumption : full.assumptions())
  {
    if (!isConstant(assumption.literal) &&
        suspected.count(
            components.representative(static_cast<AtomComponents::Atom>(assumption.literal))) > 0)
    {
      open.emplace(assumption.what, PartialEvaluator::kOpen);
    }
  }
  return open;
}

/// The assumptions that a minimal explanation may make; nothing when the history is inconsistent.
///
/// Where the program falls into independent components, such as objects that nothing moves, one
/// that is consistent without assumptions makes none in a minimal explanation.
std::optional<SettledAssumptions> candidates(const HistoryProgram& program, const Records& records,
                                             int current_step, const Assumable& assumable)
{
  const std::optional<SettledAssumptions> wanted =
      suspects(program, records, current_step, assumable);
  AtomComponents components;
  SolvedHistory solved(program, records, current_step,
                       UnrolledHistory::Mode{assumable, wanted ? &*wanted : nullptr, false},
                       {"1", "--warn=none"}, &components);
  std::unordered_map<AtomComponents::Atom, std::vector<SolverLiteral>> denials;
  for (const AssumedLiteral& assumption : solved.history->assumptions())
  {
    if (!isConstant(assumption.literal))
    {
      const auto atom = static_cast<AtomComponents::Atom>(assumption.literal);
      denials[components.representative(atom)].push_back(-assumption.literal);
    }
  }
  std::unordered_set<AtomComponents::Atom> suspected;
  const bool consistent = solved.solver.solve([&](const Clingo::Model& model) {
    for (const auto& [component, literals] : denials)
    {
      if (std::any_of(literals.begin(), literals.end(),
                      [&](SolverLiteral denied) { return model.is_true(-denied); }))
      {
        suspected.insert(component);
      }
    }
    return true;
  });
  if (!consistent)
  {
    return std::nullopt;
  }
  std::unordered_set<AtomComponents::Atom> needed;
  for (const AtomComponents::Atom component : suspected)
  {
    if (!solved.solver.isSatisfiable(denials.at(component)))
    {
      needed.insert(component);
    }
  }
  SettledAssumptions open;
  for (const AssumedLiteral& assumption : solved.history->assumptions())
  {
    if (assumption.literal == kTrueLiteral)
    {
      open.emplace(assumption.what, kTrueLiteral);  // only a beginning calls for it at once
    }
    else if (assumption.literal != kFalseLiteral &&
             needed.count(components.representative(
                 static_cast<AtomComponents::Atom>(assumption.literal))) > 0)
    {
      open.emplace(assumption.what, PartialEvaluator::kOpen);
    }
  }
  return open;
}

/// The parts of what may be assumed, without prices.
PriceByPart partsOf(const std::vector<AssumedLiteral>& assumptions, AtomComponents& components)
{
  PriceByPart price;
  std::unordered_map<AtomComponents::Atom, std::size_t> parts;
  for (const AssumedLiteral& assumption : assumptions)
  {
    if (!isConstant(assumption.literal))
    {
      const auto atom = static_cast<AtomComponents::Atom>(std::abs(assumption.literal));
      const std::size_t part =
          parts.emplace(components.representative(atom), price.parts.size()).first->second;
      price.parts.resize(std::max(price.parts.size(), part + 1));
      price.part_of.emplace(assumption.what, part);
    }
  }
  return price;
}

/// The minimal price of a history when this may be assumed, and what minimal explanations assume.
std::optional<Optimum> minimalPrice(const HistoryProgram& program, const Records& records,
                                    int current_step, const Assumable& assumable)
{
  const auto open = candidates(program, records, current_step, assumable);
  if (!open)
  {
    return std::nullopt;
  }
  AtomComponents components;
  SolvedHistory solved(program, records, current_step,
                       UnrolledHistory::Mode{assumable, &*open, false},
                       {"0", "--opt-strategy=usc", "--warn=none"}, &components);
  {
    RuleSink sink(solved.solver.control());
    solved.history->minimize(sink);
  }
  Optimum optimum{assumable, partsOf(solved.history->assumptions(), components), 0,
                  SettledAssumptions{}};
  const bool consistent = solved.solver.solve([&](const Clingo::Model& model) {
    std::fill(optimum.price.parts.begin(), optimum.price.parts.end(), Price{});
    for (const AssumedLiteral& assumption : solved.history->assumptions())
    {
      if (isTrue(assumption.literal, model))
      {
        Price& part = optimum.price.parts[optimum.price.partOf(assumption.what)];
        (assumption.is_retraction ? part.retractions : part.assumptions) += assumption.price;
      }
    }
    return true;
  });
  if (!consistent)
  {
    return std::nullopt;
  }
  {
    RuleSink sink(solved.solver.control());
    solved.history->bound(optimum.price, sink);
  }
  solved.solver.configure("solve.opt_mode", "ignore");
  const LiteralTruths truths(solved.solver, literalsOf(solved.history->assumptions()));
  for (const AssumedLiteral& assumption : solved.history->assumptions())
  {
    if (truths.inSome(assumption.literal))
    {
      optimum.settled->emplace(assumption.what, truths.inAll(assumption.literal)
                                                    ? kTrueLiteral
                                                    : PartialEvaluator::kOpen);
    }
  }
  return optimum;
}

}  // namespace

Optimum anyPrice(bool exogenous)
{
  constexpr int kAnyPrice = 1000000;
  return {{exogenous, false}, {{{0, kAnyPrice}}, {}}};
}

std::vector<Assumable> assumableLevels(const Records& records, int current_step,
                                       bool exogenous_first, bool uncertain_otherwise)
{
  const bool uncertain = uncertain_otherwise || std::any_of(records.begin(), records.end(),
                                                            [](const CheckedRecord& checked) {
    return !checked.isAction() && checked.record.confidence < 1.0;
                         });
  std::vector<Assumable> levels = {{exogenous_first, false}};
  if (!exogenous_first && current_step > 0)
  {
    levels.push_back({true, false});
  }
  if (uncertain)
  {
    levels.push_back({exogenous_first, true});
    levels.push_back({true, true});
  }
  return levels;
}

std::optional<Optimum> findOptimum(const HistoryProgram& program, const Records& records,
                                   int current_step, bool exogenous_first,
                                   const ExplanationStart& start)
{
  // Most histories need no assumption; then nothing that could be assumed has to be looked at.
  Optimum none{{}, {}, start.level, SettledAssumptions{}};
  SolvedHistory unassuming(program, records, current_step, none, {"1", "--warn=none"});
  if (unassuming.isConsistent())
  {
    if (unassuming.is_constant)
    {
      none.constant_history = std::move(unassuming.history);
    }
    return none;
  }
  const bool uncertain =
      start.uncertain || (program.beginning() != nullptr && program.beginning()->uncertain);
  const auto levels = assumableLevels(records, current_step, exogenous_first, uncertain);
  for (auto level = static_cast<std::size_t>(start.level); level < levels.size(); ++level)
  {
    if (auto optimum = minimalPrice(program, records, current_step, levels[level]))
    {
      optimum->level = static_cast<int>(level);
      return optimum;
    }
  }
  return std::nullopt;
}

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

std::vector<std::vector<Clingo::Symbol>> explanationsOf(const HistoryProgram& program,
                                                        const Records& records, int current_step,
                                                        const Optimum& optimum)
{
  constexpr std::size_t kMaxExplanations = 200;
  if (optimum.price.total().sum() == 0)
  {
    return {{}};
  }
  SolvedHistory solved(program, records, current_step, optimum,
                       {"0", "--project=project", "--warn=none"});
  std::vector<std::vector<Clingo::Symbol>> explanations;
  forEachModel(solved, literalsOf(solved.history->assumptions()), [&](const Clingo::Model& model) {
    explanations.push_back(assumedIn(model, *solved.history));
    return explanations.size() < kMaxExplanations;
  });
  std::sort(explanations.begin(), explanations.end());
  return explanations;
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
  forEachModel(solved, literals, [&](const Clingo::Model& model) {
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
