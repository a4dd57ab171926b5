#include "conversions.hpp"

#include <cmath>

#include <kr3_common/error.hpp>

#include "texts.hpp"

namespace kr3::reasoner
{

namespace
{

template <typename Enum>
constexpr bool same(Enum value, int constant)
{
  return static_cast<int>(value) == constant;
}

static_assert(same(RecordKind::kObserved, kr3_msgs::HistoryRecord::OBS));
static_assert(same(RecordKind::kHappened, kr3_msgs::HistoryRecord::HPD));
static_assert(same(RecordKind::kAttempted, kr3_msgs::HistoryRecord::ATTEMPT));
static_assert(same(RecordKind::kInitially, kr3_msgs::HistoryRecord::INIT));
static_assert(same(AssumptionKind::kException, kr3_msgs::Assumption::EXCEPTION));
static_assert(same(AssumptionKind::kExogenous, kr3_msgs::Assumption::EXOGENOUS));
static_assert(same(AssumptionKind::kFailure, kr3_msgs::Assumption::FAILURE));
static_assert(same(AssumptionKind::kWrongRecord, kr3_msgs::Assumption::WRONG_RECORD));
static_assert(same(ReasonKind::kObserved, kr3_msgs::Reason::OBSERVED));
static_assert(same(ReasonKind::kDefault, kr3_msgs::Reason::DEFAULT));
static_assert(same(ReasonKind::kTogether, kr3_msgs::Reason::TOGETHER));
static_assert(same(ReasonKind::kCarried, kr3_msgs::Reason::CARRIED));
static_assert(same(PlanPreference::kShortest, kr3_msgs::MakePlanGoal::SHORTEST));
static_assert(same(PlanPreference::kCheapestShortest, kr3_msgs::MakePlanGoal::CHEAPEST_SHORTEST));
static_assert(same(PlanPreference::kCheapest, kr3_msgs::MakePlanGoal::CHEAPEST));

std::uint32_t count(std::size_t number)
{
  return static_cast<std::uint32_t>(number);
}

std::vector<std::uint32_t> counts(const std::vector<std::size_t>& numbers)
{
  return {numbers.begin(), numbers.end()};
}

void addProof(const Reason& reason, std::uint32_t depth, std::vector<kr3_msgs::Reason>& proof)
{
  kr3_msgs::Reason message;
  message.depth = depth;
  message.kind = static_cast<std::uint8_t>(reason.kind);
  message.statement = reason.statement;
  message.step = static_cast<std::uint32_t>(reason.step);
  message.record = reason.record == kNoRecord ? -1 : static_cast<std::int32_t>(reason.record);
  message.default_name = reason.default_name;
  if (reason.position.line > 0)
  {
    message.source = reason.position.file + ":" + std::to_string(reason.position.line);
  }
  message.sentence = reason.sentence;
  proof.push_back(message);
  for (const Reason& child : reason.children)
  {
    addProof(child, depth + 1, proof);
  }
}

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
  record.statement = checkedText(message.statement, "statement of a record");
  record.value = message.value != 0 || record.kind == RecordKind::kHappened ||
                 record.kind == RecordKind::kAttempted;
  record.step = static_cast<int>(message.step);
  record.confidence = message.confidence;
  record.source = checkedText(message.source, "source of a record");
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

kr3_msgs::HistoryRecord toMsg(const Record& record)
{
  kr3_msgs::HistoryRecord message;
  message.kind = static_cast<std::uint8_t>(record.kind);
  message.statement = record.statement;
  message.value = static_cast<std::uint8_t>(record.value);
  message.step = static_cast<std::uint32_t>(record.step);
  message.confidence = record.confidence;
  message.source = record.source;
  return message;
}

PlanOptions fromMsg(const kr3_msgs::MakePlanGoal& goal, const PlanOptions& defaults)
{
  constexpr std::uint32_t kMaxNumber = 1000000;
  PlanOptions options = defaults;
  if (goal.preference > kr3_msgs::MakePlanGoal::CHEAPEST)
  {
    throw InvalidArgument("found the preference " + std::to_string(goal.preference) +
                          " among plans, expected 0 to 2");
  }
  if (goal.max_horizon > kMaxNumber || goal.max_plans > kMaxNumber)
  {
    throw InvalidArgument("found max_horizon " + std::to_string(goal.max_horizon) +
                          " and max_plans " + std::to_string(goal.max_plans) +
                          ", expected at most " + std::to_string(kMaxNumber));
  }
  if (goal.time_limit < ros::Duration(0.0))
  {
    throw InvalidArgument("found a time limit of " + std::to_string(goal.time_limit.toSec()) +
                          " s, expected at least 0");
  }
  options.preference = static_cast<PlanPreference>(goal.preference);
  options.all = goal.all != 0;
  options.relevant_only = goal.whole_description == 0;
  if (goal.max_horizon > 0)
  {
    options.max_horizon = static_cast<int>(goal.max_horizon);
  }
  if (goal.max_plans > 0)
  {
    options.max_plans = static_cast<int>(goal.max_plans);
  }
  if (!goal.time_limit.isZero())
  {
    options.time_limit = std::chrono::milliseconds(std::llround(goal.time_limit.toSec() * 1e3));
  }
  return options;
}

kr3_msgs::ProblemSize toMsg(const ProblemSize& size)
{
  kr3_msgs::ProblemSize message;
  message.fluents = count(size.fluents);
  message.constants = count(size.constants);
  message.actions = count(size.actions);
  message.records = count(size.records);
  return message;
}

kr3_msgs::RelevantItem toMsg(const RelevantItem& item)
{
  kr3_msgs::RelevantItem message;
  message.name = item.name;
  message.why = item.why;
  return message;
}

kr3_msgs::Retraction toMsg(const Retraction& retraction)
{
  kr3_msgs::Retraction message;
  message.records = counts(retraction.records);
  message.log_odds = retraction.log_odds;
  message.opens = retraction.opens;
  message.in_words = retraction.in_words;
  return message;
}

kr3_msgs::ExplanationPart toMsg(const ExplanationPart& part)
{
  kr3_msgs::ExplanationPart message;
  message.price = static_cast<std::uint32_t>(part.price);
  for (const std::vector<std::string>& explanation : part.explanations)
  {
    message.explanations.push_back(joined(explanation, "; "));
  }
  message.in_words = part.in_words;
  message.complete = static_cast<std::uint8_t>(part.complete);
  return message;
}

kr3_msgs::MinimalExplanation toMsg(const ExplanationAlternative& alternative)
{
  kr3_msgs::MinimalExplanation message;
  for (const Assumption& assumption : alternative.assumptions)
  {
    kr3_msgs::Assumption converted;
    converted.kind = static_cast<std::uint8_t>(assumption.kind);
    converted.statement = assumption.statement;
    converted.sentence = assumption.sentence;
    converted.price = static_cast<std::uint32_t>(assumption.price);
    converted.defaults = assumption.defaults;
    converted.because = counts(assumption.because);
    converted.because_in_words = assumption.because_in_words;
    message.assumptions.push_back(converted);
  }
  message.price = static_cast<std::uint32_t>(alternative.price);
  message.in_words = alternative.in_words;
  return message;
}

kr3_msgs::HistoryModel toMsg(const HistoryModel& model, const Description& description)
{
  kr3_msgs::HistoryModel message;
  message.assumed = model.assumed;
  for (std::size_t i = 0; i < model.states.size(); ++i)
  {
    kr3_msgs::HistoryStep step;
    for (const Literal& literal : model.states[i])
    {
      step.literals.push_back(toString(literal, description));
    }
    if (i < model.actions.size())
    {
      step.actions = model.actions[i];
    }
    message.steps.push_back(step);
  }
  return message;
}

std::vector<kr3_msgs::Reason> toMsg(const Reason& proof)
{
  std::vector<kr3_msgs::Reason> messages;
  addProof(proof, 0, messages);
  return messages;
}

kr3_msgs::MakePlanResult toMsg(const PlanResult& result, int first_step)
{
  kr3_msgs::MakePlanResult message;
  message.goal_entailed = result.goal_entailed;
  message.reason = result.reason;
  message.cpu_s = result.cpu_s;
  message.complete = result.complete;
  message.considered = toMsg(result.considered);
  message.whole = toMsg(result.whole);
  message.widened = static_cast<std::uint32_t>(result.widened);
  for (const Plan& plan : result.plans)
  {
    kr3_msgs::HighLevelPlan converted;
    converted.hypothesis = plan.hypothesis;
    converted.cost = plan.cost;
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
