#include "kr3_reasoner/situation.hpp"

#include <algorithm>
#include <set>
#include <tuple>
#include <unordered_map>

#include <kr3_common/error.hpp>

#include "domain_knowledge.hpp"
#include "ground_fluents.hpp"
#include "kr3_reasoner/ground_literals.hpp"
#include "models.hpp"
#include "relevant_planner.hpp"
#include "retraction.hpp"
#include "situation_content.hpp"

namespace kr3::reasoner
{

// ---- Renaming ----

const std::string& Renaming::operator()(const std::string& name) const
{
  const auto found = names_.find(name);
  return found == names_.end() ? name : found->second;
}

std::string Renaming::ofText(const std::string& text) const
{
  std::string renamed;
  for (const std::string& token : tokensOf(text))
  {
    renamed += (*this)(token);
  }
  return renamed;
}

Renaming Renaming::inverse() const
{
  Renaming inverse;
  for (const auto& [from, to] : names_)
  {
    inverse.names_.emplace(to, from);
  }
  return inverse;
}

Renaming Renaming::then(const Renaming& second) const
{
  Renaming both;
  for (const auto& [from, to] : names_)
  {
    if (const std::string& last = second(to); last != from)
    {
      both.names_.emplace(from, last);
    }
  }
  for (const auto& [from, to] : second.names_)
  {
    if (names_.count(from) == 0)
    {
      both.names_.emplace(from, to);
    }
  }
  return both;
}

// ---- Situation ----

namespace
{

int stepOf(const std::shared_ptr<const Beginning>& beginning)
{
  return firstStepOf(beginning.get());
}

/// A record as situations have it.
Record plain(const Record& record, int step)
{
  Record kept{record.kind, record.statement, record.value, step, 1.0, ""};
  if (step > 0 && kept.kind == RecordKind::kInitially)
  {
    kept.kind = RecordKind::kObserved;
  }
  return kept;
}

bool before(const Record& a, const Record& b)
{
  return std::tie(a.kind, a.statement, a.value) < std::tie(b.kind, b.statement, b.value);
}

}  // namespace

Situation::Situation() : Situation(nullptr, {}) {}

Situation::Situation(std::shared_ptr<const Beginning> beginning, std::vector<Record> records)
  : beginning_(std::move(beginning)), records_(std::move(records))
{
  std::sort(records_.begin(), records_.end(), before);
  records_.erase(
      std::unique(records_.begin(), records_.end(),
                  [](const Record& a, const Record& b) { return !before(a, b) && !before(b, a); }),
      records_.end());
  text_ = textOf(saidOf(beginning_.get(), records_));
}

Situation Situation::with(const std::vector<Record>& records) const
{
  std::vector<Record> all = records_;
  for (const Record& record : records)
  {
    all.push_back(plain(record, stepOf(beginning_)));
  }
  return {beginning_, std::move(all)};
}

// ---- Situations ----

class Situations::Impl
{
public:
  Impl(Description description, const ReasonerOptions& options)
    : knowledge(std::move(description), options)
    , literals(knowledge.description())
    , fluents(groundFluents(knowledge.description()))
    , movable(interchangeable(knowledge.description()))
  {
    for (std::size_t i = 0; i < fluents.size(); ++i)
    {
      number.emplace(fluents[i].name, i);
    }
  }

  [[nodiscard]] std::vector<CheckedRecord> checked(const std::vector<Record>& records) const
  {
    std::vector<CheckedRecord> checked;
    for (const Record& record : records)
    {
      checked.push_back(checkRecord(record, knowledge.symbols()));
    }
    return checked;
  }

  [[nodiscard]] std::optional<Optimum> optimum(const HistoryProgram& program,
                                               const std::vector<CheckedRecord>& records) const
  {
    return findOptimum(program, records, program.firstStep(),
                       knowledge.options().diagnose_exogenous);
  }

  [[nodiscard]] std::optional<PossibleValues> valuesOf(
      const std::shared_ptr<const Beginning>& beginning, const std::vector<Record>& told,
      bool at_any_price)
  {
    const DomainKnowledge::Question question(knowledge, {}, "entailment");
    const HistoryProgram program = knowledge.program().beginningAt(beginning);
    const int step = stepOf(beginning);
    const std::vector<CheckedRecord> records = checked(told);
    const auto cheapest = optimum(program, records);
    if (!cheapest)
    {
      return std::nullopt;
    }
    const Consequences consequences(
        knowledge.description(), program, records, step,
        at_any_price ? anyPrice(cheapest->assumable.exogenous) : *cheapest);
    PossibleValues possible(fluents.size());
    for (std::size_t i = 0; i < possible.size(); ++i)
    {
      for (const std::string& value : fluents[i].values)
      {
        if (consequences.inSome(literalOf(fluents[i], value), step))
        {
          possible[i].push_back(value);
        }
      }
    }
    return possible;
  }

  DomainKnowledge knowledge;
  GroundLiterals literals;
  std::vector<GroundFluent> fluents;
  std::unordered_map<std::string, std::size_t> number;  // of a fluent, by name
  std::vector<std::vector<std::string>>
      movable;  // constants that the description cannot tell apart
};

Situations::Situations(Description description, const ReasonerOptions& options)
  : impl_(std::make_unique<Impl>(std::move(description), options))
{
}

Situations::~Situations() = default;

bool Situations::supported() const
{
  return impl_->knowledge.description().asp_blocks.empty();
}

RenamedSituation Situations::canonical(const Situation& situation, const std::string& about) const
{
  Said said = saidOf(situation.beginning_.get(), situation.records_);
  said.push_back(tokensOf(about));
  const Renaming renaming = canonicalNames(said, impl_->movable);
  std::vector<Record> records = situation.records_;
  for (Record& record : records)
  {
    record.statement = renaming.ofText(record.statement);
  }
  return {Situation(renamedBeginning(situation.beginning_, renaming), std::move(records)),
          renaming};
}

void Situations::check(const std::vector<Record>& records) const
{
  static_cast<void>(impl_->checked(records));
}

std::optional<Situations::Later> Situations::next(const Situation& situation)
{
  DomainKnowledge& knowledge = impl_->knowledge;
  const DomainKnowledge::Question question(knowledge, {}, "progression");
  const int step = stepOf(situation.beginning_);
  try
  {
    const Progression::Result progressed =
        knowledge.progression().progressed(knowledge.program().beginningAt(situation.beginning_),
                                           impl_->checked(situation.records_), step + 1);
    if (!progressed.beginning)
    {
      return std::nullopt;
    }
    return Later{Situation(settledBeginning(*progressed.beginning), {}),
                 differsInExceptionsOnly(progressed.beginning->level({}))};
  }
  catch (const FailedPrecondition&)
  {
    return std::nullopt;
  }
}

std::optional<Situations::PossibleValues> Situations::possibleValues(const Situation& situation)
{
  return impl_->valuesOf(situation.beginning_, situation.records_, false);
}

std::optional<Situations::PossibleValues> Situations::valuesAtAnyPrice(const Situation& situation)
{
  return impl_->valuesOf(situation.beginning_, situation.records_, true);
}

bool Situations::exceptionsExplain(const Situation& situation)
{
  const DomainKnowledge::Question question(impl_->knowledge, {}, "diagnosis");
  const auto optimum = impl_->optimum(impl_->knowledge.program().beginningAt(situation.beginning_),
                                      impl_->checked(situation.records_));
  return optimum && !optimum->assumable.exogenous;
}

std::vector<std::size_t> Situations::contraryTo(const std::vector<Record>& records,
                                                const Literal& literal) const
{
  const Literal wanted = normalized(literal, impl_->knowledge.description());
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < records.size(); ++i)
  {
    const CheckedRecord checked = checkRecord(records[i], impl_->knowledge.symbols());
    if (!checked.isAction() && contradicts(checked.literal, wanted))
    {
      indices.push_back(i);
    }
  }
  return indices;
}

Situation Situations::without(const Situation& situation, const Literal& contrary_to) const
{
  std::vector<Record> kept = situation.records_;
  const auto indices = contraryTo(kept, contrary_to);
  for (auto index = indices.rbegin(); index != indices.rend(); ++index)
  {
    kept.erase(kept.begin() + static_cast<std::ptrdiff_t>(*index));
  }
  return {situation.beginning_, std::move(kept)};
}

Retraction Situations::retraction(const std::vector<Record>& records,
                                  std::vector<std::size_t> indices, const Literal& opened) const
{
  const Description& description = impl_->knowledge.description();
  return retractionOf(records, std::move(indices),
                      toString(normalized(opened, description), description));
}

Situations::PossibleValues Situations::renamed(const PossibleValues& values,
                                               const Renaming& to) const
{
  PossibleValues renamed(values.size());
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    auto& there = renamed[impl_->number.at(to.ofText(impl_->fluents[i].name))];
    std::set<std::string> names;
    for (const std::string& value : values[i])
    {
      names.insert(to(value));
    }
    // A renaming keeps to the sorts: these are values of the other fluent too.
    for (const std::string& value : impl_->fluents[i].values)
    {
      if (names.count(value) > 0)
      {
        there.push_back(value);
      }
    }
  }
  return renamed;
}

std::vector<Literal> Situations::entailed(const PossibleValues& values) const
{
  std::vector<Literal> entailed;
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    if (values[i].size() == 1)
    {
      entailed.push_back(literalOf(impl_->fluents[i], values[i].front()));
      continue;
    }
    const std::set<std::string> possible(values[i].begin(), values[i].end());
    for (const std::string& value : impl_->fluents[i].values)
    {
      if (possible.count(value) == 0)
      {
        entailed.push_back(literalOf(impl_->fluents[i], value));
        entailed.back().equal = false;
      }
    }
  }
  return entailed;
}

std::optional<Answer> Situations::entails(const PossibleValues& values,
                                          const Literal& literal) const
{
  const auto found = impl_->number.find(toString(literal.atom));
  if (found == impl_->number.end())
  {
    return std::nullopt;
  }
  const auto& possible = values[found->second];
  const auto equal =
      static_cast<std::size_t>(std::count(possible.begin(), possible.end(), literal.value.name));
  const std::size_t models = literal.equal ? equal : possible.size() - equal;
  return models == 0                 ? Answer::kFalse
         : models == possible.size() ? Answer::kTrue
                                     : Answer::kUnknown;
}

PlanResult Situations::plan(const Situation& situation, const std::string& goal,
                            const PlanOptions& options, const std::atomic<bool>* cancel) const
{
  const Formula formula = parseGoal(goal, impl_->knowledge.description());
  checkPlanOptions(options);
  DomainKnowledge anew(impl_->knowledge.description(), impl_->knowledge.options());
  const DomainKnowledge::Question question(anew, {options.time_limit, cancel}, "planning");
  const std::vector<CheckedRecord> records = impl_->checked(situation.records_);
  return RelevantPlanner(anew, records, stepOf(situation.beginning_), formula, situation.beginning_)
      .plan(options, cancel);
}

PlanResult Situations::renamed(const PlanResult& plans, const Renaming& to) const
{
  PlanResult renamed = plans;
  for (Plan& plan : renamed.plans)
  {
    std::map<std::size_t, std::string> hypothesis;  // in the order of the fluents
    for (const std::string& literal : plan.hypothesis)
    {
      const std::string there = to.ofText(literal);
      hypothesis.emplace(impl_->number.at(toString(impl_->literals.of(there).atom)), there);
    }
    plan.hypothesis.clear();
    for (const auto& entry : hypothesis)
    {
      plan.hypothesis.push_back(entry.second);
    }
    for (auto& step : plan.steps)
    {
      for (std::string& action : step)
      {
        action = to.ofText(action);
      }
      std::sort(step.begin(), step.end());
    }
  }
  return renamed;
}

}  // namespace kr3::reasoner
