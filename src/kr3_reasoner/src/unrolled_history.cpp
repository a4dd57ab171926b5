#include "unrolled_history.hpp"

#include <algorithm>
#include <map>
#include <utility>

namespace kr3::reasoner
{

namespace
{

constexpr SolverLiteral kOpen = PartialEvaluator::kOpen;

Clingo::Symbol about(const char* name, Clingo::Symbol what, int step)
{
  return Clingo::Function(name, {what, Clingo::Number(step)});
}

bool needsExogenous(const Description& description, const std::vector<CheckedRecord>& records)
{
  return std::any_of(records.begin(), records.end(), [&](const CheckedRecord& record) {
    return record.isAction() && description.findAction(record.action.name)->exogenous;
  });
}

}  // namespace

Price PriceByPart::total() const
{
  Price sum;
  for (const Price& part : parts)
  {
    sum.retractions += part.retractions;
    sum.assumptions += part.assumptions;
  }
  return sum;
}

std::size_t PriceByPart::partOf(Clingo::Symbol what) const
{
  const auto found = part_of.find(what);
  return found == part_of.end() ? 0 : found->second;
}

UnrolledHistory::UnrolledHistory(const HistoryProgram& program,
                                 const std::vector<CheckedRecord>& records, int current_step,
                                 Mode mode, RuleSink& sink)
  : program_(program)
  , mode_(mode)
  , first_step_(program.firstStep())
  , dynamics_(program.dynamics(mode.assumable.exogenous ||
                               needsExogenous(program.description(), records)))
  , closure_(program.closureFor(records))
{
  for (std::size_t i = 0; i < records.size(); ++i)
  {
    SolverLiteral holds = kTrueLiteral;
    if (mode_.switchable)
    {
      switches_.push_back(sink.newChoice());
      holds = switches_.back();
    }
    const SolverLiteral kept = retractable(records, i, sink);
    holds_.push_back(sink.conjunction({holds, kept}));
  }
  if (program_.beginning() == nullptr)
  {
    addInitialState(records, sink);
  }
  else
  {
    addBeginning(records, sink);
  }
  std::vector<std::vector<std::size_t>> observed(
      static_cast<std::size_t>(current_step - first_step_) + 1);
  for (std::size_t i = 0; i < records.size(); ++i)
  {
    if (!records[i].isAction())
    {
      observed[static_cast<std::size_t>(records[i].record.step - first_step_)].push_back(i);
    }
  }
  for (int step = first_step_; step <= current_step; ++step)
  {
    program_.limit().check();
    if (step > first_step_)
    {
      addTransition(records, step, sink);
    }
    for (const std::size_t i : observed[static_cast<std::size_t>(step - first_step_)])
    {
      addObservation(records[i], holds_[i], sink);
    }
  }
}

// ---- Assumptions ----

SolverLiteral UnrolledHistory::settled(Clingo::Symbol what) const
{
  if (mode_.settled == nullptr)
  {
    return kOpen;
  }
  const auto found = mode_.settled->find(what);
  return found == mode_.settled->end() ? kFalseLiteral : found->second;
}

SolverLiteral UnrolledHistory::assume(Clingo::Symbol what, int price, bool is_retraction,
                                      RuleSink& sink)
{
  SolverLiteral literal = settled(what);
  if (literal == kFalseLiteral)
  {
    return kFalseLiteral;
  }
  if (literal == kOpen)
  {
    literal = sink.newChoice();
  }
  assumptions_.push_back({what, literal, price, is_retraction});
  return literal;
}

SolverLiteral UnrolledHistory::retractable(const Records& records, std::size_t index,
                                           RuleSink& sink)
{
  const CheckedRecord& record = records[index];
  if (!mode_.assumable.retractions || record.isAction() || record.record.confidence >= 1.0)
  {
    return kTrueLiteral;
  }
  const Clingo::Symbol wrong = Clingo::Function("wrong", {Clingo::Number(static_cast<int>(index))});
  return -assume(wrong, doubtOf(record.record), true, sink);
}

/// That an attempt fails: as it must when the action is impossible, or else at a price.
SolverLiteral UnrolledHistory::failure(const CheckedRecord& attempt, SolverLiteral impossible,
                                       RuleSink& sink)
{
  if (impossible == kTrueLiteral)
  {
    return kTrueLiteral;
  }
  const Clingo::Symbol what = about("fail", toSymbol(attempt.action), attempt.record.step);
  const SolverLiteral known = settled(what);
  if (known == kFalseLiteral)
  {
    return impossible;
  }
  const SolverLiteral fails = known == kTrueLiteral ? kTrueLiteral : sink.newChoice();
  assumptions_.push_back(
      {what, sink.conjunction({fails, -impossible}), program_.options().exogenous_weight, false});
  return fails;
}

void UnrolledHistory::bound(const PriceByPart& price, RuleSink& sink) const
{
  struct Part
  {
    int left = 0;
    int sum = 0;
    std::vector<Clingo::WeightedLiteral> open;
  };
  for (const bool retraction : {true, false})
  {
    std::vector<Part> parts(price.parts.size());
    for (std::size_t i = 0; i < parts.size(); ++i)
    {
      parts[i].left = retraction ? price.parts[i].retractions : price.parts[i].assumptions;
    }
    for (const AssumedLiteral& assumption : assumptions_)
    {
      if (assumption.is_retraction == retraction && assumption.literal != kFalseLiteral)
      {
        Part& part = parts[price.partOf(assumption.what)];
        if (assumption.literal == kTrueLiteral)
        {
          part.left -= assumption.price;
          continue;
        }
        part.open.emplace_back(assumption.literal, assumption.price);
        part.sum += assumption.price;
      }
    }
    for (const Part& part : parts)
    {
      if (part.left < 0)
      {
        sink.contradiction();
      }
      else if (part.sum > part.left)
      {
        sink.weightRule(false, {}, part.left + 1, part.open);
      }
    }
  }
}

void UnrolledHistory::useAssumptions(AtomComponents& components) const
{
  for (const AssumedLiteral& assumption : assumptions_)
  {
    if (!isConstant(assumption.literal))
    {
      components.use(static_cast<AtomComponents::Atom>(std::abs(assumption.literal)));
    }
  }
}

bool UnrolledHistory::minimize(RuleSink& sink) const
{
  bool any = false;
  for (const bool retraction : {true, false})
  {
    std::vector<Clingo::WeightedLiteral> open;
    for (const AssumedLiteral& assumption : assumptions_)
    {
      if (assumption.is_retraction == retraction && !isConstant(assumption.literal))
      {
        open.emplace_back(assumption.literal, assumption.price);
      }
    }
    if (!open.empty())
    {
      sink.minimize(retraction ? 2 : 1, open);
      any = true;
    }
  }
  return any;
}

// ---- Steps ----

void UnrolledHistory::addInitialState(const Records& records, RuleSink& sink)
{
  // A statement of the closure may come from several records.
  std::map<std::string, std::vector<SolverLiteral>> recorded;
  for (std::size_t i = 0; i < records.size(); ++i)
  {
    const std::string statement = program_.initialStatement(records[i]);
    if (!statement.empty())
    {
      recorded[statement].push_back(holds_[i]);
    }
  }
  std::vector<SolverLiteral> stated;
  for (const std::string& statement : closure_->statements())
  {
    const auto found = recorded.find(statement);
    stated.push_back(found == recorded.end() ? kFalseLiteral : sink.disjunction(found->second));
  }
  std::vector<SolverLiteral> assumed;
  for (const Closure::Exception& exception : closure_->exceptions())
  {
    assumed.push_back(assume(exception.what, exception.price, false, sink));
  }
  closure_values_ = closure_->instantiate(stated, assumed, sink);

  StateLiterals known(dynamics_.numValues(), kOpen);
  struct Open
  {
    SolverLiteral entry;
    std::size_t index;
    bool equal;
  };
  std::vector<Open> open;
  for (const Closure::Entry& entry : closure_->entries())
  {
    const SolverLiteral literal = closure_values_[entry.atom];
    const int fluent = dynamics_.fluentNumber(entry.fluent);
    const int index = fluent < 0 ? -1 : dynamics_.valueIndex(fluent, entry.value.to_string());
    if (index < 0)
    {
      // A value that the fluent does not have: it cannot be known to hold.
      if (entry.equal && fluent >= 0)
      {
        sink.constraint({literal});
      }
      continue;
    }
    const auto i = static_cast<std::size_t>(index);
    const bool defined =
        dynamics_.fluents()[static_cast<std::size_t>(fluent)].kind == FluentKind::kDefined;
    if (literal == kTrueLiteral && !defined)
    {
      const SolverLiteral value = entry.equal ? kTrueLiteral : kFalseLiteral;
      if (known[i] == -value)
      {
        sink.contradiction();
      }
      known[i] = value;
    }
    else if (literal != kFalseLiteral)
    {
      open.push_back({literal, i, entry.equal});
    }
  }
  states_.push_back(dynamics_.initialState(known, sink));
  for (const Open& entry : open)
  {
    const SolverLiteral value = states_[0][entry.index];
    sink.constraint({entry.entry, entry.equal ? -value : value});
  }
}

void UnrolledHistory::addTransition(const Records& records, int step, RuleSink& sink)
{
  const StateLiterals& before = states_.back();
  const auto& actions = dynamics_.actions();
  std::vector<std::size_t> recorded;
  std::vector<int> asked;
  for (std::size_t i = 0; i < records.size(); ++i)
  {
    if (records[i].isAction() && records[i].record.step == step - 1)
    {
      recorded.push_back(i);
      asked.push_back(dynamics_.actionNumber(toString(records[i].action)));
    }
  }
  if (mode_.assumable.exogenous)
  {
    for (std::size_t a = 0; a < actions.size(); ++a)
    {
      if (actions[a].exogenous)
      {
        asked.push_back(static_cast<int>(a));
      }
    }
  }
  const std::vector<SolverLiteral> impossible = dynamics_.impossible(before, asked, sink);

  std::vector<std::vector<SolverLiteral>> reasons(actions.size());
  std::map<std::size_t, SolverLiteral> failures;  // an action recorded twice fails once
  for (const std::size_t i : recorded)
  {
    const auto action =
        static_cast<std::size_t>(dynamics_.actionNumber(toString(records[i].action)));
    const bool attempt = records[i].record.kind == RecordKind::kAttempted;
    SolverLiteral fails = kFalseLiteral;
    if (attempt)
    {
      const auto known = failures.find(action);
      fails =
          known != failures.end() ? known->second : failure(records[i], impossible[action], sink);
      failures.emplace(action, fails);
    }
    reasons[action].push_back(sink.conjunction({holds_[i], -fails}));
  }
  std::vector<SolverLiteral> occurs(actions.size(), kFalseLiteral);
  for (std::size_t a = 0; a < actions.size(); ++a)
  {
    // Without its record, what is recorded may have happened all the same.
    if (mode_.assumable.exogenous && actions[a].exogenous && impossible[a] != kTrueLiteral &&
        (reasons[a].empty() || mode_.switchable))
    {
      reasons[a].push_back(assume(about("exo", actions[a].symbol, step - 1),
                                  program_.options().exogenous_weight, false, sink));
    }
    if (!reasons[a].empty())
    {
      occurs[a] = sink.disjunction(reasons[a]);
      sink.constraint({occurs[a], impossible[a]});
    }
  }
  StateLiterals after = dynamics_.successor(before, occurs, sink);
  states_.push_back(std::move(after));
  occurrences_.push_back(std::move(occurs));
}

void UnrolledHistory::addObservation(const CheckedRecord& record, SolverLiteral holds,
                                     RuleSink& sink) const
{
  sink.constraint({holds, -literal(record.literal, record.record.step)});
}

// ---- Literals ----

SolverLiteral UnrolledHistory::literalIn(const Literal& open, const StateLiterals& state) const
{
  const Literal literal = normalized(open, program_.description());
  const FluentDeclaration& fluent = *program_.description().findFluent(literal.atom.name);
  if (fluent.kind == FluentKind::kStatic)
  {
    return staticHolds(literal) ? kTrueLiteral : kFalseLiteral;
  }
  const int number = dynamics_.fluentNumber(toString(literal.atom));
  const int index = number < 0 ? -1 : dynamics_.valueIndex(number, literal.value.name);
  const SolverLiteral value = index < 0 ? kFalseLiteral : state[static_cast<std::size_t>(index)];
  return literal.equal ? value : -value;
}

bool UnrolledHistory::staticHolds(const Literal& literal) const
{
  const std::vector<Clingo::Symbol>& values = closure_->staticValues(toSymbol(literal.atom));
  const auto has = [&](const std::string& value) {
    return std::find(values.begin(), values.end(), toSymbol(value)) != values.end();
  };
  if (!program_.description().findFluent(literal.atom.name)->value_sort)
  {
    return has("true") == (literal.value.name == "true");
  }
  return has(literal.value.name) == literal.equal;
}

std::vector<UnrolledHistory::FiringDefault> UnrolledHistory::defaultsAbout(
    Clingo::Symbol fluent) const
{
  std::vector<FiringDefault> firing;
  if (closure_values_.empty())  // progressed: what fired is in the beginning
  {
    return firing;
  }
  for (const Closure::DefaultInstance& instance : closure_->defaultsAbout(fluent))
  {
    firing.push_back({instance.name, closure_values_[instance.fires]});
  }
  return firing;
}

}  // namespace kr3::reasoner
