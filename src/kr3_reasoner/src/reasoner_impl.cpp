#include "reasoner_impl.hpp"

#include <algorithm>
#include <utility>

#include <kr3_common/error.hpp>

#include "explain.hpp"
#include "explained_part.hpp"
#include "retraction.hpp"

namespace kr3::reasoner
{

Reasoner::Impl::Impl(std::shared_ptr<DomainKnowledge> knowledge, int least_step)
  : knowledge_(std::move(knowledge)), least_step_(least_step)
{
}

int Reasoner::Impl::currentStep() const
{
  int step = least_step_;
  for (const CheckedRecord& checked : records_)
  {
    step = std::max(step, checked.record.step + (checked.isAction() ? 1 : 0));
  }
  return step;
}

Words Reasoner::Impl::words() const
{
  return {description(), options(), instances(), records_};
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
  if (step < 0 || step > currentStep())
  {
    throw InvalidArgument("found step " + std::to_string(step) +
                          ", expected one from 0 to the current step " +
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
  constexpr int kAnyPrice = 1000000;
  const bool exogenous = !optimum() || optimum()->assumable.exogenous;
  return {description(), program(), records_, currentStep(), {{exogenous, false}, {0, kAnyPrice}}};
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
  if (isLarge())
  {
    ExplainedPart part(*knowledge_, records_, currentStep(), literal, program().limit());
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
  auto impl = std::make_unique<Impl>(knowledge_, currentStep());
  impl->setLimits(limits_);
  impl->take(std::move(kept));
  return Reasoner(std::move(impl));
}

std::vector<Retraction> Reasoner::Impl::retractions(
    const std::vector<Literal>& excluded, int step, std::size_t max_sets,
    const std::function<bool(const Reasoner&, Retraction&)>& accept)
{
  const bool exogenous = !optimum() || optimum()->assumable.exogenous;
  std::vector<Retraction> found;
  retractionSets(description(), program(), records_, currentStep(), excluded, step, exogenous,
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

}  // namespace kr3::reasoner
