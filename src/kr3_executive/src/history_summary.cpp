#include "kr3_executive/history_summary.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include <kr3_common/error.hpp>

#include "literal_text.hpp"

namespace kr3::executive
{
namespace
{

using reasoner::Record;
using reasoner::RecordKind;

std::set<std::string> entailed(HighLevelReasoner& reasoner, int step)
{
  const std::vector<std::string> literals = reasoner.entailedAt(step);
  return {literals.begin(), literals.end()};
}

bool isObservation(const Record& record)
{
  return record.kind == RecordKind::kObserved || record.kind == RecordKind::kInitially;
}

Record observedNow(const std::string& text, double confidence)
{
  const LiteralText literal = takeApart(text);
  const bool denied = literal.value == "false";
  return {RecordKind::kObserved, denied ? literal.fluent() : text, !denied, 0, confidence,
          kSummarySource};
}

/// What stands for the records before a step, as far as they say so themselves.
std::vector<Record> ofObservations(const std::vector<Record>& history, int first_step,
                                   const std::set<std::string>& known,
                                   const std::function<double(const std::string&)>& confidence)
{
  std::map<std::string, std::string> values;  // known literal by fluent
  for (const auto& text : known)
  {
    const LiteralText literal = takeApart(text);
    if (literal.equal)
      values[literal.fluent()] = text;
  }
  std::vector<Record> summary;
  std::set<std::string> said;
  for (auto record = history.rbegin(); record != history.rend(); ++record)  // the last one counts
  {
    if (!isObservation(*record) || record->step >= first_step)
      continue;
    const LiteralText literal = takeApart(record->statement);
    const auto value = values.find(literal.fluent());
    const bool settled = value != values.end() && (record->value || literal.isBoolean());
    if (settled && said.insert(literal.fluent()).second)
      summary.push_back(observedNow(value->second, confidence(value->second)));
    if (record->value || literal.isBoolean() || said.count(literal.fluent()) > 0)
      continue;
    if (!said.insert(record->statement).second)
      continue;
    summary.push_back(*record);
    summary.back().kind = RecordKind::kObserved;
    summary.back().step = 0;
  }
  std::reverse(summary.begin(), summary.end());
  return summary;
}

/// @return nothing when the histories differ in what they entail
std::optional<std::vector<Record>> shortened(
    const std::vector<Record>& history, int first_step, HighLevelReasoner& reasoner,
    const std::function<double(const std::string&)>& confidence)
{
  const int now = currentStep(history);
  const std::set<std::string> then_known = entailed(reasoner, first_step);
  const std::set<std::string> now_known = entailed(reasoner, now);
  std::vector<Record> begin = ofObservations(history, first_step, then_known, confidence);
  std::vector<Record> rest;
  for (const auto& record : history)
  {
    if (record.step < first_step)
      continue;
    rest.push_back(record);
    rest.back().step -= first_step;
    if (record.kind == RecordKind::kInitially)
      rest.back().kind = RecordKind::kObserved;
  }
  const auto whole = [&] {
    std::vector<Record> records = begin;
    records.insert(records.end(), rest.begin(), rest.end());
    return records;
  };
  reasoner.setHistory(whole());
  const std::set<std::string> got = entailed(reasoner, 0);
  for (const auto& literal : then_known)
  {
    if (got.count(literal) == 0 && takeApart(literal).equal)
      begin.push_back(observedNow(literal, 1.0));  // what came of actions
  }
  std::vector<Record> result = whole();
  reasoner.setHistory(result);
  if (entailed(reasoner, 0) != then_known || entailed(reasoner, now - first_step) != now_known)
    return std::nullopt;
  return result;
}

}  // namespace

std::optional<std::vector<Record>> summarised(
    const std::vector<Record>& history, int first_step, HighLevelReasoner& reasoner,
    const std::function<double(const std::string& literal)>& confidence)
{
  std::optional<std::vector<Record>> result;
  try
  {
    result = shortened(history, first_step, reasoner, confidence);
  }
  catch (const FailedPrecondition&)  // what is left is inconsistent
  {
    result.reset();
  }
  if (!result)
    reasoner.setHistory(history);
  return result;
}

}  // namespace kr3::executive
