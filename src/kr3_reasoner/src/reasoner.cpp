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
#include "relevant_planner.hpp"
#include "retraction.hpp"
#include "translation.hpp"
#include "words.hpp"

namespace kr3::reasoner
{

namespace
{

constexpr std::size_t kMaxRetractions = 8;

}  // namespace

class Reasoner::Impl
{
public:
  Impl(Description description, ReasonerOptions options)
    : description_(std::move(description))
    , options_(std::move(options))
    , program_(description_, options_)
    , instances_(description_)
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
    int step = options_.least_step;
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
    check_.reset();
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

  /// The same of a history that has to be consistent.
  const Optimum& requiredOptimum()
  {
    if (!optimum())
    {
      throw FailedPrecondition("the history is inconsistent: " + conflictText());
    }
    return *optimum();
  }

  void checkStep(int step) const
  {
    if (step < 0 || step > currentStep())
    {
      throw InvalidArgument("found step " + std::to_string(step) +
                            ", expected one from 0 to the current step " +
                            std::to_string(currentStep()));
    }
  }

  const Consequences& consequences(int step)
  {
    checkStep(step);
    if (!consequences_)
    {
      consequences_ = std::make_unique<Consequences>(description_, program_, records_,
                                                     currentStep(), requiredOptimum());
    }
    return *consequences_;
  }

  [[nodiscard]] std::string conflictText(const std::vector<std::size_t>& conflict) const
  {
    std::vector<std::string> texts;
    for (const std::size_t i : conflict)
    {
      texts.push_back(withPlace(records_[i].record));
    }
    return listed(texts);
  }

  [[nodiscard]] std::string conflictText() const
  {
    return conflictText(minimalConflict(program_, records_, currentStep()));
  }

  /// @throws InvalidArgument  there is no such fluent
  [[nodiscard]] GroundFluent groundFluent(const std::string& name) const
  {
    for (const GroundFluent& fluent : groundFluents(description_))
    {
      if (withoutSpaces(fluent.name) == withoutSpaces(name))
      {
        return fluent;
      }
    }
    throw InvalidArgument("unknown fluent '" + name +
                          "', expected a ground fluent of the description");
  }

  /// Says why; shares its solver with earlier questions about the same history.
  [[nodiscard]] Explanation explain(const Literal& literal, int step)
  {
    if (!check_)
    {
      check_ = std::make_unique<HistoryCheck>(description_, program_, records_, currentStep(),
                                              options_.diagnose_exogenous);
    }
    const Words here = words();
    if (instances_.isStatic(literal))
    {
      Explanation fact;
      fact.entailed = true;
      fact.proof.kind = ReasonKind::kStatic;
      fact.proof.statement = toString(literal);
      fact.proof.step = step;
      fact.proof.sentence = toString(literal) + " follows from the description alone";
      fact.reasons = {fact.proof.sentence};
      return fact;
    }
    return Explainer(description_, here, instances_, records_, currentStep(), check_.get())
        .explain(literal, step);
  }

  [[nodiscard]] Words words() const { return {description_, options_, instances_, records_}; }

  /// The history without some of its records.
  [[nodiscard]] Reasoner without(const std::vector<std::size_t>& given_up) const
  {
    std::vector<Record> kept;
    for (std::size_t i = 0; i < history_.size(); ++i)
    {
      if (std::find(given_up.begin(), given_up.end(), i) == given_up.end())
      {
        kept.push_back(history_[i]);
      }
    }
    ReasonerOptions options = options_;
    options.least_step = currentStep();
    Reasoner reasoner(description_, std::move(options));
    reasoner.setHistory(std::move(kept));
    return reasoner;
  }

  /// What no record excludes, whatever has to be assumed.
  [[nodiscard]] Consequences atAnyPrice()
  {
    constexpr int kAnyPrice = 1000000;
    const bool exogenous = !optimum() || optimum()->assumable.exogenous;
    return {description_, program_, records_, currentStep(), {{exogenous, false}, {0, kAnyPrice}}};
  }

  /// What has to be given up so that none of `excluded` holds at `step`.
  std::vector<Retraction> retractions(
      const std::vector<Literal>& excluded, int step, std::size_t max_sets,
      const std::function<bool(const Reasoner&, Retraction&)>& accept)
  {
    const bool exogenous = !optimum() || optimum()->assumable.exogenous;
    std::vector<Retraction> found;
    retractionSets(description_, program_, records_, currentStep(), excluded, step, exogenous,
                   max_sets,
                   [&](const std::vector<std::size_t>& set) {
      Retraction retraction;
      retraction.records = set;
      std::vector<std::string> texts;
      for (const std::size_t i : set)
      {
        constexpr double kScale = 100.0;
        retraction.log_odds += doubtOf(history_[i]) / kScale;
        texts.push_back(withPlace(history_[i]));
      }
      if (!accept(without(set), retraction))
      {
        return false;
      }
      retraction.in_words =
          (retraction.opens.empty() ? "the history is consistent"
                                    : retraction.opens + " is possible") +
          (set.empty() ? std::string(" as it is") : " without the record " + listed(texts));
      found.push_back(std::move(retraction));
      return true;
    });
    return found;
  }

  const GroundRules& groundRules()
  {
    if (!ground_rules_)
    {
      ground_rules_ = std::make_unique<GroundRules>(description_);
    }
    return *ground_rules_;
  }

  Description description_;
  ReasonerOptions options_;
  HistoryProgram program_;
  Instances instances_;
  std::vector<CheckedRecord> records_;
  std::vector<Record> history_;

private:
  std::unique_ptr<std::optional<Optimum>> optimum_;
  std::unique_ptr<Consequences> consequences_;
  std::unique_ptr<GroundRules> ground_rules_;
  std::unique_ptr<HistoryCheck> check_;
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
  constexpr std::size_t kMaxJustifiedAlternatives = 8;  // a proof each: people read no more
  Diagnosis diagnosis;
  const std::optional<Optimum>& optimum = impl_->optimum();
  diagnosis.consistent = optimum.has_value();
  if (!optimum)
  {
    diagnosis.conflict_records =
        minimalConflict(impl_->program_, impl_->records_, impl_->currentStep());
    for (const std::size_t i : diagnosis.conflict_records)
    {
      diagnosis.conflict.push_back(toString(impl_->history_[i]));
    }
    diagnosis.conflict_in_words =
        "these records cannot all be right: " + impl_->conflictText(diagnosis.conflict_records);
    return diagnosis;
  }
  diagnosis.cost = optimum->price.assumptions + optimum->price.retractions;
  const Words words = impl_->words();
  Explainer explainer(impl_->description_, words, impl_->instances_, impl_->records_,
                      impl_->currentStep(), nullptr);
  for (const auto& explanation :
       explanationsOf(impl_->program_, impl_->records_, impl_->currentStep(), *optimum))
  {
    ExplanationAlternative alternative;
    alternative.price = diagnosis.cost;
    std::vector<std::string> statements;
    for (const Clingo::Symbol& assumed : explanation)
    {
      alternative.assumptions.push_back(words.assumption(assumed));
      statements.push_back(alternative.assumptions.back().statement);
      alternative.in_words +=
          (alternative.in_words.empty() ? "" : "; ") + alternative.assumptions.back().sentence;
    }
    diagnosis.explanations.push_back(std::move(statements));
    diagnosis.in_words.push_back(alternative.in_words);
    if (diagnosis.alternatives.size() < kMaxJustifiedAlternatives)
    {
      explainer.justify(alternative, explanation);
    }
    diagnosis.alternatives.push_back(std::move(alternative));
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
  const Words words = impl_->words();
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
      state.push_back(literalOf(fluent, "false"));  // what no definition makes true
    }
    model.states.assign(static_cast<std::size_t>(last) + 1, state);
    for (const Clingo::Symbol& holds : symbolic.holds)
    {
      const auto arguments = holds.arguments();
      model.states[static_cast<std::size_t>(arguments[2].number())][index.at(toText(arguments[0]))]
          .value.name = toText(arguments[1]);
    }
    model.actions.resize(static_cast<std::size_t>(last));
    for (const Clingo::Symbol& occurs : symbolic.occurs)
    {
      const auto arguments = occurs.arguments();
      model.actions[static_cast<std::size_t>(arguments[1].number())].push_back(
          toText(arguments[0]));
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

Explanation Reasoner::explain(const std::string& literal, int step) const
{
  const Literal parsed = parseGroundLiteral(literal, impl_->description_);
  Explanation explanation;
  if (!impl_->consequences(step).inAll(parsed, step))
  {
    return explanation;
  }
  return impl_->explain(parsed, step);
}

OpenQuestion Reasoner::whyUnknown(const std::string& text, int step) const
{
  const Literal literal =
      normalized(parseGroundLiteral(text, impl_->description_), impl_->description_);
  const Consequences& consequences = impl_->consequences(step);
  const std::string fluent = toString(literal.atom);
  const std::string at = " at step " + std::to_string(step);
  OpenQuestion question;
  question.open = !consequences.inAll(literal, step) && consequences.inSome(literal, step);
  if (impl_->instances_.isStatic(literal))
  {
    return question;  // a static is never open
  }
  question.values = possibleValues(fluent, step);
  if (!question.open)
  {
    question.reasons.push_back(toString(literal) + at +
                               (consequences.inAll(literal, step) ? " is known" : " is excluded"));
    return question;
  }
  question.reasons.push_back(fluent + at + " may be " + listed(question.values));
  for (const GroundDefault& instance : impl_->words().defaultsAbout(literal.atom))
  {
    std::vector<std::string> unknown;
    for (const Literal& condition : instance.body)
    {
      if (!consequences.inAll(condition, 0))
      {
        unknown.push_back(toString(condition));
      }
    }
    question.reasons.push_back(
        "default " + instance.name + " would say initially " + toString(instance.head) + ", but " +
        (!unknown.empty() ? listed(unknown) + " initially is not known"
         : !consequences.inSome(instance.head, 0)
             ? "that is excluded"
             : "something else that is assumed or a default of equal rank contradicts it"));
  }
  const int now = currentStep();
  const std::vector<std::string> current = possibleValues(fluent, now);
  const bool decides = std::all_of(current.begin(), current.end(), [&](const std::string& value) {
    Record seen;
    seen.statement = toString(literalOf(impl_->groundFluent(fluent), value));
    seen.step = now;
    const Reasoner supposed = supposing({seen});
    return !supposed.impl_->optimum() || supposed.entails(text, step) != Answer::kUnknown;
  });
  if (decides && current.size() > 1)
  {
    question.deciding.push_back(fluent);
    question.reasons.push_back("observing " + fluent + " at step " + std::to_string(now) +
                               " would settle it");
  }
  return question;
}

Reasoner Reasoner::supposing(const std::vector<Record>& hypothetical) const
{
  std::vector<Record> records = impl_->history_;
  records.insert(records.end(), hypothetical.begin(), hypothetical.end());
  Reasoner reasoner(impl_->description_, impl_->options_);
  reasoner.setHistory(std::move(records));
  return reasoner;
}

std::vector<Retraction> Reasoner::retractions() const
{
  const std::optional<Optimum>& optimum = impl_->optimum();
  if (optimum && optimum->price.retractions == 0)
  {
    return {};
  }
  return impl_->retractions({}, 0, kMaxRetractions, [](const Reasoner& reduced, Retraction&) {
    const Diagnosis diagnosis = reduced.diagnose();
    return diagnosis.consistent &&
           std::all_of(diagnosis.alternatives.begin(), diagnosis.alternatives.end(),
                       [](const ExplanationAlternative& alternative) {
      return std::none_of(alternative.assumptions.begin(), alternative.assumptions.end(),
                          [](const Assumption& assumption) {
        return assumption.kind == AssumptionKind::kWrongRecord;
      });
           });
  });
}

std::vector<Retraction> Reasoner::retractionsFor(const std::string& literal, int step) const
{
  const Literal wanted =
      normalized(parseGroundLiteral(literal, impl_->description_), impl_->description_);
  impl_->checkStep(step);
  if ((impl_->optimum() && possible(literal, step)) || impl_->atAnyPrice().inSome(wanted, step))
  {
    return {};
  }
  return impl_->retractions({contrary(wanted, impl_->description_)}, step, kMaxRetractions,
                            [&](const Reasoner& reduced, Retraction& retraction) {
    retraction.opens = toString(wanted);
    return reduced.impl_->optimum() && reduced.possible(literal, step);
  });
}

Retraction Reasoner::leastCertainRefutation(const std::string& fluent) const
{
  const int now = impl_->currentStep();
  const GroundFluent ground = impl_->groundFluent(fluent);
  const Consequences any = impl_->atAnyPrice();
  std::vector<Literal> possible_now;
  for (const std::string& value : ground.values)
  {
    const Literal literal = literalOf(ground, value);
    if (any.inSome(literal, now))
    {
      possible_now.push_back(literal);
    }
  }
  const auto found = impl_->retractions(possible_now, now, 1,
                                        [&](const Reasoner& reduced, Retraction& retraction) {
    if (!reduced.impl_->optimum())
    {
      return false;
    }
    for (const std::string& value : reduced.possibleValues(fluent, now))
    {
      const Literal literal = literalOf(ground, value);
      if (!any.inSome(literal, now))
      {
        retraction.opens = toString(literal);
        return true;
      }
    }
    return false;
  });
  return found.empty() ? Retraction{} : found.front();
}

PlanResult Reasoner::plan(const std::string& goal, const PlanOptions& options,
                          const std::atomic<bool>* cancel) const
{
  const Formula formula = parseGoal(goal, impl_->description_);
  checkPlanOptions(options);
  const int step = impl_->currentStep();
  // What raw answer set programming code depends on, nothing says: then all is relevant.
  if (options.relevant_only && impl_->description_.asp_blocks.empty())
  {
    return RelevantPlanner(impl_->groundRules(), impl_->records_, step, impl_->options_)
        .plan(formula, options, cancel);
  }
  if (!impl_->optimum())
  {
    PlanResult result;
    result.reason = "the history is inconsistent: " + impl_->conflictText();
    return result;
  }
  const Planner planner(impl_->description_, impl_->program_, impl_->records_, step,
                        *impl_->optimum(), impl_->consequences(step));
  PlanResult result = planner.plan(formula, options, cancel);
  result.considered = sizeOf(impl_->description_, impl_->records_.size());
  result.whole = result.considered;
  return result;
}

RelevantPart Reasoner::relevant(const std::string& goal) const
{
  const Formula formula = parseGoal(goal, impl_->description_);
  return Slicer(impl_->groundRules(), impl_->records_, impl_->currentStep())
      .report(formula, kFirstHorizon);
}

std::string Reasoner::translation() const
{
  return translationOf(impl_->description_, impl_->program_, impl_->records_, impl_->currentStep(),
                       impl_->requiredOptimum(), nullptr);
}

std::string Reasoner::translation(const std::string& goal, int length) const
{
  if (length < 0)
  {
    throw InvalidArgument("found a plan of " + std::to_string(length) +
                          " steps to translate, expected at least 0");
  }
  const TranslatedGoal translated{parseGoal(goal, impl_->description_), length};
  return translationOf(impl_->description_, impl_->program_, impl_->records_, impl_->currentStep(),
                       impl_->requiredOptimum(), &translated);
}

}  // namespace kr3::reasoner
