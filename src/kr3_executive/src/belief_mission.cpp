#include "belief_mission.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include <nlohmann/json.hpp>

#include "kr3_executive/initial_belief.hpp"
#include "literal_text.hpp"
#include "mission_inputs.hpp"

namespace kr3::executive
{
namespace
{

using nlohmann::json;
using reasoner::Record;

/// Belief that counts as knowledge once nothing better is left to do, as in Algorithm 1.
constexpr double kMoreLikelyThanNot = 0.5;
/// Belief that no further look can better.
constexpr double kCertain = 1.0 - 1e-9;

std::string textOf(const std::vector<Record>& history)
{
  std::string text;
  for (const auto& record : history)
  {
    char confidence[32];
    std::snprintf(confidence, sizeof confidence, " %.9g\n", record.confidence);
    text += reasoner::toString(record) + confidence;
  }
  return text;
}

std::string rounded(double value)
{
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", value);
  return text;
}

}  // namespace

std::string keyOf(const refinement::DomainTask& task, const std::string& goal,
                  const refinement::SparseBelief& belief)
{
  char item[64];
  std::snprintf(item, sizeof item, "%p|", static_cast<const void*>(&task));
  std::string key = item + goal;
  for (const auto& [state, probability] : belief)
  {
    std::snprintf(item, sizeof item, "|%u %.12g", state, probability);
    key += item;
  }
  return key;
}

BeliefMission::BeliefMission(MissionParts parts, BaselineOptions options,
                             std::optional<double> default_probability,
                             std::shared_ptr<BaselineCache> cache, ControllerFactory controllers)
  : parts_(std::move(parts))
  , options_(options)
  , default_probability_(default_probability)
  , cache_(std::move(cache))
  , controllers_(std::move(controllers))
{
}

void BeliefMission::setKnowledge(Knowledge knowledge)
{
  const std::lock_guard<std::mutex> lock(mission_mutex_);
  parts_.reasoner.setHistory(knowledge.history);
  knowledge_ = std::move(knowledge);
}

DomainBelief BeliefMission::startBelief(const std::string& goal)
{
  const std::string history = textOf(knowledge_.history);
  const std::string about = goal + "\n" + history;
  auto constants = cache_->constants.find(about);
  if (constants == cache_->constants.end())
  {
    constants =
        cache_->constants.emplace(about, constantsFor(parts_.domain, goal, knowledge_.history))
            .first;
  }
  auto& task = cache_->tasks[constants->second];
  if (!task)
    task =
        std::make_shared<refinement::DomainTask>(parts_.domain, parts_.models, constants->second);
  const bool fresh = knowledge_.memory.empty();
  const std::string bias = default_probability_ ? std::to_string(*default_probability_) : "none";
  const std::string key = about + bias;
  const auto known = cache_->knowledge.find(key);
  refinement::InitialKnowledge knowledge;
  if (fresh && known != cache_->knowledge.end())
    knowledge = known->second;
  else
  {
    parts_.reasoner.setHistory(knowledge_.history);
    knowledge = knowledgeOf(parts_.reasoner, *task, knowledge_.history, knowledge_.memory,
                            default_probability_);
    if (fresh)
      cache_->knowledge[key] = knowledge;
  }
  return DomainBelief(task, task->initialBelief(knowledge, options_.max_states));
}

MissionResult BeliefMission::achieve(const std::string& goal, const std::vector<Record>& initial,
                                     const Limits& limits, double time_limit_s)
{
  const std::lock_guard<std::mutex> lock(mission_mutex_);
  const reasoner::Formula formula = reasoner::parseGoal(goal, parts_.domain.highLevel());
  cancel_ = false;
  sequence_ = 0;
  num_decisions_ = 0;
  state_ = {};
  state_.goal = goal;
  state_.limits = limits;
  controller_.reset();
  belief_.reset();
  const double start_s = parts_.clock();
  running_ = true;
  note(MissionBegun{goal, initial, limits, time_limit_s, parts_.config, knowledge_});
  report(EventKind::kGoal, parts_.narrator.goal(goal));
  Finish outcome;
  try
  {
    if (knowledge_.history.empty())
      knowledge_.history = initial;
    state_.phase = Phase::kPreparing;
    belief_ = startBelief(goal);
    outcome = run(formula, limits, time_limit_s);
  }
  catch (const Cancelled&)
  {
    note(MissionCancelled{});
    outcome = {ErrorCode::kCancelled, false, "cancelled"};
  }
  catch (const Error& e)
  {
    note(RequestRefused{e.code(), e.what()});
    outcome = {e.code(), false, e.what()};
  }
  if (belief_)
  {
    for (auto& [fluent, values] : belief_->marginals())
      knowledge_.memory[fluent] = {std::move(values), {}};
  }
  running_ = false;
  state_.phase = Phase::kFinished;
  state_.outcome = outcome;
  state_.hl_actions_done = controller_ ? controller_->numHighLevelActions() : 0;
  noteDecision("finish", outcome.reason);
  report(outcome.achieved                        ? EventKind::kDone
         : outcome.code == ErrorCode::kCancelled ? EventKind::kCancelled
                                                 : EventKind::kFailed,
         parts_.narrator.end(outcome, state_));
  publish({});
  takeInTold();
  return {outcome.code,           outcome.achieved,       outcome.reason,
          state_.hl_actions_done, state_.ll_actions_done, parts_.clock() - start_s};
}

Finish BeliefMission::run(const reasoner::Formula& goal, const Limits& limits, double time_limit_s)
{
  const double deadline_s = parts_.clock() + time_limit_s;
  const std::uint64_t most = std::uint64_t{limits.max_hl_actions} * limits.max_ll_actions;
  for (;;)
  {
    takeInTold();
    const double achieved = belief_->probability(goal);
    if (achieved > kCertain)
      return {ErrorCode::kOk, true, "the goal holds with probability " + rounded(achieved)};
    if (cancel_)
    {
      note(MissionCancelled{});
      return {ErrorCode::kCancelled, false, "cancelled"};
    }
    if (time_limit_s > 0.0 && parts_.clock() > deadline_s)
    {
      note(TimeExpired{});
      return {ErrorCode::kDeadlineExceeded, false, "the time allowed for the mission ran out"};
    }
    if (state_.ll_actions_done >= most)
    {
      return {ErrorCode::kOk, achieved > limits.threshold,
              "limit of " + std::to_string(most) + " low-level actions reached"};
    }
    if (!controller_)
    {
      controller_ = controllers_(*belief_, goal, cancel_);
      report(EventKind::kPolicy, {controller_->description(), "{}"});
    }
    state_.phase = Phase::kExecuting;
    const auto chosen = controller_->next(*belief_, cancel_);
    if (!chosen && achieved > kMoreLikelyThanNot)
    {
      return {ErrorCode::kOk, true,
              "the goal holds with probability " + rounded(achieved) +
                  ", and nothing better is left to do"};
    }
    if (!chosen)
    {
      return {ErrorCode::kOk, false,
              "going on is worth less than giving up; the goal holds with probability " +
                  rounded(achieved)};
    }
    const LowLevelAction action = belief_->action(*chosen);
    noteDecision("low_level_action", action.text);
    publish(action.text);
    const LowLevelResult result = execute(action);
    ++state_.ll_actions_done;
    state_.hl_actions_done = controller_->numHighLevelActions();
    const bool expected = belief_->update(*chosen, result.observation);
    controller_->observed(result.observation);
    for (const auto& sighting : result.sightings)
      belief_->weigh(sighting.literal, sighting.confidence);
    if (!expected || !result.sightings.empty())
      controller_->disturbed();
    const std::string summary = belief_->summary();
    json data = {{"action", action.text},
                 {"symbol", action.symbol},
                 {"arguments", action.arguments},
                 {"outcome", result.outcome},
                 {"observation", result.observation},
                 {"duration_s", result.duration_s},
                 {"belief", summary}};
    std::string text = action.text + (result.outcome.empty() ? "" : ": " + result.outcome);
    if (!result.observation.empty())
      text += " (" + listed(result.observation) + ")";
    report(EventKind::kLowLevelAction, {text + "; " + summary, data.dump()});
    reportBelief();
  }
}

LowLevelResult BeliefMission::execute(const LowLevelAction& action)
{
  const FluentLookup believed = [this](const std::string& fluent) {
    return belief_->likeliest(fluent);
  };
  return executeNoting(parts_.executor, action, believed, parts_.config.max_skill_retries, cancel_,
                       [this](const Input& input) { note(input); });
}

void BeliefMission::tell(const Record& record)
{
  Record told = checkedFact(record, parts_.domain.highLevel());
  {
    const std::lock_guard<std::mutex> lock(told_mutex_);
    told_.push_back(std::move(told));
  }
  if (running_)
    return;  // the mission takes it in
  const std::unique_lock<std::mutex> idle(mission_mutex_, std::try_to_lock);
  if (idle.owns_lock())
    takeInTold();
}

void BeliefMission::takeInTold()
{
  std::vector<Record> told;
  {
    const std::lock_guard<std::mutex> lock(told_mutex_);
    told.swap(told_);
  }
  for (const auto& record : told)
    takeIn(record);
}

void BeliefMission::takeIn(const Record& record)
{
  const bool running = state_.phase != Phase::kIdle && state_.phase != Phase::kFinished;
  note(FactTold{record, running});
  if (belief_)
  {
    const LiteralText literal = takeApart(record.statement);
    const bool boolean = literal.isBoolean();
    const std::string contrary =
        literal.value == "true" ? "-" + literal.fluent() : literal.fluent();
    if (record.value)
      belief_->weigh(record.statement, record.confidence);
    else if (boolean)
      belief_->weigh(contrary, record.confidence);
    else
      belief_->weigh(literal.fluent() + " != " + literal.value, record.confidence);
    for (auto& [fluent, values] : belief_->marginals())
      knowledge_.memory[fluent] = {std::move(values), {}};
    if (controller_)
      controller_->disturbed();
  }
  else
  {
    Record recorded = record;
    recorded.step = currentStep(knowledge_.history);
    knowledge_.history.push_back(std::move(recorded));
  }
  report(EventKind::kRecord, parts_.narrator.record(record, false));
}

void BeliefMission::report(EventKind kind, Narration narration)
{
  ReportedEvent event;
  event.kind = kind;
  event.sequence = sequence_++;
  event.hl_action = controller_ ? controller_->highLevelAction() : std::string();
  event.narration = std::move(narration);
  parts_.observer.onEvent(event);
}

void BeliefMission::reportBelief()
{
  ReportedBelief belief;
  belief.hl_action = controller_->highLevelAction();
  belief.fluents = belief_->marginals();
  belief.summary = belief_->summary();
  parts_.observer.onBelief(belief);
}

void BeliefMission::publish(const std::string& ll_action)
{
  parts_.observer.onSnapshot({state_, ll_action, knowledge_.history, {}, {}});
}

void BeliefMission::note(const Input& input)
{
  parts_.observer.onInput(input);
}

void BeliefMission::noteDecision(const std::string& kind, const std::string& detail)
{
  ReportedDecision decision;
  decision.sequence = num_decisions_++;
  decision.kind = kind;
  decision.details = {detail};
  parts_.observer.onDecision(decision);
}

}  // namespace kr3::executive
