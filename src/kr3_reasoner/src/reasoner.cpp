#include "kr3_reasoner/reasoner.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>

#include <kr3_common/error.hpp>

#include "planner.hpp"
#include "reasoner_impl.hpp"
#include "relevant_planner.hpp"
#include "translation.hpp"

namespace kr3::reasoner
{

Reasoner::Reasoner(Description description, ReasonerOptions options)
  : impl_(std::make_unique<Impl>(std::make_shared<DomainKnowledge>(std::move(description), options),
                                 options.least_step))
{
}
Reasoner::Reasoner(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Reasoner::~Reasoner() = default;
Reasoner::Reasoner(Reasoner&&) noexcept = default;
Reasoner& Reasoner::operator=(Reasoner&&) noexcept = default;

const Description& Reasoner::description() const
{
  return impl_->description();
}

const std::vector<Record>& Reasoner::history() const
{
  return impl_->history();
}

int Reasoner::currentStep() const
{
  return impl_->currentStep();
}

int Reasoner::firstStep() const
{
  return impl_->program().firstStep();
}

void Reasoner::setHistory(std::vector<Record> records)
{
  std::vector<CheckedRecord> checked;
  for (const Record& record : records)
  {
    checked.push_back(impl_->checked(record, 0));
  }
  impl_->begin(nullptr, std::move(checked));
  impl_->keepWindow();
}

void Reasoner::addRecords(const std::vector<Record>& records)
{
  impl_->add(records);
  impl_->keepWindow();
}

void Reasoner::follow(const Reasoner& other)
{
  const ReasonerOptions& own = impl_->options();
  const ReasonerOptions& others = other.impl_->options();
  const bool same_prices = own.exception_weight == others.exception_weight &&
                           own.exogenous_weight == others.exogenous_weight &&
                           own.default_weights == others.default_weights;
  if (other.firstStep() > 0 && !same_prices)
  {
    throw FailedPrecondition("the history was progressed to step " +
                             std::to_string(other.firstStep()) +
                             " with other prices of exceptions and exogenous actions");
  }
  impl_->begin(other.impl_->beginning(), other.impl_->records());
}

Progress Reasoner::progress(int step)
{
  if (step < firstStep() || step > currentStep())
  {
    throw InvalidArgument("found step " + std::to_string(step) +
                          " to progress to, expected one from " + std::to_string(firstStep()) +
                          " to the current step " + std::to_string(currentStep()));
  }
  const auto question = impl_->ask("progression");
  static_cast<void>(impl_->requiredOptimum());
  return impl_->progress(step, 0);
}

void Reasoner::setLimits(const Limits& limits)
{
  if (limits.time_limit.count() < 0)
  {
    throw InvalidArgument("found a time limit of " + std::to_string(limits.time_limit.count()) +
                          " ms, expected at least 0");
  }
  impl_->setLimits(limits);
}

Answer Reasoner::entails(const std::string& literal, int step) const
{
  const auto question = impl_->ask("entailment");
  const Literal parsed = parseGroundLiteral(literal, impl_->description());
  const Consequences& consequences = impl_->consequences(step);
  if (consequences.inAll(parsed, step))
  {
    return Answer::kTrue;
  }
  return consequences.inSome(parsed, step) ? Answer::kUnknown : Answer::kFalse;
}

bool Reasoner::possible(const std::string& literal, int step) const
{
  const auto question = impl_->ask("entailment");
  return impl_->consequences(step).inSome(parseGroundLiteral(literal, impl_->description()), step);
}

std::vector<HistoryModel> Reasoner::models(std::size_t limit) const
{
  const auto question = impl_->ask("the enumeration of models");
  const int first = impl_->program().firstStep();
  const int last = impl_->currentStep();
  static_cast<void>(impl_->consequences(last));  // refuses an inconsistent history
  const std::vector<GroundFluent> fluents = groundFluents(impl_->description());
  std::unordered_map<std::string, std::size_t> index;
  for (std::size_t i = 0; i < fluents.size(); ++i)
  {
    index.emplace(fluents[i].name, i);
  }
  const Words words = impl_->words();
  std::vector<HistoryModel> models;
  for (const SymbolicModel& symbolic :
       modelsOf(impl_->program(), impl_->records(), last, *impl_->optimum(), limit))
  {
    HistoryModel model;
    for (const Clingo::Symbol& assumed : symbolic.assumed)
    {
      model.assumed.push_back(words.statement(assumed));
    }
    std::vector<Literal> state;
    for (const GroundFluent& fluent : fluents)
    {
      state.push_back(literalOf(fluent, "false"));  // what no definition makes true
    }
    model.first_step = first;
    model.states.assign(static_cast<std::size_t>(last - first) + 1, state);
    for (const Clingo::Symbol& holds : symbolic.holds)
    {
      const auto arguments = holds.arguments();
      model
          .states[static_cast<std::size_t>(arguments[2].number() - first)]
                 [index.at(toText(arguments[0]))]
          .value.name = toText(arguments[1]);
    }
    model.actions.resize(static_cast<std::size_t>(last - first));
    for (const Clingo::Symbol& occurs : symbolic.occurs)
    {
      const auto arguments = occurs.arguments();
      model.actions[static_cast<std::size_t>(arguments[1].number() - first)].push_back(
          toText(arguments[0]));
    }
    models.push_back(std::move(model));
  }
  return models;
}

std::vector<Literal> Reasoner::entailedAt(int step) const
{
  const auto question = impl_->ask("entailment");
  const Consequences& consequences = impl_->consequences(step);
  std::vector<Literal> entailed;
  for (const GroundFluent& fluent : groundFluents(impl_->description()))
  {
    Literal literal = literalOf(fluent, "");
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
  const auto question = impl_->ask("entailment");
  const Consequences& consequences = impl_->consequences(step);
  const GroundFluent ground = impl_->groundFluent(fluent);
  std::vector<std::string> values;
  for (const std::string& value : ground.values)
  {
    if (consequences.inSome(literalOf(ground, value), step))
    {
      values.push_back(value);
    }
  }
  return values;
}

PlanResult Reasoner::plan(const std::string& goal, const PlanOptions& asked,
                          const std::atomic<bool>* given_cancel) const
{
  const Formula formula = parseGoal(goal, impl_->description());
  checkPlanOptions(asked);
  PlanOptions options = asked;
  Limits limits = impl_->limits();
  if (limits.time_limit.count() > 0)
  {
    options.time_limit = std::min(options.time_limit, limits.time_limit);
  }
  const std::atomic<bool>* const cancel = given_cancel != nullptr ? given_cancel : limits.cancel;
  limits = {options.time_limit, cancel};
  const DomainKnowledge::Question question(*impl_->knowledge(), limits, "planning");
  const int step = impl_->currentStep();
  // What raw answer set programming code depends on, nothing says: then all is relevant.
  if (options.relevant_only && impl_->description().asp_blocks.empty())
  {
    return RelevantPlanner(*impl_->knowledge(), impl_->records(), step, formula, impl_->beginning())
        .plan(options, cancel);
  }
  if (!impl_->optimum())
  {
    PlanResult result;
    result.reason = "the history is inconsistent: " + impl_->conflictText();
    return result;
  }
  const Planner planner(*impl_->knowledge(), impl_->program(), impl_->records(), step,
                        *impl_->optimum(), impl_->consequences(step));
  PlanResult result = planner.plan(formula, options, cancel);
  result.whole = impl_->knowledge()->size(impl_->records().size());
  result.considered = result.whole;
  return result;
}

RelevantPart Reasoner::relevant(const std::string& goal) const
{
  const Formula formula = parseGoal(goal, impl_->description());
  return Slicer(*impl_->knowledge(), impl_->records(), impl_->currentStep(), formula,
                impl_->beginning())
      .report(kFirstHorizon);
}

std::string Reasoner::translation() const
{
  const auto question = impl_->ask("the translation");
  return translationOf(impl_->description(), impl_->program(), impl_->records(),
                       impl_->currentStep(), impl_->requiredOptimum(), nullptr);
}

std::string Reasoner::translation(const std::string& goal, int length) const
{
  const auto question = impl_->ask("the translation");
  if (length < 0)
  {
    throw InvalidArgument("found a plan of " + std::to_string(length) +
                          " steps to translate, expected at least 0");
  }
  const TranslatedGoal translated{parseGoal(goal, impl_->description()), length};
  return translationOf(impl_->description(), impl_->program(), impl_->records(),
                       impl_->currentStep(), impl_->requiredOptimum(), &translated);
}

}  // namespace kr3::reasoner
