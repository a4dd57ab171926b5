#include "optimum.hpp"

#include <algorithm>
#include <cstdlib>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "literal_truths.hpp"
#include "solved_history.hpp"

namespace kr3::reasoner
{

namespace
{

using Records = std::vector<CheckedRecord>;

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
  full.useAssumptions(components);
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
  solved.history->useAssumptions(components);
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
  solved.history->useAssumptions(components);
  Optimum optimum{assumable, partsOf(solved.history->assumptions(), components), 0,
                  SettledAssumptions{}};
  const bool consistent = solved.solver.solve([&](const Clingo::Model& model) {
    optimum.explanation = assumedIn(model, *solved.history);
    return true;
  });
  if (!consistent)
  {
    return std::nullopt;
  }
  for (const AssumedLiteral& assumption : solved.history->assumptions())
  {
    if (std::binary_search(optimum.explanation.begin(), optimum.explanation.end(), assumption.what))
    {
      Price& part = optimum.price.parts[optimum.price.partOf(assumption.what)];
      part.add(assumption.price, assumption.is_retraction);
    }
  }
  {
    RuleSink sink(solved.solver.control());
    solved.history->bound(optimum.price, sink);
  }
  solved.solver.configure("solve.opt_mode", "optN");
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

}  // namespace kr3::reasoner
