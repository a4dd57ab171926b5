// What line 16 of Algorithm 1 adds to the history; names for people.

#include <algorithm>
#include <utility>

#include "kr3_executive/mission.hpp"

namespace kr3::executive
{
namespace
{

using reasoner::Record;
using reasoner::RecordKind;

/// A record needs a confidence in (0, 1]; a belief of 1 is a belief, so it stays below certainty.
double confidenceOf(double belief)
{
  return std::clamp(belief, 0.001, 0.999);
}

Record observed(std::string literal, bool value, int step, double belief)
{
  return {RecordKind::kObserved, std::move(literal), value, step, confidenceOf(belief), "robot"};
}

Record acted(RecordKind kind, std::string action, int step)
{
  return {kind, std::move(action), true, step, 1.0, "robot"};
}

/// The records of an action that did not reach its effects.
std::vector<Record> recordsOfFailure(const std::string& action, int step,
                                     const Assessment& assessment, double least)
{
  std::vector<Record> records;
  for (const auto& refutation : assessment.refutations)
  {
    if (refutation.probability > least)
      records.push_back(observed(refutation.literal, false, step, refutation.probability));
  }
  if (!assessment.changed.empty())
  {
    records.push_back(assessment.happened ? acted(RecordKind::kHappened, *assessment.happened, step)
                                          : acted(RecordKind::kAttempted, action, step));
    for (const auto& literal : assessment.changed)
      records.push_back(observed(literal, true, step + 1, 1.0));
  }
  else if (assessment.attempted)
  {
    records.push_back(acted(RecordKind::kAttempted, action, step));
    // Without an observation an attempt would count as a success.
    for (const auto& literal : assessment.seen)
    {
      const bool denied = !literal.empty() && literal.front() == '-';
      records.push_back(observed(literal.substr(denied ? 1 : 0), !denied, step + 1, 1.0));
    }
    // Of several effects it is not known which one failed; a single one is known to have failed.
    if (assessment.seen.empty() && assessment.effects.size() == 1 &&
        1.0 - assessment.achieved > least)
    {
      records.push_back(
          observed(assessment.effects.front(), false, step + 1, 1.0 - assessment.achieved));
    }
  }
  return records;
}

}  // namespace

const char* toString(Phase phase)
{
  switch (phase)
  {
    case Phase::kIdle:
      return "idle";
    case Phase::kReporting:
      return "reporting";
    case Phase::kPlanning:
      return "planning";
    case Phase::kPreparing:
      return "preparing";
    case Phase::kExecuting:
      return "executing";
    case Phase::kRecording:
      return "recording";
    case Phase::kDiagnosing:
      return "diagnosing";
    case Phase::kReopening:
      return "reopening";
    case Phase::kFinished:
      return "finished";
  }
  return "unknown";
}

const char* toString(ActionResult result)
{
  switch (result)
  {
    case ActionResult::kNone:
      return "none";
    case ActionResult::kAchieved:
      return "achieved";
    case ActionResult::kRefuted:
      return "refuted";
    case ActionResult::kDisplaced:
      return "displaced";
    case ActionResult::kUnresolved:
      return "unresolved";
  }
  return "unknown";
}

std::vector<Record> recordsOf(const std::string& action, int step, ActionResult result,
                              const Assessment& assessment, double least)
{
  std::vector<Record> records;
  if (result == ActionResult::kAchieved)
  {
    records.push_back(acted(RecordKind::kHappened, action, step));
    for (const auto& effect : assessment.effects)
      records.push_back(observed(effect, true, step + 1, assessment.achieved));
  }
  else
    records = recordsOfFailure(action, step, assessment, least);
  // What was seen by the way is so when the action is over.
  int after = step;
  for (const auto& record : records)
    after = std::max(after, record.step + (record.kind == RecordKind::kObserved ? 0 : 1));
  for (const auto& noticed : assessment.noticed)
  {
    const bool denied = !noticed.literal.empty() && noticed.literal.front() == '-';
    records.push_back(
        observed(noticed.literal.substr(denied ? 1 : 0), !denied, after, noticed.confidence));
    records.back().source = kSightingSource;
  }
  return records;
}

}  // namespace kr3::executive
