#include "reasoner_impl.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

#include <kr3_common/error.hpp>

#include "explain.hpp"
#include "explained_part.hpp"
#include "retraction.hpp"

namespace kr3::reasoner
{

namespace
{

/// Which records call for what is assumed, by part: what does not hang together is justified each
/// for itself, once for all explanations that have it.
class Justifications
{
public:
  using Symbols = std::vector<Clingo::Symbol>;

  explicit Justifications(const PriceByPart& parts) : parts_(parts) {}

  /// Fills in what is known. @return by assumption, whether it was
  std::vector<bool> fill(ExplanationAlternative& alternative, const Symbols& assumed) const
  {
    std::vector<bool> filled(assumed.size(), false);
    for (const std::vector<std::size_t>& members : partsOf(assumed))
    {
      const auto found = known_.find(chosen(assumed, members));
      for (std::size_t i = 0; found != known_.end() && i < members.size(); ++i)
      {
        alternative.assumptions[members[i]] = found->second[i];
        filled[members[i]] = true;
      }
    }
    return filled;
  }

  void keep(const ExplanationAlternative& alternative, const Symbols& assumed)
  {
    for (const std::vector<std::size_t>& members : partsOf(assumed))
    {
      std::vector<Assumption>& kept = known_[chosen(assumed, members)];
      kept.clear();
      for (const std::size_t i : members)
      {
        kept.push_back(alternative.assumptions[i]);
      }
    }
  }

private:
  [[nodiscard]] std::vector<std::vector<std::size_t>> partsOf(const Symbols& assumed) const
  {
    std::vector<std::vector<std::size_t>> members(parts_.parts.size());
    for (std::size_t i = 0; i < assumed.size(); ++i)
    {
      members[parts_.partOf(assumed[i])].push_back(i);
    }
    return members;
  }

  static Symbols chosen(const Symbols& assumed, const std::vector<std::size_t>& members)
  {
    Symbols symbols;
    for (const std::size_t i : members)
    {
      symbols.push_back(assumed[i]);
    }
    return symbols;
  }

  const PriceByPart& parts_;
  std::map<Symbols, std::vector<Assumption>> known_;
};

}  // namespace

Reasoner::Impl::Impl(std::shared_ptr<DomainKnowledge> knowledge, int least_step,
                     std::shared_ptr<const Beginning> beginning)
  : knowledge_(std::move(knowledge))
  , least_step_(least_step)
  , beginning_(std::move(beginning))
  , program_(std::make_unique<HistoryProgram>(knowledge_->program().beginningAt(beginning_)))
{
}

int Reasoner::Impl::currentStep() const
{
  int step = std::max(least_step_, program().firstStep());
  for (const CheckedRecord& checked : records_)
  {
    step = std::max(step, checked.record.step + (checked.isAction() ? 1 : 0));
  }
  return step;
}

Words Reasoner::Impl::words() const
{
  return {description(), options(), instances(), records_, beginning_.get()};
}

CheckedRecord Reasoner::Impl::checked(const Record& record, int first_step) const
{
  CheckedRecord checked = checkRecord(record, symbols());
  if (record.step < first_step)
  {
    throw InvalidArgument("the record " + toString(record) + ": found step " +
                          std::to_string(record.step) + ", but the history begins at step " +
                          std::to_string(first_step) + ", to which it was progressed");
  }
  return checked;
}

void Reasoner::Impl::take(std::vector<CheckedRecord> records)
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

void Reasoner::Impl::begin(std::shared_ptr<const Beginning> beginning,
                           std::vector<CheckedRecord> records)
{
  tried_ = 0;
  take(std::move(records));
  beginning_ = std::move(beginning);
  program_ = std::make_unique<HistoryProgram>(knowledge_->program().beginningAt(beginning_));
}

void Reasoner::Impl::add(const std::vector<Record>& records)
{
  std::vector<CheckedRecord> all = records_;
  for (const Record& record : records)
  {
    all.push_back(checked(record, program().firstStep()));
  }
  take(std::move(all));
}

// ---- Progression ----

Progress Reasoner::Impl::progress(int step, int earliest)
{
  Progress result;
  for (int first = step; first > program().firstStep() && first >= earliest; --first)
  {
    Progression::Result progressed =
        knowledge_->progression().progressed(program(), records_, first);
    if (progressed.beginning)
    {
      std::vector<CheckedRecord> kept;
      std::copy_if(records_.begin(), records_.end(), std::back_inserter(kept),
                   [&](const CheckedRecord& checked) { return checked.record.step >= first; });
      begin(std::move(progressed.beginning), std::move(kept));
      break;
    }
    if (result.kept_because.empty())
    {
      result.kept_because = std::move(progressed.obstacles);
    }
  }
  result.first_step = program().firstStep();
  result.num_records = records_.size();
  return result;
}

/// In batches, so that each is paid for by the steps since the last.
void Reasoner::Impl::keepWindow()
{
  const int window = options().window;
  const int batch = std::max(1, window / 2);
  const int now = currentStep();
  for (int from = std::max(program().firstStep(), tried_);
       window > 0 && now >= from + window + batch && optimum(); from = tried_)
  {
    const int target = std::min(now - window, from + window + batch);  // a part at a time
    progress(target, target);
    tried_ = target;
  }
}

// ---- What follows from the history ----

const std::optional<Optimum>& Reasoner::Impl::optimum()
{
  if (!optimum_)
  {
    optimum_ = std::make_unique<std::optional<Optimum>>(
        findOptimum(program(), records_, currentStep(), options().diagnose_exogenous));
  }
  return *optimum_;
}

const Optimum& Reasoner::Impl::requiredOptimum()
{
  if (!optimum())
  {
    throw FailedPrecondition("the history is inconsistent: " + conflictText());
  }
  return *optimum();
}

void Reasoner::Impl::checkStep(int step) const
{
  if (step < program().firstStep() || step > currentStep())
  {
    throw InvalidArgument("found step " + std::to_string(step) + ", expected one from " +
                          std::to_string(program().firstStep()) + " to the current step " +
                          std::to_string(currentStep()));
  }
}

const Consequences& Reasoner::Impl::consequences(int step)
{
  checkStep(step);
  if (!consequences_)
  {
    consequences_ = std::make_unique<Consequences>(description(), program(), records_,
                                                   currentStep(), requiredOptimum());
  }
  return *consequences_;
}

Consequences Reasoner::Impl::atAnyPrice()
{
  const bool exogenous = !optimum() || optimum()->assumable.exogenous;
  return {description(), program(), records_, currentStep(), anyPrice(exogenous)};
}

std::string Reasoner::Impl::conflictText(const std::vector<std::size_t>& conflict) const
{
  std::vector<std::string> texts;
  for (const std::size_t i : conflict)
  {
    texts.push_back(withPlace(records_[i].record));
  }
  return listed(texts);
}

std::string Reasoner::Impl::conflictText() const
{
  return conflictText(minimalConflict(program(), records_, currentStep()));
}

GroundFluent Reasoner::Impl::groundFluent(const std::string& name) const
{
  for (const GroundFluent& fluent : groundFluents(description()))
  {
    if (withoutSpaces(fluent.name) == withoutSpaces(name))
    {
      return fluent;
    }
  }
  throw InvalidArgument("unknown fluent '" + name +
                        "', expected a ground fluent of the description");
}

// ---- Why, and what to give up ----

/// Whether it takes long to ground the whole history for explanations. What raw answer set
/// programming code depends on, nothing says: then there is no smaller part.
bool Reasoner::Impl::isLarge() const
{
  constexpr std::size_t kMany = 1000;  // then a part is soon quicker than the whole once for all
  const std::size_t num_fluents = knowledge_->size(0).fluents;
  return description().asp_blocks.empty() &&
         num_fluents * (static_cast<std::size_t>(currentStep()) + 1) > kMany;
}

Explanation Reasoner::Impl::explain(const Literal& literal, int step)
{
  if (instances().isStatic(literal))
  {
    Explanation fact;
    fact.entailed = true;
    fact.proof.kind = ReasonKind::kStatic;
    fact.proof.statement = toString(literal, description());
    fact.proof.step = step;
    fact.proof.sentence = fact.proof.statement + " follows from the description alone";
    fact.reasons = {fact.proof.sentence};
    return fact;
  }
  if (isLarge() && program().firstStep() == 0)
  {
    ExplainedPart part(*knowledge_, records_, currentStep(), {literal}, program().limit());
    if (auto explanation = part.explain(literal, step, Laws(description())))
    {
      return std::move(*explanation);
    }
  }
  if (!check_)
  {
    check_ = std::make_unique<HistoryCheck>(description(), program(), records_, currentStep());
  }
  const Words here = words();
  try
  {
    check_->limitTo(program().limit());
    Explanation explanation = Explainer(description(), here, instances(), records_, currentStep(),
                                        program().limit(), check_.get())
                                  .explain(literal, step);
    check_->limitTo({});
    return explanation;
  }
  catch (...)
  {
    check_.reset();  // it was interrupted
    throw;
  }
}

void Reasoner::Impl::justify(std::vector<ExplanationAlternative>& alternatives,
                             const std::vector<std::vector<Clingo::Symbol>>& assumed,
                             std::size_t count)
{
  const Words here = words();
  std::vector<Literal> about;
  bool in_part = description().asp_blocks.empty();
  for (std::size_t i = 0; i < count; ++i)
  {
    for (const Clingo::Symbol& assumption : assumed[i])
    {
      const std::optional<Literal> subject = here.subject(assumption);
      // A wrong record is known by its number in the whole history.
      in_part = in_part && subject && here.wrongRecord(assumption) == kNoRecord;
      if (subject)
      {
        about.push_back(*subject);
      }
    }
  }
  std::optional<ExplainedPart> part;
  std::optional<Explainer> whole;
  if (in_part && !about.empty())
  {
    part.emplace(*knowledge_, records_, currentStep(), about, program().limit());
  }
  else
  {
    whole.emplace(description(), here, instances(), records_, currentStep(), program().limit(),
                  nullptr);
  }
  Justifications justified(requiredOptimum().price);
  for (std::size_t i = 0; i < count; ++i)
  {
    const std::vector<bool> known = justified.fill(alternatives[i], assumed[i]);
    part ? part->justify(alternatives[i], assumed[i], known)
         : whole->justify(alternatives[i], assumed[i], known);
    justified.keep(alternatives[i], assumed[i]);
  }
}

Reasoner Reasoner::Impl::without(const std::vector<std::size_t>& given_up) const
{
  std::vector<CheckedRecord> kept;
  for (std::size_t i = 0; i < records_.size(); ++i)
  {
    if (std::find(given_up.begin(), given_up.end(), i) == given_up.end())
    {
      kept.push_back(records_[i]);
    }
  }
  auto impl = std::make_unique<Impl>(knowledge_, currentStep(), beginning_);
  impl->setLimits(limits_);
  impl->take(std::move(kept));
  return Reasoner(std::move(impl));
}

std::optional<std::vector<Retraction>> Reasoner::Impl::givingUpContrary(const Literal& wanted,
                                                                        int step)
{
  std::vector<std::size_t> contrary;
  for (std::size_t i = 0; i < records_.size(); ++i)
  {
    const CheckedRecord& checked = records_[i];
    if (checked.isAction() || checked.record.step != step || !contradicts(checked.literal, wanted))
    {
      continue;
    }
    if (checked.record.confidence >= 1.0)
    {
      return std::vector<Retraction>{};
    }
    contrary.push_back(i);
  }
  if (contrary.empty())
  {
    return std::nullopt;
  }
  const Reasoner reduced = without(contrary);
  if (!reduced.impl_->optimum() || !reduced.impl_->consequences(step).inSome(wanted, step))
  {
    return std::nullopt;
  }
  return std::vector<Retraction>{retractionOf(history_, contrary, toString(wanted, description()))};
}

std::vector<Retraction> Reasoner::Impl::retractions(
    const std::vector<Literal>& excluded, int step, std::size_t max_sets,
    const std::function<bool(const Reasoner&, std::string&)>& accept)
{
  const bool exogenous = !optimum() || optimum()->assumable.exogenous;
  std::vector<Retraction> found;
  retractionSets(description(), program(), records_, currentStep(), excluded, step, exogenous,
                 max_sets, [&](const std::vector<std::size_t>& set) {
                   std::string opens;
                   if (!accept(without(set), opens))
                   {
                     return false;
                   }
                   found.push_back(retractionOf(history_, set, std::move(opens)));
                   return true;
                 });
  return found;
}

}  // namespace kr3::reasoner
