#include "conversions.hpp"

#include <kr3_common/error.hpp>

namespace kr3::reasoner
{

namespace
{

constexpr bool same(RecordKind kind, int constant)
{
  return static_cast<int>(kind) == constant;
}

static_assert(same(RecordKind::kObserved, kr3_msgs::HistoryRecord::OBS));
static_assert(same(RecordKind::kHappened, kr3_msgs::HistoryRecord::HPD));
static_assert(same(RecordKind::kAttempted, kr3_msgs::HistoryRecord::ATTEMPT));
static_assert(same(RecordKind::kInitially, kr3_msgs::HistoryRecord::INIT));

}  // namespace

Record fromMsg(const kr3_msgs::HistoryRecord& message)
{
  if (message.kind > kr3_msgs::HistoryRecord::INIT)
  {
    throw InvalidArgument("found the kind " + std::to_string(message.kind) +
                          " of a record, expected 0 to 3");
  }
  constexpr std::uint32_t kMaxStep = 100000;
  if (message.step > kMaxStep)
  {
    throw InvalidArgument("found step " + std::to_string(message.step) + ", expected at most " +
                          std::to_string(kMaxStep));
  }
  Record record;
  record.kind = static_cast<RecordKind>(message.kind);
  record.statement = message.statement;
  record.value = message.value != 0 || record.kind == RecordKind::kHappened ||
                 record.kind == RecordKind::kAttempted;
  record.step = static_cast<int>(message.step);
  record.confidence = message.confidence;
  record.source = message.source;
  return record;
}

std::vector<Record> fromMsg(const std::vector<kr3_msgs::HistoryRecord>& messages)
{
  std::vector<Record> records;
  for (const kr3_msgs::HistoryRecord& message : messages)
  {
    records.push_back(fromMsg(message));
  }
  return records;
}

kr3_msgs::MakePlanResult toMsg(const PlanResult& result, int first_step)
{
  kr3_msgs::MakePlanResult message;
  message.goal_entailed = result.goal_entailed;
  message.reason = result.reason;
  message.cpu_s = result.cpu_s;
  for (const Plan& plan : result.plans)
  {
    kr3_msgs::HighLevelPlan converted;
    converted.hypothesis = plan.hypothesis;
    for (std::size_t i = 0; i < plan.steps.size(); ++i)
    {
      kr3_msgs::PlanStep step;
      step.step = static_cast<std::uint32_t>(first_step) + static_cast<std::uint32_t>(i);
      step.actions = plan.steps[i];
      converted.steps.push_back(step);
    }
    message.plans.push_back(converted);
  }
  return message;
}

std::string joined(const std::vector<std::string>& items, const std::string& separator)
{
  std::string text;
  for (const std::string& item : items)
  {
    text += (text.empty() ? "" : separator) + item;
  }
  return text;
}

}  // namespace kr3::reasoner
