// The part of MissionDriver that touches the high-level history: records, diagnosis, told facts.

#include <algorithm>
#include <utility>

#include "kr3_executive/driver.hpp"
#include "kr3_executive/history_summary.hpp"
#include "literal_text.hpp"
#include "mission_inputs.hpp"

namespace kr3::executive
{
namespace
{

using reasoner::Answer;
using reasoner::Record;
using reasoner::RecordKind;

bool isAction(const Record& record)
{
  return record.kind == RecordKind::kHappened || record.kind == RecordKind::kAttempted;
}

/// Of the last observation before a step that gave a literal its truth; 1 when none did.
double lastConfidence(const std::vector<Record>& history, const std::string& literal, int step)
{
  const LiteralText asked = takeApart(literal);
  double confidence = 1.0;
  for (const auto& record : history)
  {
    if (isAction(record) || record.step >= step)
      continue;
    const LiteralText seen = takeApart(record.statement);
    const bool told = seen.isBoolean() ? record.value == (asked.value == "true")
                                       : record.value && seen.value == asked.value;
    if (seen.fluent() == asked.fluent() && told)
      confidence = record.confidence;
  }
  return confidence;
}

void collectConstants(const reasoner::Formula& formula, std::vector<std::string>& constants)
{
  for (const auto& operand : formula.operands)
    collectConstants(operand, constants);
  for (const auto& argument : formula.literal.atom.arguments)
    constants.push_back(argument.name);
}

}  // namespace

int currentStep(const std::vector<Record>& history)
{
  int step = 0;
  for (const auto& record : history)
    step = std::max(step, record.step + (isAction(record) ? 1 : 0));
  return step;
}

void MissionDriver::addToHistory(const std::vector<Record>& records)
{
  std::vector<Record> all = knowledge_.history;
  all.insert(all.end(), records.begin(), records.end());
  try
  {
    reasoner_.addRecords(records);
  }
  catch (const FailedPrecondition&)  // it was restarted, or holds another history
  {
    reasoner_.setHistory(all);
  }
  knowledge_.history = std::move(all);
  forgetAnswers();
  observer_.onRecords(records);
}

int MissionDriver::sumUpHistory()
{
  const int window = static_cast<int>(config_.history_window);
  const int now = currentStep(knowledge_.history);
  if (window == 0 || now <= window + window / 2)
    return 0;
  const int first_step = now - window;
  auto shorter =
      summarised(knowledge_.history, first_step, reasoner_, [&](const std::string& literal) {
        return lastConfidence(knowledge_.history, literal, first_step);
      });
  if (!shorter)
    return 0;
  knowledge_.history = std::move(*shorter);
  forgetAnswers();
  return first_step;
}

bool MissionDriver::isUnexpected(const Record& record)
{
  const bool from_action = state_.phase == Phase::kRecording && record.source == "robot";
  if (from_action)
  {
    if (state_.last_result == ActionResult::kAchieved || record.kind == RecordKind::kAttempted)
      return false;
    return true;  // refuted, displaced, or known to have failed
  }
  const int now = currentStep(knowledge_.history);
  const bool seen_by_the_way = record.source == kSightingSource;
  if (isAction(record) || (record.step > now && !seen_by_the_way))
    return false;
  const Answer contrary = record.value ? Answer::kFalse : Answer::kTrue;
  return reasoner_.entails(record.statement, std::min(record.step, now)) == contrary;
}

Event MissionDriver::performRecords(const std::vector<Record>& records)
{
  bool unexpected = false;
  std::vector<bool> surprising;
  for (const auto& record : records)
  {
    const bool surprise = isUnexpected(record);
    surprising.push_back(surprise);
    unexpected = unexpected || surprise;
    if (!surprise)
      continue;
    const bool later = record.step > currentStep(knowledge_.history);
    const bool told_already = state_.last_result == ActionResult::kDisplaced ||
                              state_.last_result == ActionResult::kRefuted;
    if (later && !isAction(record) && told_already)
      continue;  // it follows from the record before it
    const bool asked = !isAction(record) && !record.value && !later;
    if (interest_.narration)
    {
      surprises_.push_back(
          narrator_.surprise(record, asked ? supportOf(record.statement, record.step) : Support{}));
    }
    if (!isAction(record))
      surprised_fluents_.push_back(takeApart(record.statement).fluent());
  }
  addToHistory(records);
  for (std::size_t i = 0; i < records.size(); ++i)
    report(EventKind::kRecord, [&] { return narrator_.record(records[i], surprising[i]); });
  if (!unexpected)
    refreshFacts();
  return RecordsAdded{currentStep(knowledge_.history), unexpected};
}

std::optional<reasoner::Diagnosis> MissionDriver::diagnosisInTime()
{
  try
  {
    return reasoner_.diagnose();
  }
  catch (const DeadlineExceeded& e)
  {
    surprises_.push_back(std::string("why was not found in time: ") + e.what());
    return std::nullopt;
  }
}

Event MissionDriver::performDiagnosis()
{
  if (!interest_.narration && !interest_.log)
  {
    surprises_.clear();
    surprised_fluents_.clear();
    return DiagnosisReady{reasoner_.isConsistent()};
  }
  // What happened is of use to people. To go on it is enough that something can have; if not, the
  // next plan says so.
  const std::optional<reasoner::Diagnosis> found = diagnosisInTime();
  note([&] { return found ? reported(*found) : reportedLateDiagnosis(); });
  reasoner::Diagnosis diagnosis;
  diagnosis.consistent = true;
  if (found)
    diagnosis = *found;
  const std::vector<std::string> known = std::exchange(exceptions_, {});
  std::vector<std::string> expectations;
  if (diagnosis.consistent && interest_.narration)
  {
    if (!diagnosis.explanations.empty())
      exceptions_ = diagnosis.explanations.front();
    for (const auto& text : reasoner_.entailedAt(state_.step))
    {
      const LiteralText literal = takeApart(text);
      const bool asked = std::find(surprised_fluents_.begin(), surprised_fluents_.end(),
                                   literal.fluent()) != surprised_fluents_.end();
      if (!asked || !literal.equal)
        continue;
      const Support support = supportOf(text, state_.step);
      expectations.push_back(narrator_.phrase(text) +
                             (support.reason.empty() ? "" : " (" + support.reason + ")"));
    }
  }
  report(EventKind::kDiagnosis, [&] {
    return narrator_.diagnosis(surprises_, diagnosis, known, expected_by_default_, expectations);
  });
  surprises_.clear();
  surprised_fluents_.clear();
  refreshFacts();
  return DiagnosisReady{diagnosis.consistent};
}

void MissionDriver::tell(const Record& record)
{
  Record told = checkedFact(record, domain_.highLevel());
  {
    const std::lock_guard<std::mutex> lock(told_mutex_);
    told_.push_back(std::move(told));
  }
  if (running_)
    return;  // and it may be the mission's own thread that tells
  const std::unique_lock<std::mutex> idle(mission_mutex_, std::try_to_lock);
  if (idle.owns_lock())
    takeInTold();
}

namespace
{

/// Where a fact that comes between missions belongs. After an action of the robot one step passes
/// in which it does nothing: others may have changed what the action left behind.
int stepOfNews(const std::vector<Record>& history)
{
  const int now = currentStep(history);
  const bool acted = std::any_of(history.begin(), history.end(), [now](const Record& record) {
    const bool is_action =
        record.kind == RecordKind::kHappened || record.kind == RecordKind::kAttempted;
    return is_action && record.step == now - 1;
  });
  return acted ? now + 1 : now;
}

}  // namespace

void MissionDriver::takeInTold()
{
  std::vector<Record> told;
  {
    const std::lock_guard<std::mutex> lock(told_mutex_);
    told.swap(told_);
  }
  if (told.empty())
    return;
  const int step = stepOfNews(knowledge_.history);
  for (auto& record : told)
  {
    note(FactTold{record, false});
    record.step = step;
  }
  addToHistory(told);
  for (const auto& record : told)
    report(EventKind::kRecord, [&] { return narrator_.record(record, false); });
  refreshFacts();
  publish();
}

void MissionDriver::refreshFacts()
{
  facts_.clear();
  if (!config_.explain_facts || state_.goal.empty() || !interest_.narration)
    return;
  std::vector<std::string> constants;
  collectConstants(reasoner::parseGoal(state_.goal, domain_.highLevel()), constants);
  const int step = currentStep(knowledge_.history);
  try
  {
    for (const auto& text : reasoner_.entailedAt(step))
    {
      const LiteralText literal = takeApart(text);
      const bool about = std::any_of(literal.arguments.begin(), literal.arguments.end(),
                                     [&](const std::string& argument) {
        return std::find(constants.begin(), constants.end(), argument) != constants.end();
      });
      if (!about || !literal.equal || literal.value == "false")
        continue;
      facts_.push_back({text, static_cast<std::uint32_t>(step), supportOf(text, step).reason});
    }
  }
  catch (const FailedPrecondition&)  // an inconsistent history entails nothing
  {
    facts_.clear();
  }
}

void MissionDriver::report(EventKind kind, const std::function<Narration()>& narration)
{
  if (!interest_.narration)
    return;
  ReportedEvent event;
  event.kind = kind;
  event.sequence = sequence_++;
  event.hl_step = static_cast<std::uint32_t>(state_.step);
  event.hl_action = state_.currentAction();
  event.ll_action = ll_action_;
  event.narration = narration();
  observer_.onEvent(event);
}

void MissionDriver::publish()
{
  if (!interest_.snapshots)
    return;
  observer_.onSnapshot({state_, ll_action_, knowledge_.history, facts_, exceptions_});
}

}  // namespace kr3::executive
