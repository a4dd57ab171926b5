#include "conversions.hpp"

#include <algorithm>
#include <map>

#include <kr3_common/error.hpp>

#include "../typed_error.hpp"

namespace kr3::executive
{

using kr3_msgs::HistoryRecord;
using kr3_msgs::MissionEvent;
using kr3_msgs::MissionState;
using reasoner::RecordKind;

static_assert(static_cast<int>(RecordKind::kObserved) == HistoryRecord::OBS);
static_assert(static_cast<int>(RecordKind::kHappened) == HistoryRecord::HPD);
static_assert(static_cast<int>(RecordKind::kAttempted) == HistoryRecord::ATTEMPT);
static_assert(static_cast<int>(RecordKind::kInitially) == HistoryRecord::INIT);
static_assert(static_cast<int>(EventKind::kGoal) == MissionEvent::GOAL);
static_assert(static_cast<int>(EventKind::kPlan) == MissionEvent::PLAN);
static_assert(static_cast<int>(EventKind::kHighLevelAction) == MissionEvent::HL_ACTION);
static_assert(static_cast<int>(EventKind::kPolicy) == MissionEvent::POLICY);
static_assert(static_cast<int>(EventKind::kLowLevelAction) == MissionEvent::LL_ACTION);
static_assert(static_cast<int>(EventKind::kRecord) == MissionEvent::RECORD);
static_assert(static_cast<int>(EventKind::kDiagnosis) == MissionEvent::DIAGNOSIS);
static_assert(static_cast<int>(EventKind::kReplan) == MissionEvent::REPLAN);
static_assert(static_cast<int>(EventKind::kDone) == MissionEvent::DONE);
static_assert(static_cast<int>(EventKind::kFailed) == MissionEvent::FAILED);
static_assert(static_cast<int>(EventKind::kCancelled) == MissionEvent::CANCELLED);

HistoryRecord toMsg(const reasoner::Record& record)
{
  HistoryRecord message;
  message.kind = static_cast<std::uint8_t>(record.kind);
  message.statement = record.statement;
  message.value = record.value;
  message.step = static_cast<std::uint32_t>(record.step);
  message.confidence = record.confidence;
  message.source = record.source;
  return message;
}

std::vector<HistoryRecord> toMsg(const std::vector<reasoner::Record>& records)
{
  std::vector<HistoryRecord> messages;
  messages.reserve(records.size());
  for (const auto& record : records)
    messages.push_back(toMsg(record));
  return messages;
}

kr3_msgs::HighLevelPlan toMsg(const reasoner::Plan& plan, int first_step)
{
  kr3_msgs::HighLevelPlan message;
  message.hypothesis = plan.hypothesis;
  for (std::size_t i = 0; i < plan.steps.size(); ++i)
  {
    kr3_msgs::PlanStep step;
    step.step = static_cast<std::uint32_t>(first_step + static_cast<int>(i));
    step.actions = plan.steps[i];
    message.steps.push_back(step);
  }
  return message;
}

reasoner::Plan fromMsg(const kr3_msgs::HighLevelPlan& message)
{
  reasoner::Plan plan{message.hypothesis, {}};
  for (const auto& step : message.steps)
    plan.steps.push_back(step.actions);
  return plan;
}

reasoner::Reason fromMsg(const std::vector<kr3_msgs::Reason>& proof)
{
  reasoner::Reason root;
  std::vector<reasoner::Reason*> above;  // from the root to the node before
  for (const auto& message : proof)
  {
    above.resize(std::min<std::size_t>(message.depth, above.size()));
    reasoner::Reason& reason = above.empty() ? root : above.back()->children.emplace_back();
    reason.kind = static_cast<reasoner::ReasonKind>(message.kind);
    reason.statement = message.statement;
    reason.step = static_cast<int>(message.step);
    reason.record =
        message.record < 0 ? reasoner::kNoRecord : static_cast<std::size_t>(message.record);
    reason.default_name = message.default_name;
    reason.sentence = message.sentence;
    above.push_back(&reason);
  }
  return root;
}

MissionEvent toMsg(const ReportedEvent& event)
{
  MissionEvent message;
  message.sequence = event.sequence;
  message.kind = static_cast<std::uint8_t>(event.kind);
  message.hl_step = event.hl_step;
  message.text = event.narration.text;
  message.data = event.narration.data;
  return message;
}

MissionState toMsg(const Snapshot& snapshot)
{
  const State& state = snapshot.state;
  MissionState message;
  message.state = MissionState::ACTIVE;
  if (state.phase == Phase::kIdle)
    message.state = MissionState::IDLE;
  else if (state.outcome && state.phase == Phase::kFinished)
  {
    const bool cancelled = state.outcome->code == ErrorCode::kCancelled;
    message.state = state.outcome->achieved ? MissionState::SUCCEEDED
                    : cancelled             ? MissionState::CANCELLED
                                            : MissionState::FAILED;
  }
  message.goal = state.goal;
  message.hl_step = static_cast<std::uint32_t>(state.step);
  message.plan_index = -1;
  if (state.plan)
  {
    message.plan = toMsg(state.plan->plan, state.step - static_cast<int>(state.plan_index));
    if (state.phase != Phase::kFinished && !state.currentAction().empty())
      message.plan_index = static_cast<std::int32_t>(state.plan_index);
  }
  message.ll_action = snapshot.ll_action;
  message.history = toMsg(snapshot.history);
  for (const auto& fact : snapshot.facts)
  {
    kr3_msgs::ExplainedLiteral literal;
    literal.literal = fact.literal;
    literal.step = fact.step;
    literal.reason = fact.reason;
    message.explanations.push_back(literal);
  }
  message.exceptions = snapshot.exceptions;
  message.hl_actions_done = state.hl_actions_done;
  message.ll_actions_done = state.ll_actions_done;
  return message;
}

kr3_msgs::MissionInput toMsg(const RecordedInput& input)
{
  using Message = kr3_msgs::MissionInput;
  static_assert(Message::DOMAIN == static_cast<int>(InputKind::kDomain) &&
                Message::MISSION == static_cast<int>(InputKind::kMission) &&
                Message::SKILL_RESULT == static_cast<int>(InputKind::kSkillResult) &&
                Message::TOLD == static_cast<int>(InputKind::kTold) &&
                Message::CANCEL == static_cast<int>(InputKind::kCancel) &&
                Message::DECISION == static_cast<int>(InputKind::kDecision));
  Message message;
  message.header.stamp = ros::Time(input.stamp_s);
  message.sequence = input.sequence;
  message.kind = static_cast<std::uint8_t>(input.kind);
  message.data = input.data;
  return message;
}

kr3_msgs::BeliefState toMsg(const ReportedBelief& belief)
{
  kr3_msgs::BeliefState message;
  message.hl_action = belief.hl_action;
  message.hl_step = belief.hl_step;
  for (const auto& [fluent, values] : belief.fluents)
  {
    kr3_msgs::FluentBelief marginal;
    marginal.fluent = fluent;
    for (const auto& [value, probability] : values)
    {
      marginal.values.push_back(value);
      marginal.probabilities.push_back(probability);
    }
    message.fluents.push_back(marginal);
  }
  return message;
}

refinement::ComponentMap fromMsg(const kr3_msgs::CellArray& message)
{
  std::map<std::string, std::size_t> index;
  for (std::size_t i = 0; i < message.cells.size(); ++i)
    index[message.cells[i].name] = i;
  refinement::ComponentMapData data;
  for (const auto& cell : message.cells)
  {
    data.components.push_back({cell.name, cell.room});
    std::vector<std::size_t> neighbors;
    for (const auto& name : cell.neighbors)
    {
      const auto found = index.find(name);
      if (found == index.end())
        throw InvalidArgument("cell '" + cell.name + "' has the neighbour '" + name +
                              "', which is no cell");
      neighbors.push_back(found->second);
    }
    data.neighbors.push_back(std::move(neighbors));
  }
  data.distances_m = message.travel_distance;
  return refinement::ComponentMap(std::move(data));
}

void throwIfFailed(const kr3_msgs::Status& status, const std::string& request)
{
  if (status.code != kr3_msgs::Status::OK)
    throwError(static_cast<ErrorCode>(status.code), request + ": " + status.message);
}

}  // namespace kr3::executive
