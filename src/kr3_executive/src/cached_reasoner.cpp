#include "kr3_executive/cached_reasoner.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

namespace kr3::executive
{
namespace
{

using reasoner::Record;

void addKey(Fingerprinter& fingerprinter, const Fingerprint& key)
{
  fingerprinter.add(key.high);
  fingerprinter.add(key.low);
}

std::uint64_t bitsOf(double number)
{
  std::uint64_t bits = 0;
  std::memcpy(&bits, &number, sizeof bits);
  return bits;
}

Fingerprint extended(const Fingerprint& before, const std::vector<Record>& records, bool exactly)
{
  Fingerprinter fingerprinter;
  addKey(fingerprinter, before);
  fingerprinter.add(static_cast<std::uint64_t>(records.size()));
  for (const Record& record : records)
  {
    fingerprinter.add(static_cast<std::uint64_t>(record.kind));
    fingerprinter.addText(record.statement);
    fingerprinter.add(static_cast<std::uint64_t>(record.value ? 1 : 0));
    fingerprinter.add(static_cast<std::uint64_t>(static_cast<std::int64_t>(record.step)));
    fingerprinter.add(exactly ? bitsOf(record.confidence)
                              : static_cast<std::uint64_t>(record.confidence < 1.0 ? 0 : 1));
    fingerprinter.addText(record.source);
  }
  return fingerprinter.result();
}

Fingerprint fingerprintOf(const reasoner::Description& description,
                          const reasoner::PlanOptions& options, std::uint32_t history_window)
{
  Fingerprinter fingerprinter;
  fingerprinter.addText(reasoner::toString(description));
  fingerprinter.add(static_cast<std::uint64_t>(options.max_horizon));
  fingerprinter.add(static_cast<std::uint64_t>(options.time_limit.count()));
  fingerprinter.add(static_cast<std::uint64_t>(options.preference));
  fingerprinter.add(static_cast<std::uint64_t>(options.all ? 1 : 0));
  fingerprinter.add(static_cast<std::uint64_t>(options.max_plans));
  fingerprinter.add(static_cast<std::uint64_t>(options.relevant_only ? 1 : 0));
  fingerprinter.add(bitsOf(options.extra_share));
  fingerprinter.add(std::uint64_t{history_window});
  return fingerprinter.result();
}

std::size_t sizeOf(const std::vector<std::string>& texts)
{
  std::size_t bytes = sizeof texts + texts.size() * sizeof(std::string);
  for (const auto& text : texts)
    bytes += text.capacity() > 15 ? text.capacity() : 0;
  return bytes;
}

std::size_t sizeOf(const reasoner::PlanResult& result)
{
  std::size_t bytes = sizeof result;
  for (const auto& plan : result.plans)
  {
    bytes += sizeOf(plan.hypothesis);
    for (const auto& step : plan.steps)
      bytes += sizeOf(step);
  }
  return bytes;
}

std::size_t sizeOf(const reasoner::Diagnosis& diagnosis)
{
  std::size_t bytes = sizeof diagnosis + sizeOf(diagnosis.in_words) + sizeOf(diagnosis.conflict);
  for (const auto& explanation : diagnosis.explanations)
    bytes += sizeOf(explanation);
  for (const auto& alternative : diagnosis.alternatives)
  {
    bytes += sizeof alternative + alternative.in_words.size();
    for (const auto& assumption : alternative.assumptions)
    {
      bytes += sizeof assumption + assumption.statement.size() + assumption.sentence.size() +
               assumption.because_in_words.size() + sizeOf(assumption.defaults);
    }
  }
  return bytes;
}

std::size_t sizeOf(const reasoner::Reason& reason)
{
  std::size_t bytes = sizeof reason + reason.statement.size() + reason.sentence.size();
  for (const auto& child : reason.children)
    bytes += sizeOf(child);
  return bytes;
}

std::size_t sizeOf(const reasoner::Explanation& explanation)
{
  return sizeof explanation + sizeOf(explanation.reasons) + sizeOf(explanation.records) +
         sizeOf(explanation.defaults) + sizeOf(explanation.proof);
}

}  // namespace

CachedReasoner::CachedReasoner(reasoner::Description description,
                               const reasoner::PlanOptions& options,
                               std::shared_ptr<ReasonerCache> cache, std::uint32_t history_window)
  : cache_(cache ? std::move(cache) : std::make_shared<ReasonerCache>())
  , description_(std::move(description))
  , literals_(description_)
  , options_(options)
  , settings_{{}, history_window}
  , reasoner_(std::make_shared<InProcessReasoner>(description_, options, settings_))
  , empty_(fingerprintOf(description_, options, history_window))
{
}

void CachedReasoner::restart(ConfidenceMatch match)
{
  match_ = match;
  told_.clear();
  present_.reset();
  step_ = 0;
  if (!is_long_)
    return;
  is_long_ = false;
  applied_.clear();
  reasoner_ = fresh();
}

void CachedReasoner::setHistory(const std::vector<Record>& records)
{
  tell(records, Told::How::kAnew);
}

void CachedReasoner::addRecords(const std::vector<Record>& records)
{
  tell(records, Told::How::kAdded);
}

void CachedReasoner::suppose(const std::vector<Record>& records)
{
  tell(records, Told::How::kSupposed);
}

void CachedReasoner::tell(const std::vector<Record>& records, Told::How how)
{
  const bool anew = how != Told::How::kAdded;
  Fingerprint exact = empty_;
  Fingerprint below_one = empty_;
  if (!anew && !told_.empty())
  {
    exact = told_.back().exact;
    below_one = told_.back().below_one;
  }
  std::vector<Told> before = anew ? std::exchange(told_, {}) : std::vector<Told>{};
  const int step_before = step_;
  step_ = std::max(anew ? 0 : step_, currentStep(records));
  told_.push_back(
      {records, how, extended(exact, records, true), extended(below_one, records, false)});
  try
  {
    if (match_ == ConfidenceMatch::kBelowOne)
    {
      if (!situations_)
        situations_ = std::make_unique<reasoner::Situations>(description_, settings_.options);
      situations_->check(records);
      // From situation to situation is no shorter way to what is asked once.
      if (how == Told::How::kSupposed)
        present_.reset();
      else
        follow(records, anew);
    }
    if (!present_)
      tellWhole(told_.back().below_one);
  }
  catch (...)
  {
    present_.reset();
    if (anew)
      told_ = std::move(before);
    else
      told_.pop_back();
    step_ = step_before;
    throw;
  }
}

void CachedReasoner::tellWhole(const Fingerprint& key)
{
  const auto& records = told_.back().records;
  const bool certain = std::all_of(records.begin(), records.end(), [](const Record& record) {
    return record.confidence > 0.0 && record.confidence <= 1.0;
  });
  const bool taken = certain && cache_->histories.find(key);
  if (taken && !is_long_ && !isLong())
    return;
  static_cast<void>(current());
  if (!is_long_)
    cache_->histories.keep(key, true, sizeof(bool));
}

bool CachedReasoner::isLong() const
{
  const int window = static_cast<int>(settings_.history_window);
  return window > 0 && step_ > window * 3 / 2;
}

void CachedReasoner::becomeLongIfDue()
{
  if (!is_long_ && isLong())
    becomeLong();
}

void CachedReasoner::becomeLong()
{
  reasoner_ = fresh();
  is_long_ = true;
  applied_.clear();
  for (const Told& told : told_)
    applied_.push_back({told.how, told.exact});
}

InProcessReasoner& CachedReasoner::current()
{
  becomeLongIfDue();
  const bool follows =
      applied_.size() <= told_.size() &&
      std::equal(applied_.begin(), applied_.end(), told_.begin(),
                 [](const Applied& applied, const Told& told) { return applied.is(told); });
  if (!follows)
  {
    applied_.clear();
    reasoner_->setHistory({});
  }
  while (applied_.size() < told_.size())
  {
    const Told& next = told_[applied_.size()];
    next.tell(*reasoner_);
    applied_.push_back({next.how, next.exact});
  }
  return *reasoner_;
}

std::shared_ptr<InProcessReasoner> CachedReasoner::unbiased()
{
  becomeLongIfDue();
  if (!is_long_)
    return fresh();
  static_cast<void>(current());
  return reasoner_;
}

std::shared_ptr<InProcessReasoner> CachedReasoner::fresh() const
{
  auto reasoner = std::make_shared<InProcessReasoner>(description_, options_, settings_);
  for (const Told& told : told_)
    told.tell(*reasoner);
  return reasoner;
}

void CachedReasoner::Told::tell(InProcessReasoner& reasoner) const
{
  switch (how)
  {
    case How::kAdded:
      return reasoner.addRecords(records);
    case How::kAnew:
      return reasoner.setHistory(records);
    case How::kSupposed:
      return reasoner.suppose(records);
  }
}

Fingerprint CachedReasoner::keyOf(const char* question, const std::string& text, int step,
                                  bool exactly) const
{
  Fingerprinter fingerprinter;
  Fingerprint history = empty_;
  if (!told_.empty())
  {
    // Which record is taken to be wrong depends on how doubtful each one is. While the situation is
    // followed none is.
    const bool none_wrong = match_ == ConfidenceMatch::kBelowOne && present_.has_value();
    history = exactly || !none_wrong ? told_.back().exact : told_.back().below_one;
  }
  addKey(fingerprinter, history);
  fingerprinter.addText(question);
  fingerprinter.addText(text);
  fingerprinter.add(static_cast<std::uint64_t>(static_cast<std::int64_t>(step)));
  return fingerprinter.result();
}

std::vector<Record> CachedReasoner::records() const
{
  std::vector<Record> all;
  for (const Told& told : told_)
    all.insert(all.end(), told.records.begin(), told.records.end());
  return all;
}

template <typename Value, typename Compute, typename SizeOf>
Value CachedReasoner::answer(ContentCache<Value>& cache, const Fingerprint& key,
                             const Compute& compute, const SizeOf& size_of)
{
  becomeLongIfDue();
  if (is_long_)
    return compute();
  if (const auto known = cache.find(key))
    return *known;
  Value value = compute();
  cache.keep(key, value, size_of(value));
  return value;
}

reasoner::Diagnosis CachedReasoner::diagnose()
{
  return answer(
      cache_->diagnoses, keyOf("diagnosis", {}, 0, false), [&] { return current().diagnose(); },
      [](const reasoner::Diagnosis& diagnosis) { return sizeOf(diagnosis); });
}

reasoner::Diagnosis CachedReasoner::minimalExplanations()
{
  return answer(
      cache_->diagnoses, keyOf("explanations", {}, 0, false),
      [&] { return current().minimalExplanations(); },
      [](const reasoner::Diagnosis& diagnosis) { return sizeOf(diagnosis); });
}

bool CachedReasoner::isConsistent()
{
  return valuesAt(step_) != nullptr || minimalExplanations().consistent;
}

reasoner::Answer CachedReasoner::entails(const std::string& literal, int step)
{
  if (const auto known = answerAt(literal, step))
    return *known;
  return answer(
      cache_->answers, keyOf("entails", literal, step, false),
      [&] { return current().entails(literal, step); },
      [](const reasoner::Answer& value) { return sizeof value; });
}

bool CachedReasoner::possible(const std::string& literal, int step)
{
  if (const auto known = answerAt(literal, step))
    return *known != reasoner::Answer::kFalse;
  const auto answered = answer(
      cache_->answers, keyOf("possible", literal, step, false),
      [&] {
    return current().possible(literal, step) ? reasoner::Answer::kTrue : reasoner::Answer::kFalse;
      },
      [](const reasoner::Answer& value) { return sizeof value; });
  return answered == reasoner::Answer::kTrue;
}

std::vector<std::string> CachedReasoner::entailedAt(int step)
{
  if (const auto* values = valuesAt(step))
  {
    std::vector<std::string> literals;
    for (const auto& literal : situations_->entailed(*values))
      literals.push_back(reasoner::toString(literal));
    return literals;
  }
  return answer(
      cache_->entailed, keyOf("entailed", {}, step, false),
      [&] { return current().entailedAt(step); },
      [](const std::vector<std::string>& literals) { return sizeOf(literals); });
}

bool CachedReasoner::cite(reasoner::Explanation& explanation) const
{
  const std::vector<Record> all = records();
  const auto& indices = explanation.record_indices;
  if (indices.size() != explanation.records.size() ||
      std::any_of(indices.begin(), indices.end(), [&](std::size_t i) { return i >= all.size(); }))
    return false;
  for (std::size_t i = 0; i < indices.size(); ++i)
    explanation.records[i] = reasoner::toString(all[indices[i]]);
  return true;
}

reasoner::Explanation CachedReasoner::explain(const std::string& literal, int step)
{
  becomeLongIfDue();
  const Fingerprint key = keyOf("explain", literal, step, false);
  const auto known = is_long_ ? nullptr : cache_->explanations.find(key);
  if (known)
  {
    reasoner::Explanation explanation = *known;
    if (match_ == ConfidenceMatch::kBelowOne)
      static_cast<void>(cite(explanation));
    return explanation;
  }
  reasoner::Explanation explanation = unbiased()->explain(literal, step);
  reasoner::Explanation cited = explanation;
  const bool citable =
      match_ == ConfidenceMatch::kExact || (cite(cited) && cited.records == explanation.records);
  if (!is_long_ && citable)
    cache_->explanations.keep(key, explanation, sizeOf(explanation));
  return explanation;
}

std::vector<reasoner::Retraction> CachedReasoner::retractions(const std::string& literal, int step)
{
  // Nothing has to be given up for what is so already.
  if (literal.empty()
          ? valuesAt(step_) != nullptr
          : answerAt(literal, step).value_or(reasoner::Answer::kFalse) != reasoner::Answer::kFalse)
    return {};
  if (!literal.empty() && valuesAt(step) != nullptr)
  {
    if (auto known = situationRetractions(literal))
      return std::move(*known);
  }
  return answer(
      cache_->retractions, keyOf("retractions", literal, step, true),
      [&] { return unbiased()->retractions(literal, step); },
      [](const std::vector<reasoner::Retraction>& retractions) {
    std::size_t bytes = sizeof retractions;
    for (const auto& retraction : retractions)
      bytes += sizeof retraction + retraction.records.size() * sizeof(std::size_t) +
               retraction.opens.size() + retraction.in_words.size();
    return bytes;
      });
}

reasoner::PlanResult CachedReasoner::plan(const std::string& goal, std::uint32_t max_plans,
                                          const std::atomic<bool>& cancel)
{
  if (auto known = situationPlan(goal, max_plans, cancel))
    return std::move(*known);
  becomeLongIfDue();
  const Fingerprint key = keyOf("plan", goal, static_cast<int>(max_plans), false);
  if (const auto known = is_long_ ? nullptr : cache_->plans.find(key))
    return *known;
  reasoner::PlanResult result = unbiased()->plan(goal, max_plans, cancel);
  if (result.complete && !is_long_)
    cache_->plans.keep(key, result, sizeOf(result));
  return result;
}

}  // namespace kr3::executive
