#include "progression.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>
#include <utility>

#include <kr3_common/error.hpp>

#include "unrolled_history.hpp"
#include "words.hpp"

namespace kr3::reasoner
{

namespace
{

using Records = std::vector<CheckedRecord>;

Atom atomOf(const GroundFluent& fluent)
{
  Atom atom;
  atom.name = fluent.symbol;
  for (const std::string& argument : fluent.arguments)
  {
    atom.arguments.push_back({false, argument});
  }
  return atom;
}

/// `wrong(R)` by the number of another list of records.
Clingo::Symbol renumbered(const Clingo::Symbol& what, const std::map<int, int>& numbers)
{
  return what.match("wrong", 1)
             ? Clingo::Function("wrong", {Clingo::Number(numbers.at(what.arguments()[0].number()))})
             : what;
}

}  // namespace

/// The history before the new first step with certain kinds of assumption, in components.
class Progression::Level
{
public:
  Level(const HistoryProgram& program, const Records& records, int step, const Assumable& assumable)
    : limit_(program.limit())
  {
    RuleSink sink(ground_, &components_);
    history_ = std::make_unique<UnrolledHistory>(program, records, step,
                                                 UnrolledHistory::Mode{assumable}, sink);
    distribute(step);
  }

  /// The table of each component. Fluents in components that are too large are added to
  /// `too_large`.
  BeginningLevel tabulate(LocalTables& tables, std::vector<std::vector<std::string>>& too_large)
  {
    BeginningLevel level;
    level.consistent = consistent_;
    level.components = std::move(known_);
    for (Part& part : parts_)
    {
      limit_.check();
      if (!level.consistent)
      {
        break;
      }
      const LocalTable table = tables.of(part.program, limit_);
      if (!table.complete)
      {
        too_large.emplace_back();
        for (const OpenFluent& fluent : part.component.fluents)
        {
          too_large.back().push_back(toString(fluent.atom));
        }
        continue;
      }
      level.consistent = !table.rows.empty();
      add(std::move(part.component), table, level);
    }
    if (!level.consistent)
    {
      level.components.clear();
    }
    return level;
  }

private:
  struct Part
  {
    BeginningComponent component;
    LocalProgram program;
    std::unordered_map<Clingo::atom_t, Clingo::atom_t> atoms;

    SolverLiteral local(SolverLiteral literal)
    {
      const auto atom = static_cast<Clingo::atom_t>(std::abs(literal));
      const auto [place, fresh] = atoms.emplace(atom, program.num_atoms + 1);
      program.num_atoms += fresh ? 1 : 0;
      const auto number = static_cast<SolverLiteral>(place->second);
      return literal < 0 ? -number : number;
    }
  };

  Part& partOf(SolverLiteral literal)
  {
    const auto representative =
        components_.representative(static_cast<AtomComponents::Atom>(std::abs(literal)));
    const auto [place, fresh] = part_numbers_.emplace(representative, parts_.size());
    if (fresh)
    {
      parts_.emplace_back();
    }
    return parts_[place->second];
  }

  void distribute(int step)
  {
    const Dynamics& dynamics = history_->dynamics();
    const StateLiterals& state = history_->state(step);
    const auto valueOf = [&](std::size_t fluent, std::size_t value) {
      return state[dynamics.firstValue(fluent) + value];
    };
    std::vector<std::size_t> open;
    for (std::size_t f = 0; f < dynamics.fluents().size(); ++f)
    {
      const GroundFluent& fluent = dynamics.fluents()[f];
      if (fluent.kind == FluentKind::kDefined)
      {
        continue;
      }
      std::vector<Clingo::literal_t> literals;
      bool known = false;
      for (std::size_t v = 0; v < fluent.values.size(); ++v)
      {
        const SolverLiteral literal = valueOf(f, v);
        if (literal == kTrueLiteral)
        {
          known = true;
          addKnown(atomOf(fluent), fluent.values[v]);
        }
        else if (literal != kFalseLiteral)
        {
          literals.push_back(literal);
        }
      }
      if (known)
      {
        continue;
      }
      if (literals.empty())
      {
        consistent_ = false;
        return;
      }
      components_.join(literals);
      open.push_back(f);
    }
    history_->useAssumptions(components_);
    // From here on nothing is joined any more: parts are numbered by what hangs together.
    for (const std::size_t f : open)
    {
      const GroundFluent& fluent = dynamics.fluents()[f];
      Part* part = nullptr;
      std::vector<SolverLiteral> literals;
      for (std::size_t v = 0; v < fluent.values.size(); ++v)
      {
        if (!isConstant(valueOf(f, v)))
        {
          part = &partOf(valueOf(f, v));
          literals.push_back(part->local(valueOf(f, v)));
        }
        else
        {
          literals.push_back(kFalseLiteral);
        }
      }
      part->component.fluents.push_back({atomOf(fluent), fluent.values});
      part->program.fluents.push_back(std::move(literals));
    }
    addAssumptions();
    addRules();
  }

  /// A component of its own, with one row.
  void addKnown(const Atom& fluent, const std::string& value)
  {
    known_.push_back({{{fluent, {value}}}, {}, {{{0}, {{}}}}});
  }

  void addAssumptions()
  {
    BeginningComponent paid;  // whatever is the case
    for (const AssumedLiteral& assumption : history_->assumptions())
    {
      const CarriedAssumption carried{assumption.what, assumption.price, assumption.is_retraction};
      if (assumption.literal == kTrueLiteral)
      {
        paid.assumptions.push_back(carried);
      }
      else if (assumption.literal != kFalseLiteral)
      {
        Part& part = partOf(assumption.literal);
        part.component.assumptions.push_back(carried);
        part.program.assumptions.push_back(
            {part.local(assumption.literal), assumption.price, assumption.is_retraction});
      }
    }
    if (!paid.assumptions.empty())
    {
      paid.rows.push_back({{}, {{}}});
      for (std::size_t i = 0; i < paid.assumptions.size(); ++i)
      {
        paid.rows.front().explanations.front().push_back(i);
      }
      known_.push_back(std::move(paid));
    }
  }

  void addRules()
  {
    for (const GroundProgram::Rule& rule : ground_.rules())
    {
      const auto heads = ground_.heads(rule);
      const auto body = ground_.body(rule);
      if (!rule.choice && heads.size() == 1 && !components_.isUsed(*heads.begin()))
      {
        continue;  // nothing at the new first step depends on it
      }
      if (heads.size() == 0 && body.size() == 0)
      {
        consistent_ = false;
        return;
      }
      Part& part = partOf(heads.size() > 0 ? static_cast<SolverLiteral>(*heads.begin())
                                           : body.begin()->literal);
      LocalProgram::Rule local{rule.choice, rule.conjunction, rule.bound, {}, {}};
      for (const GroundProgram::AtomId head : heads)
      {
        local.heads.push_back(
            static_cast<Clingo::atom_t>(part.local(static_cast<SolverLiteral>(head))));
      }
      for (const auto& literal : body)
      {
        local.body.emplace_back(part.local(literal.literal), literal.weight);
      }
      part.program.rules.push_back(std::move(local));
    }
  }

  /// Writes a component down with what its rows have: other values and assumptions go.
  static void add(BeginningComponent component, const LocalTable& table, BeginningLevel& level)
  {
    const bool nothing = component.fluents.empty() && !table.rows.empty() &&
                         table.rows.front().explanations.front().empty();
    if (nothing)
    {
      return;
    }
    std::vector<std::map<std::size_t, std::size_t>> values(component.fluents.size());
    std::map<std::size_t, std::size_t> assumed;
    for (const LocalTable::Row& row : table.rows)
    {
      for (std::size_t f = 0; f < row.values.size(); ++f)
      {
        values[f].emplace(row.values[f], 0);
      }
      for (const auto& explanation : row.explanations)
      {
        for (const std::size_t i : explanation)
        {
          assumed.emplace(i, 0);
        }
      }
    }
    for (std::size_t f = 0; f < values.size(); ++f)
    {
      std::vector<std::string> kept;
      for (auto& [value, number] : values[f])
      {
        number = kept.size();
        kept.push_back(component.fluents[f].values[value]);
      }
      component.fluents[f].values = std::move(kept);
    }
    std::vector<CarriedAssumption> kept;
    for (auto& [assumption, number] : assumed)
    {
      number = kept.size();
      kept.push_back(component.assumptions[assumption]);
    }
    component.assumptions = std::move(kept);
    for (const LocalTable::Row& row : table.rows)
    {
      BeginningRow written;
      for (std::size_t f = 0; f < row.values.size(); ++f)
      {
        written.values.push_back(values[f].at(row.values[f]));
      }
      for (const auto& explanation : row.explanations)
      {
        written.explanations.emplace_back();
        for (const std::size_t i : explanation)
        {
          written.explanations.back().push_back(assumed.at(i));
        }
      }
      component.rows.push_back(std::move(written));
    }
    level.components.push_back(std::move(component));
  }

  SearchLimit limit_;
  GroundProgram ground_;
  AtomComponents components_;
  std::unique_ptr<UnrolledHistory> history_;
  bool consistent_ = true;
  std::vector<BeginningComponent> known_;
  std::vector<Part> parts_;
  std::unordered_map<AtomComponents::Atom, std::size_t> part_numbers_;
};

namespace
{

/// The fluent's value, if the component is nothing but that.
std::optional<Literal> factOf(const BeginningComponent& component)
{
  if (component.fluents.size() != 1 || component.fluents.front().values.size() != 1 ||
      !component.assumptions.empty())
  {
    return std::nullopt;
  }
  return Literal{
      component.fluents.front().atom, {false, component.fluents.front().values.front()}, true};
}

using Levels = std::array<std::optional<BeginningLevel>, kNumAssumables>;

/// What is so at every level is moved out of them.
std::vector<Literal> takeFacts(Levels& levels)
{
  std::map<std::string, std::size_t> counts;
  std::size_t num_levels = 0;
  for (const auto& level : levels)
  {
    num_levels += level && level->consistent ? 1 : 0;
    for (std::size_t c = 0; level && c < level->components.size(); ++c)
    {
      if (const auto fact = factOf(level->components[c]))
      {
        ++counts[toString(*fact)];
      }
    }
  }
  std::vector<Literal> facts;
  std::set<std::string> taken;
  for (auto& level : levels)
  {
    if (!level)
    {
      continue;
    }
    auto& components = level->components;
    components.erase(std::remove_if(
                         components.begin(), components.end(),
                         [&](const BeginningComponent& component) {
      const auto fact = factOf(component);
      const bool everywhere = fact && counts.at(toString(*fact)) == num_levels;
      if (everywhere && taken.insert(toString(*fact)).second)
      {
        facts.push_back(*fact);
      }
      return everywhere;
                         }),
                     components.end());
  }
  return facts;
}

/// Gives the records that explanations take to be wrong their numbers in Beginning::retractable.
std::vector<CheckedRecord> takeRetractable(Levels& levels, const Records& records,
                                           const Beginning* before)
{
  std::map<int, int> numbers;
  std::vector<CheckedRecord> kept;
  for (auto& level : levels)
  {
    for (std::size_t c = 0; level && c < level->components.size(); ++c)
    {
      for (CarriedAssumption& assumption : level->components[c].assumptions)
      {
        if (assumption.what.match("wrong", 1))
        {
          const int number = assumption.what.arguments()[0].number();
          const auto [place, fresh] = numbers.emplace(number, -1 - static_cast<int>(kept.size()));
          if (fresh)
          {
            kept.push_back(number < 0 ? before->retractable[static_cast<std::size_t>(-1 - number)]
                                      : records[static_cast<std::size_t>(number)]);
          }
        }
        assumption.what = renumbered(assumption.what, numbers);
      }
    }
  }
  return kept;
}

std::string obstacle(const std::vector<std::string>& fluents, int step, std::size_t limit,
                     bool exogenous)
{
  constexpr std::size_t kMaxNamed = 4;
  std::vector<std::string> named(
      fluents.begin(),
      fluents.begin() + static_cast<std::ptrdiff_t>(std::min(fluents.size(), kMaxNamed)));
  if (fluents.size() > kMaxNamed)
  {
    named.push_back(std::to_string(fluents.size() - kMaxNamed) + " more fluents");
  }
  return listed(named) + (fluents.size() > 1 ? " hang together and have" : " has") + " more than " +
         std::to_string(limit) + " combinations of values at step " + std::to_string(step) +
         (exogenous ? ", when exogenous actions may be assumed" : "");
}

}  // namespace

Progression::Result Progression::progressed(const HistoryProgram& program, const Records& records,
                                            int step)
{
  const Beginning* before = program.beginning();
  Records dropped;
  for (const CheckedRecord& checked : records)
  {
    if (checked.record.step < step)
    {
      dropped.push_back(checked);
    }
  }
  auto beginning = std::make_shared<Beginning>();
  beginning->first_step = step;
  beginning->num_records = dropped.size() + (before == nullptr ? 0 : before->num_records);
  beginning->uncertain = (before != nullptr && before->uncertain) ||
                         std::any_of(dropped.begin(), dropped.end(), [](const auto& checked) {
                           return !checked.isAction() && checked.record.confidence < 1.0;
                         });
  Result result;
  Levels levels;
  for (const bool retractions : {false, true})
  {
    for (const bool exogenous : {false, true})
    {
      if (retractions && !beginning->uncertain)
      {
        continue;  // the same as without
      }
      const Assumable kinds{exogenous, retractions};
      std::vector<std::vector<std::string>> too_large;
      levels[indexOf(kinds)] = Level(program, dropped, step, kinds).tabulate(tables_, too_large);
      for (const auto& fluents : too_large)
      {
        result.obstacles.push_back(obstacle(fluents, step, limits_.max_combinations, exogenous));
      }
      if (!too_large.empty())
      {
        return result;
      }
    }
  }
  if (std::none_of(levels.begin(), levels.end(),
                   [](const auto& level) { return level && level->consistent; }))
  {
    throw FailedPrecondition("the records before step " + std::to_string(step) +
                             " are inconsistent: the history cannot begin there");
  }
  beginning->facts = takeFacts(levels);
  beginning->retractable = takeRetractable(levels, dropped, before);
  for (const bool exogenous : {false, true})
  {
    auto& plain = beginning->levels[indexOf({exogenous, false})];
    auto& doubting = beginning->levels[indexOf({exogenous, true})];
    plain = std::make_shared<BeginningLevel>(std::move(*levels[indexOf({exogenous, false})]));
    auto& other = levels[indexOf({exogenous, true})];
    doubting = other ? std::make_shared<BeginningLevel>(std::move(*other)) : plain;
  }
  result.beginning = std::move(beginning);
  return result;
}

}  // namespace kr3::reasoner
