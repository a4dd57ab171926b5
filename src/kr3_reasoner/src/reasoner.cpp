#include "kr3_reasoner/reasoner.hpp"

#include <algorithm>
#include <optional>
#include <unordered_map>
#include <utility>

#include <kr3_common/error.hpp>

#include "explain.hpp"
#include "ground_fluents.hpp"
#include "models.hpp"
#include "planner.hpp"
#include "words.hpp"

namespace kr3::reasoner
{

namespace
{

Literal toLiteral(const GroundFluent& fluent, const std::string& value)
{
  Literal literal;
  literal.atom.name = fluent.symbol;
  for (const std::string& argument : fluent.arguments)
  {
    literal.atom.arguments.push_back({false, argument});
  }
  literal.value.name = value;
  return literal;
}

}  // namespace

class Reasoner::Impl
{
public:
  Impl(Description description, ReasonerOptions options)
    : description_(std::move(description))
    , options_(std::move(options))
    , program_(description_, options_)
  {
    bool prices = options_.exception_weight > 0 && options_.exogenous_weight > 0;
    for (const auto& [name, weight] : options_.default_weights)
    {
      prices = prices && weight > 0;
    }
    if (!prices)
    {
      throw InvalidArgument("found a price of an assumption below 1, expected at least 1");
    }
  }

  [[nodiscard]] int currentStep() const
  {
    int step = 0;
    for (const CheckedRecord& checked : records_)
    {
      step = std::max(step, checked.record.step + (checked.isAction() ? 1 : 0));
    }
    return step;
  }

  void take(std::vector<CheckedRecord> records)
  {
    records_ = std::move(records);
    history_.clear();
    for (const CheckedRecord& checked : records_)
    {
      history_.push_back(checked.record);
    }
    optimum_.reset();
    consequences_.reset();
  }

  /// The minimal price of the history; nothing when it is inconsistent.
  const std::optional<Optimum>& optimum()
  {
    if (!optimum_)
    {
      optimum_ = std::make_unique<std::optional<Optimum>>(
          findOptimum(program_, records_, currentStep(), options_.diagnose_exogenous));
    }
    return *optimum_;
  }

  const Consequences& consequences(int step)
  {
    if (step < 0 || step > currentStep())
    {
      throw InvalidArgument("found step " + std::to_string(step) +
                            ", expected one from 0 to the current step " +
                            std::to_string(currentStep()));
    }
    if (!consequences_)
    {
      if (!optimum())
      {
        throw FailedPrecondition("the history is inconsistent: " + conflictText());
      }
      consequences_ = std::make_unique<Consequences>(description_, program_, records_,
                                                     currentStep(), *optimum());
    }
    return *consequences_;
  }

  [[nodiscard]] std::vector<std::string> conflict() const
  {
    std::vector<std::string> texts;
    for (const std::size_t i : minimalConflict(program_, records_, currentStep()))
    {
      texts.push_back(toString(records_[i].record));
    }
    return texts;
  }

  [[nodiscard]] std::string conflictText() const
  {
    std::string text;
    for (const std::string& record : conflict())
    {
      text += (text.empty() ? "" : "; ") + record;
    }
    return text;
  }

  Description description_;
  ReasonerOptions options_;
  HistoryProgram program_;
  std::vector<CheckedRecord> records_;
  std::vector<Record> history_;

private:
  std::unique_ptr<std::optional<Optimum>> optimum_;
  std::unique_ptr<Consequences> consequences_;
};

Reasoner::Reasoner(Description description, ReasonerOptions options)
  : impl_(std::make_unique<Impl>(std::move(description), std::move(options)))
{
}
Reasoner::~Reasoner() = default;
Reasoner::Reasoner(Reasoner&&) noexcept = default;
Reasoner& Reasoner::operator=(Reasoner&&) noexcept = default;

const Description& Reasoner::description() const
{
  return impl_->description_;
}

const std::vector<Record>& Reasoner::history() const
{
  return impl_->history_;
}

int Reasoner::currentStep() const
{
  return impl_->currentStep();
}

void Reasoner::setHistory(std::vector<Record> records)
{
  std::vector<CheckedRecord> checked;
  for (const Record& record : records)
  {
    checked.push_back(checkRecord(record, impl_->description_));
  }
  impl_->take(std::move(checked));
}

void Reasoner::addRecords(const std::vector<Record>& records)
{
  std::vector<CheckedRecord> checked = impl_->records_;
  for (const Record& record : records)
  {
    checked.push_back(checkRecord(record, impl_->description_));
  }
  impl_->take(std::move(checked));
}

Diagnosis Reasoner::diagnose() const
{
  Diagnosis diagnosis;
  const std::optional<Optimum>& optimum = impl_->optimum();
  diagnosis.consistent = optimum.has_value();
  if (!optimum)
  {
    diagnosis.conflict = impl_->conflict();
    return diagnosis;
  }
  diagnosis.cost = optimum->price.assumptions + optimum->price.retractions;
  const Words words(impl_->description_, impl_->records_);
  for (const auto& explanation :
       explanationsOf(impl_->program_, impl_->records_, impl_->currentStep(), *optimum))
  {
    std::vector<std::string> statements;
    std::string in_words;
    for (const Clingo::Symbol& assumed : explanation)
    {
      statements.push_back(words.statement(assumed));
      in_words += (in_words.empty() ? "" : "; ") + words.sentence(assumed);
    }
    diagnosis.explanations.push_back(std::move(statements));
    diagnosis.in_words.push_back(std::move(in_words));
  }
  return diagnosis;
}

Answer Reasoner::entails(const std::string& literal, int step) const
{
  const Literal parsed = parseGroundLiteral(literal, impl_->description_);
  const Consequences& consequences = impl_->consequences(step);
  if (consequences.inAll(parsed, step))
  {
    return Answer::kTrue;
  }
  return consequences.inSome(parsed, step) ? Answer::kUnknown : Answer::kFalse;
}

bool Reasoner::possible(const std::string& literal, int step) const
{
  return impl_->consequences(step).inSome(parseGroundLiteral(literal, impl_->description_), step);
}

std::vector<HistoryModel> Reasoner::models(std::size_t limit) const
{
  const int last = impl_->currentStep();
  static_cast<void>(impl_->consequences(last));  // refuses an inconsistent history
  const std::vector<GroundFluent> fluents = groundFluents(impl_->description_);
  std::unordered_map<std::string, std::size_t> index;
  for (std::size_t i = 0; i < fluents.size(); ++i)
  {
    index.emplace(fluents[i].name, i);
  }
  const Words words(impl_->description_, impl_->records_);
  std::vector<HistoryModel> models;
  for (const SymbolicModel& symbolic :
       modelsOf(impl_->program_, impl_->records_, last, *impl_->optimum(), limit))
  {
    HistoryModel model;
    for (const Clingo::Symbol& assumed : symbolic.assumed)
    {
      model.assumed.push_back(words.statement(assumed));
    }
    std::vector<Literal> state;
    for (const GroundFluent& fluent : fluents)
    {
      state.push_back(toLiteral(fluent, "false"));  // what no definition makes true
    }
    model.states.assign(static_cast<std::size_t>(last) + 1, state);
    for (const Clingo::Symbol& holds : symbolic.holds)
    {
      const auto arguments = holds.arguments();
      model.states[static_cast<std::size_t>(arguments[2].number())][index.at(toText(arguments[0]))]
          .value.name = toText(arguments[1]);
    }
    models.push_back(std::move(model));
  }
  return models;
}

std::vector<Literal> Reasoner::entailedAt(int step) const
{
  const Consequences& consequences = impl_->consequences(step);
  std::vector<Literal> entailed;
  for (const GroundFluent& fluent : groundFluents(impl_->description_))
  {
    Literal literal = toLiteral(fluent, "");
    std::vector<Literal> excluded;
    bool settled = false;
    for (const std::string& value : fluent.values)
    {
      literal.value.name = value;
      if (consequences.inAll(literal, step))
      {
        entailed.push_back(literal);
        settled = true;
        break;
      }
      if (!consequences.inSome(literal, step))
      {
        excluded.push_back(literal);
        excluded.back().equal = false;
      }
    }
    if (!settled)
    {
      entailed.insert(entailed.end(), excluded.begin(), excluded.end());
    }
  }
  return entailed;
}

std::vector<std::string> Reasoner::possibleValues(const std::string& fluent, int step) const
{
  const Consequences& consequences = impl_->consequences(step);
  for (const GroundFluent& ground : groundFluents(impl_->description_))
  {
    Literal literal = toLiteral(ground, "");
    // spaces do not matter
    if (Encoding::term(literal.atom) != withoutSpaces(fluent))
    {
      continue;
    }
    std::vector<std::string> values;
    for (const std::string& value : ground.values)
    {
      literal.value.name = value;
      if (consequences.inSome(literal, step))
      {
        values.push_back(value);
      }
    }
    return values;
  }
  throw InvalidArgument("unknown fluent '" + fluent +
                        "', expected a ground fluent of the description");
}

Explanation Reasoner::explain(const std::string& literal, int step) const
{
  const Literal parsed = parseGroundLiteral(literal, impl_->description_);
  Explanation explanation;
  if (!impl_->consequences(step).inAll(parsed, step))
  {
    return explanation;
  }
  return explained(impl_->description_, impl_->options_, impl_->program_, impl_->records_,
                   *impl_->optimum(), parsed, step);
}

PlanResult Reasoner::plan(const std::string& goal, const PlanOptions& options,
                          const std::atomic<bool>* cancel) const
{
  const Formula formula = parseGoal(goal, impl_->description_);
  if (!impl_->optimum())
  {
    PlanResult result;
    result.reason = "the history is inconsistent: " + impl_->conflictText();
    return result;
  }
  const int step = impl_->currentStep();
  const Planner planner(impl_->description_, impl_->program_, impl_->records_, step,
                        *impl_->optimum(), impl_->consequences(step));
  return planner.plan(formula, options, cancel);
}

std::string Reasoner::translation() const
{
  return impl_->program_.text(impl_->records_);
}

}  // namespace kr3::reasoner
