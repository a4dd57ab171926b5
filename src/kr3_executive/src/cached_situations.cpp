// The part of CachedReasoner that looks answers up by the situation that a history has come to.

#include <algorithm>
#include <utility>

#include "kr3_executive/cached_reasoner.hpp"
#include "kr3_executive/interfaces.hpp"

namespace kr3::executive
{
namespace
{

using reasoner::Answer;
using reasoner::PlanResult;
using reasoner::Record;
using reasoner::RenamedSituation;
using reasoner::Renaming;
using reasoner::Situation;
using reasoner::Situations;

std::size_t sizeOf(const Situation& situation)
{
  return 4 * situation.text().size();  // the text, and the rows that it was written from
}

std::size_t sizeOf(const Situations::PossibleValues& values)
{
  std::size_t bytes = sizeof values;
  for (const auto& of_fluent : values)
    bytes += sizeof of_fluent + of_fluent.size() * sizeof(std::string);
  return bytes;
}

std::size_t sizeOf(const PlanResult& result)
{
  std::size_t bytes = sizeof result;
  for (const auto& plan : result.plans)
    bytes += sizeof plan + 100 * (plan.hypothesis.size() + plan.steps.size());
  return bytes;
}

}  // namespace

Fingerprint CachedReasoner::keyOf(const Situation& situation) const
{
  Fingerprinter fingerprinter;
  fingerprinter.add(empty_.high);
  fingerprinter.add(empty_.low);
  fingerprinter.addText(situation.text());
  return fingerprinter.result();
}

void CachedReasoner::rename(Present& present, const RenamedSituation& other) const
{
  present.situation = other.situation;
  present.renaming = present.renaming.then(other.renaming);
}

bool CachedReasoner::advance(Present& present, std::vector<Record> records)
{
  int now = present.step;
  for (const Record& record : records)
  {
    if (record.step < present.step)
      return false;  // it says something about what has been left behind
  }
  now = std::max(now, currentStep(records));
  for (;;)
  {
    std::vector<Record> here;
    for (const Record& record : records)
    {
      if (record.step != present.step)
        continue;
      here.push_back(record);
      here.back().statement = present.renaming.ofText(record.statement);
    }
    if (!here.empty())
      rename(present, situations_->canonical(present.situation.with(here)));
    if (present.step == now)
      return true;
    const Fingerprint key = keyOf(present.situation);
    auto next = cache_->situations.find(key);
    if (!next)
    {
      std::optional<RenamedSituation> renamed;
      if (const auto later = situations_->next(present.situation))
        renamed = situations_->canonical(*later);
      const std::size_t bytes = renamed ? sizeOf(renamed->situation) : sizeof renamed;
      next = cache_->situations.keep(key, std::move(renamed), bytes);
    }
    if (!*next)
      return false;
    rename(present, **next);
    ++present.step;
  }
}

void CachedReasoner::follow(const std::vector<Record>& records, bool anew)
{
  if (!anew && !present_ && told_.size() > 1)
    return;  // it was lost
  if (anew || told_.size() == 1)
    present_ = situations_->supported() && options_.relevant_only
                   ? std::optional<Present>(Present{})
                   : std::nullopt;
  if (!present_)
    return;
  present_->values.reset();
  if (!advance(*present_, records) || valuesAt(step_) == nullptr)
    present_.reset();
}

const Situations::PossibleValues* CachedReasoner::valuesAt(int step)
{
  if (!present_ || step != present_->step)
    return nullptr;
  if (present_->values)
    return &*present_->values;
  const Fingerprint key = keyOf(present_->situation);
  auto known = cache_->values.find(key);
  if (!known)
  {
    auto values = situations_->possibleValues(present_->situation);
    const std::size_t bytes = values ? sizeOf(*values) : sizeof values;
    known = cache_->values.keep(key, std::move(values), bytes);
  }
  if (!*known)
    return nullptr;
  present_->values = situations_->renamed(**known, present_->renaming.inverse());
  return &*present_->values;
}

std::optional<Answer> CachedReasoner::answerAt(const std::string& literal, int step)
{
  const auto* values = valuesAt(step);
  if (values == nullptr)
    return std::nullopt;
  return situations_->entails(*values, reasoner::parseGroundLiteral(literal, description_));
}

std::optional<PlanResult> CachedReasoner::situationPlan(const std::string& goal,
                                                        std::uint32_t max_plans,
                                                        const std::atomic<bool>& cancel)
{
  if (!present_)
    return std::nullopt;
  const RenamedSituation canonical =
      situations_->canonical(present_->situation, present_->renaming.ofText(goal));
  const Renaming to_plan = present_->renaming.then(canonical.renaming);
  const std::string goal_there = to_plan.ofText(goal);
  Fingerprinter fingerprinter;
  const Fingerprint situation = keyOf(canonical.situation);
  fingerprinter.add(situation.high);
  fingerprinter.add(situation.low);
  fingerprinter.addText(goal_there);
  fingerprinter.add(std::uint64_t{max_plans});
  const Fingerprint key = fingerprinter.result();
  auto known = cache_->situation_plans.find(key);
  if (!known)
  {
    reasoner::PlanOptions options = options_;
    options.all = max_plans > 1;
    options.max_plans = static_cast<int>(max_plans);
    PlanResult result = situations_->plan(canonical.situation, goal_there, options, &cancel);
    if (!result.complete)
      return std::nullopt;
    const std::size_t bytes = sizeOf(result);
    known = cache_->situation_plans.keep(key, std::move(result), bytes);
  }
  if (!known->goal_entailed && known->plans.empty())
    return std::nullopt;  // the reason is about the history
  return situations_->renamed(*known, to_plan.inverse());
}

}  // namespace kr3::executive
