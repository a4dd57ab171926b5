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
using reasoner::Situations;

std::size_t sizeOf(const KnownSituation& known)
{
  // The text, and the rows that it was written from.
  return sizeof known + 4 * known.renamed.situation.text().size();
}

/// A key for what is made of a situation.
Fingerprinter begun(const Fingerprint& situation, const char* what)
{
  Fingerprinter fingerprinter;
  fingerprinter.add(situation.high);
  fingerprinter.add(situation.low);
  fingerprinter.addText(what);
  return fingerprinter;
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

KnownSituation CachedReasoner::known(RenamedSituation renamed) const
{
  Fingerprinter fingerprinter;
  fingerprinter.add(empty_.high);
  fingerprinter.add(empty_.low);
  fingerprinter.addText(renamed.situation.text());
  return {std::move(renamed), fingerprinter.result()};
}

void CachedReasoner::become(Present& present, std::shared_ptr<const KnownSituation> other)
{
  present.renaming = present.renaming.then(other->renamed.renaming);
  present.situation = std::move(other);
  present.values_there.reset();
  present.values.reset();
}

std::shared_ptr<const KnownSituation> CachedReasoner::withRecords(
    const KnownSituation& situation, const std::vector<Record>& records)
{
  Fingerprinter fingerprinter = begun(situation.key, "records");
  for (const Record& record : records)
  {
    fingerprinter.add(static_cast<std::uint64_t>(record.kind));
    fingerprinter.addText(record.statement);
    fingerprinter.add(static_cast<std::uint64_t>(record.value ? 1 : 0));
  }
  const Fingerprint key = fingerprinter.result();
  if (auto found = cache_->named.find(key))
    return found;
  KnownSituation more = known(situations_->canonical(situation.renamed.situation.with(records)));
  const std::size_t bytes = sizeOf(more);
  return cache_->named.keep(key, std::move(more), bytes);
}

std::shared_ptr<const KnownSituation> CachedReasoner::forGoal(const KnownSituation& situation,
                                                              const std::string& goal)
{
  Fingerprinter fingerprinter = begun(situation.key, "goal");
  fingerprinter.addText(goal);
  const Fingerprint key = fingerprinter.result();
  if (auto found = cache_->named.find(key))
    return found;
  KnownSituation named = known(situations_->canonical(situation.renamed.situation, goal));
  const std::size_t bytes = sizeOf(named);
  return cache_->named.keep(key, std::move(named), bytes);
}

bool CachedReasoner::advance(Present& present, const std::vector<Record>& records)
{
  for (const Record& record : records)
  {
    if (record.step < present.step)
      return false;  // it says something about what has been left behind
  }
  const int now = std::max(present.step, currentStep(records));
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
      become(present, withRecords(*present.situation, here));
    if (present.step == now)
      return true;
    const Fingerprint key = present.situation->key;
    auto next = cache_->situations.find(key);
    if (!next)
    {
      std::optional<KnownSituation> found;
      if (const auto later = situations_->next(present.situation->renamed.situation))
      {
        found = known(situations_->canonical(later->situation));
        found->exceptions_only = later->exceptions_only;
      }
      const std::size_t bytes = found ? sizeOf(*found) : sizeof found;
      next = cache_->situations.keep(key, std::move(found), bytes);
    }
    if (!*next)
      return false;
    become(present, {next, &**next});
    present.exceptions_only = present.exceptions_only && (*next)->exceptions_only;
    ++present.step;
  }
}

void CachedReasoner::follow(const std::vector<Record>& records, bool anew)
{
  if (!anew && !present_ && told_.size() > 1)
    return;  // it was lost
  if (anew || told_.size() == 1)
  {
    present_.reset();
    if (situations_->supported() && options_.relevant_only)
      present_ = Present{std::make_shared<const KnownSituation>(known({})), {}};
  }
  if (!present_)
    return;
  present_->values_there.reset();
  present_->values.reset();
  if (!advance(*present_, records) || valuesThere() == nullptr)
    present_.reset();
}

CachedReasoner::KnownValues CachedReasoner::valuesOf(const KnownSituation& situation, Price price)
{
  const bool least = price == Price::kLeast;
  auto& cache = least ? cache_->values : cache_->values_at_any_price;
  if (auto known = cache.find(situation.key))
    return known;
  const auto& now = situation.renamed.situation;
  auto values = least ? situations_->possibleValues(now) : situations_->valuesAtAnyPrice(now);
  const std::size_t bytes = values ? sizeOf(*values) : sizeof values;
  return cache.keep(situation.key, std::move(values), bytes);
}

const Situations::PossibleValues* CachedReasoner::valuesThere()
{
  if (!present_)
    return nullptr;
  if (present_->values_there)
    return present_->values_there.get();
  const auto known = valuesOf(*present_->situation, Price::kLeast);
  if (!*known)
    return nullptr;
  present_->values_there = {known, &**known};
  return present_->values_there.get();
}

const Situations::PossibleValues* CachedReasoner::valuesAt(int step)
{
  if (!present_ || step != present_->step)
    return nullptr;
  if (present_->values)
    return &*present_->values;
  const auto* values = valuesThere();
  if (values == nullptr)
    return nullptr;
  present_->values = situations_->renamed(*values, present_->renaming.inverse());
  return &*present_->values;
}

std::optional<Answer> CachedReasoner::answerAt(const std::string& literal, int step)
{
  const auto* values = valuesAt(step);
  if (values == nullptr)
    return std::nullopt;
  return situations_->entails(*values, literals_.of(literal));
}

bool CachedReasoner::assumesExceptionsOnly()
{
  if (!present_ || !present_->exceptions_only)
    return false;
  const KnownSituation& situation = *present_->situation;
  if (const auto known = cache_->exceptions.find(situation.key))
    return *known;
  const bool explain = situations_->exceptionsExplain(situation.renamed.situation);
  return *cache_->exceptions.keep(situation.key, explain, sizeof explain);
}

bool CachedReasoner::restsOnDefault(const std::string& literal, int step)
{
  // Where exceptions are all that may be assumed, what is not so with any number of them is so for
  // the sake of a default. Else records alone may suffice.
  if (valuesAt(step) != nullptr && assumesExceptionsOnly())
  {
    const auto& at_any_price = *valuesOf(*present_->situation, Price::kAny);
    const auto there = literals_.of(present_->renaming.ofText(literal));
    const auto answer = at_any_price ? situations_->entails(*at_any_price, there) : std::nullopt;
    if (answer && *answer != Answer::kTrue)
      return true;
  }
  return HighLevelReasoner::restsOnDefault(literal, step);
}

std::shared_ptr<const KnownSituation> CachedReasoner::withoutContrary(
    const KnownSituation& situation, const reasoner::Literal& there)
{
  Fingerprinter fingerprinter = begun(situation.key, "without");
  fingerprinter.addText(reasoner::toString(there));
  const Fingerprint key = fingerprinter.result();
  if (auto found = cache_->named.find(key))
    return found;
  // Under the same names: what becomes possible is asked by them.
  KnownSituation less =
      known({situations_->without(situation.renamed.situation, there), Renaming()});
  const std::size_t bytes = sizeOf(less);
  return cache_->named.keep(key, std::move(less), bytes);
}

std::optional<std::vector<reasoner::Retraction>> CachedReasoner::situationRetractions(
    const std::string& literal)
{
  const auto wanted = literals_.of(literal);
  const auto there = literals_.of(present_->renaming.ofText(literal));
  const auto isPossible = [&](const KnownValues& values) {
    const auto answer = *values ? situations_->entails(**values, there) : std::nullopt;
    return answer && *answer != Answer::kFalse;
  };
  const KnownSituation& situation = *present_->situation;
  if (isPossible(valuesOf(situation, Price::kAny)))
    return std::vector<reasoner::Retraction>{};  // it is only less plausible
  const std::vector<Record> all = records();
  std::vector<std::size_t> contrary;
  std::vector<Record> here;
  std::vector<std::size_t> places;  // in the history
  for (std::size_t i = 0; i < all.size(); ++i)
  {
    if (all[i].step != present_->step)
      continue;
    here.push_back(all[i]);
    places.push_back(i);
  }
  for (const std::size_t index : situations_->contraryTo(here, wanted))
    contrary.push_back(places[index]);
  if (contrary.empty())
    return std::nullopt;
  if (std::any_of(contrary.begin(), contrary.end(),
                  [&](std::size_t index) { return all[index].confidence >= 1.0; }))
    return std::vector<reasoner::Retraction>{};
  if (!isPossible(valuesOf(*withoutContrary(situation, there), Price::kLeast)))
    return std::nullopt;
  return std::vector<reasoner::Retraction>{
      situations_->retraction(all, std::move(contrary), wanted)};
}

std::optional<PlanResult> CachedReasoner::situationPlan(const std::string& goal,
                                                        std::uint32_t max_plans,
                                                        const std::atomic<bool>& cancel)
{
  if (!present_)
    return std::nullopt;
  const auto canonical = forGoal(*present_->situation, present_->renaming.ofText(goal));
  const Renaming to_plan = present_->renaming.then(canonical->renamed.renaming);
  const std::string goal_there = to_plan.ofText(goal);
  Fingerprinter fingerprinter = begun(canonical->key, "plan");
  fingerprinter.addText(goal_there);
  fingerprinter.add(std::uint64_t{max_plans});
  const Fingerprint key = fingerprinter.result();
  auto known = cache_->situation_plans.find(key);
  if (!known)
  {
    reasoner::PlanOptions options = options_;
    options.all = max_plans > 1;
    options.max_plans = static_cast<int>(max_plans);
    PlanResult result =
        situations_->plan(canonical->renamed.situation, goal_there, options, &cancel);
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
