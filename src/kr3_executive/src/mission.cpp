#include "kr3_executive/mission.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace kr3::executive
{
namespace
{

constexpr double kMoreLikelyThanNot = 0.5;

std::string attemptKey(const std::string& action, const std::vector<std::string>& hypothesis)
{
  std::string key = action;
  for (const auto& literal : hypothesis)
    key += " | " + literal;
  return key;
}

std::string firstAction(const reasoner::Plan& plan)
{
  return plan.steps.empty() || plan.steps.front().empty() ? std::string() : plan.steps.front()[0];
}

/// A record needs a confidence in (0, 1]; a belief of 1 is a belief, so it stays below certainty.
double confidenceOf(double belief)
{
  return std::clamp(belief, 0.001, 0.999);
}

const Refutation* strongest(const Assessment& assessment)
{
  const auto& all = assessment.refutations;
  const auto best = std::max_element(all.begin(), all.end(), [](const auto& a, const auto& b) {
    return a.probability < b.probability;
  });
  return best == all.end() ? nullptr : &*best;
}

ActionResult resultOf(const Assessment& assessment, double threshold)
{
  if (assessment.achieved > threshold)
    return ActionResult::kAchieved;
  const Refutation* refutation = strongest(assessment);
  if (refutation != nullptr && refutation->probability > threshold)
    return ActionResult::kRefuted;
  return assessment.changed.empty() ? ActionResult::kUnresolved : ActionResult::kDisplaced;
}

Transition finish(State state, Finish outcome)
{
  state.phase = Phase::kFinished;
  state.outcome = outcome;
  return {std::move(state), std::move(outcome)};
}

Transition cancelled(State state)
{
  return finish(std::move(state), {ErrorCode::kCancelled, false, "cancelled"});
}

Transition requestPlan(State state)
{
  state.phase = Phase::kPlanning;
  return {std::move(state), RequestPlan{}};
}

/// Lines 8-11: the next action of the plan, unless a limit ends the mission.
Transition startAction(State state)
{
  if (state.hl_actions_done >= state.limits.max_hl_actions)
  {
    return finish(std::move(state), {ErrorCode::kOk, false,
                                     "limit of " + std::to_string(state.limits.max_hl_actions) +
                                         " high-level actions reached"});
  }
  state.phase = Phase::kPreparing;
  state.ll_actions_here = 0;
  state.rebuilds = 0;
  state.assessment = {};
  std::string action = state.currentAction();
  return {std::move(state), RequestPolicy{std::move(action), false}};
}

/// Belief that counts as knowledge. A policy that gave up below the threshold, and has nothing
/// better to do when it is asked again, will never get there: then the belief that its looking left
/// counts, if it says more than a coin, with its own confidence.
double thresholdFor(const State& state)
{
  const bool nothing_new = state.ll_actions_here == 0 && state.assessment.remembered;
  return nothing_new ? kMoreLikelyThanNot : state.limits.threshold;
}

/// Line 16: the action is over, completed or not achievable.
Transition endAction(State state)
{
  const std::string action = state.currentAction();
  const double threshold = thresholdFor(state);
  const ActionResult result = resultOf(state.assessment, threshold);
  state.last_result = result;
  ++state.hl_actions_done;
  if (result != ActionResult::kAchieved)
    ++state.failures[attemptKey(action, state.plan->plan.hypothesis)];
  AddRecords decision{recordsOf(action, state.step, result, state.assessment, threshold)};
  state.phase = Phase::kRecording;
  return {std::move(state), std::move(decision)};
}

/// Line 12: go on while the action is neither completed nor known to be unachievable.
Transition continueAction(State state)
{
  const ActionResult result = resultOf(state.assessment, state.limits.threshold);
  if (result != ActionResult::kUnresolved || state.ll_actions_here >= state.limits.max_ll_actions)
  {
    return endAction(std::move(state));
  }
  state.phase = Phase::kExecuting;
  return {std::move(state), ExecutePolicyAction{}};
}

Transition reopen(State state, const std::string& why)
{
  if (state.reopened >= state.limits.max_reopened)
    return finish(std::move(state), {ErrorCode::kOk, false, why});
  ++state.reopened;
  state.plan.reset();
  state.outcome = Finish{ErrorCode::kOk, false, why};  // should there be nothing to take back
  state.phase = Phase::kReopening;
  return {std::move(state), ReopenRefutation{}};
}

Transition onGoal(const State& state, const GoalGiven& event)
{
  if (state.phase != Phase::kIdle && state.phase != Phase::kFinished)
    return {state, Wait{}};
  State next;
  next.goal = event.goal;  // line 2
  next.limits = event.limits;
  next.step = event.step;
  if (event.records.empty())
    return requestPlan(std::move(next));
  next.phase = Phase::kReporting;  // line 1
  return {std::move(next), AddRecords{event.records}};
}

Transition onPlan(State state, const PlanReady& event)
{
  if (event.goal_entailed)
    return finish(std::move(state), {ErrorCode::kOk, true, "the history entails the goal"});
  // Line 20: what is left of the plan is valid when it is still one of the shortest ones.
  if (state.plan && state.last_result == ActionResult::kAchieved)
  {
    const auto& steps = state.plan->plan.steps;
    const std::vector<std::vector<std::string>> rest(
        steps.begin() + static_cast<std::ptrdiff_t>(std::min(state.plan_index, steps.size())),
        steps.end());
    const bool valid =
        !rest.empty() && std::any_of(event.plans.begin(), event.plans.end(),
                                     [&](const auto& plan) { return plan.plan.steps == rest; });
    if (valid)
      return startAction(std::move(state));
  }
  // Lines 4-6: the lowest expected cost wins, among plans that are not known to lead nowhere.
  const CostedPlan* best = nullptr;
  bool exhausted = false;
  for (const auto& candidate : event.plans)
  {
    const auto failed =
        state.failures.find(attemptKey(firstAction(candidate.plan), candidate.plan.hypothesis));
    if (failed != state.failures.end() && failed->second >= state.limits.max_attempts)
      exhausted = true;
    else if (best == nullptr || candidate.cost_s < best->cost_s)
      best = &candidate;
  }
  if (best == nullptr)
  {
    return reopen(std::move(state), exhausted ? "every plan left was tried " +
                                                    std::to_string(state.limits.max_attempts) +
                                                    " times without result"
                                              : "no plan is left: " + event.reason);
  }
  state.plan = *best;
  state.plan_index = 0;
  return startAction(std::move(state));
}

Transition onRecords(State state, const RecordsAdded& event)
{
  const bool after_action = state.phase == Phase::kRecording;
  state.step = event.step;
  if (state.cancelling)
    return cancelled(std::move(state));
  if (event.unexpected)  // lines 17-19
  {
    if (after_action && state.last_result == ActionResult::kAchieved)
      ++state.plan_index;
    state.phase = Phase::kDiagnosing;
    return {std::move(state), RequestDiagnosis{}};
  }
  if (after_action && state.last_result == ActionResult::kAchieved)
  {
    ++state.plan_index;
    if (state.plan_index < state.plan->plan.steps.size())
      return startAction(std::move(state));
  }
  return requestPlan(std::move(state));
}

/// A fact arrives: the action under way ends with what is known, then the fact is recorded.
Transition onTold(State state, const Told& event)
{
  std::vector<reasoner::Record> records;
  if (state.phase == Phase::kExecuting || state.phase == Phase::kPreparing)
  {
    Transition ended = endAction(std::move(state));
    state = std::move(ended.state);
    records = std::move(std::get<AddRecords>(ended.decision).records);
    // Interrupted is not failed: it may be tried again as often as before.
    if (state.last_result != ActionResult::kAchieved)
      --state.failures[attemptKey(state.currentAction(), state.plan->plan.hypothesis)];
  }
  else if (state.phase != Phase::kIdle && state.phase != Phase::kFinished)
  {
    return {std::move(state), Wait{}};  // the driver offers it again in a phase that can take it
  }
  reasoner::Record record = event.record;
  record.step = state.step;
  for (const auto& earlier : records)
  {
    const bool acts = earlier.kind == reasoner::RecordKind::kHappened ||
                      earlier.kind == reasoner::RecordKind::kAttempted;
    record.step = std::max(record.step, earlier.step + (acts ? 1 : 0));
  }
  records.push_back(std::move(record));
  return {std::move(state), AddRecords{std::move(records)}};
}

Transition onCancel(State state)
{
  switch (state.phase)
  {
    case Phase::kIdle:
    case Phase::kFinished:
      return {std::move(state), Wait{}};
    case Phase::kExecuting:
      if (state.ll_actions_here == 0)
        return cancelled(std::move(state));
      state.cancelling = true;  // what the robot did is recorded first
      return endAction(std::move(state));
    case Phase::kReporting:
    case Phase::kRecording:
      state.cancelling = true;
      return {std::move(state), Wait{}};
    default:
      return cancelled(std::move(state));
  }
}

bool isOneOf(Phase phase, std::initializer_list<Phase> phases)
{
  return std::find(phases.begin(), phases.end(), phase) != phases.end();
}

struct Stepper
{
  const State& state;

  Transition operator()(const GoalGiven& event) const { return onGoal(state, event); }
  Transition operator()(const RecordsAdded& event) const
  {
    if (!isOneOf(state.phase, {Phase::kReporting, Phase::kRecording}))
    {
      State next = state;  // told while idle
      next.step = event.step;
      return {std::move(next), Wait{}};
    }
    return onRecords(state, event);
  }
  Transition operator()(const PlanReady& event) const
  {
    return state.phase == Phase::kPlanning ? onPlan(state, event) : ignored();
  }
  Transition operator()(const PolicyReady& event) const
  {
    if (state.phase != Phase::kPreparing)
      return ignored();
    State next = state;
    next.assessment = event.assessment;
    next.phase = Phase::kExecuting;
    // The first look is never skipped: a belief that was only assumed is no observation.
    return {std::move(next), ExecutePolicyAction{}};
  }
  Transition operator()(const ActionExecuted& event) const
  {
    if (state.phase != Phase::kExecuting)
      return ignored();
    State next = state;
    ++next.ll_actions_done;
    ++next.ll_actions_here;
    next.assessment = event.assessment;
    return continueAction(std::move(next));  // lines 12-15
  }
  Transition operator()(const PolicyFinished& event) const
  {
    if (state.phase != Phase::kExecuting)
      return ignored();
    State next = state;
    next.assessment = event.assessment;
    return endAction(std::move(next));
  }
  Transition operator()(const TaskLost&) const
  {
    if (state.phase != Phase::kExecuting)
      return ignored();
    State next = state;
    ++next.ll_actions_done;
    ++next.ll_actions_here;
    if (++next.rebuilds > next.limits.max_rebuilds)
      return endAction(std::move(next));
    next.phase = Phase::kPreparing;
    std::string action = next.currentAction();
    return {std::move(next), RequestPolicy{std::move(action), true}};
  }
  Transition operator()(const ActionImpossible&) const
  {
    if (state.phase != Phase::kPreparing)
      return ignored();
    State next = state;
    ++next.hl_actions_done;  // so that this ends too
    ++next.failures[attemptKey(next.currentAction(), next.plan->plan.hypothesis)];
    next.last_result = ActionResult::kUnresolved;
    return requestPlan(std::move(next));  // line 20: the plan is invalid
  }
  Transition operator()(const DiagnosisReady& event) const
  {
    if (state.phase != Phase::kDiagnosing)
      return ignored();
    if (!event.consistent)
      return reopen(state, "the history is inconsistent");
    return requestPlan(state);  // lines 20-22
  }
  Transition operator()(const RefutationReopened& event) const
  {
    if (state.phase != Phase::kReopening)
      return ignored();
    State next = state;
    const Finish otherwise =
        next.outcome.value_or(Finish{ErrorCode::kOk, false, "no plan is left"});
    next.outcome.reset();
    if (!event.found)
      return finish(std::move(next), otherwise);
    next.failures.clear();
    return requestPlan(std::move(next));
  }
  Transition operator()(const Told& event) const { return onTold(state, event); }
  Transition operator()(const CancelRequested&) const { return onCancel(state); }
  Transition operator()(const RequestFailed& event) const
  {
    if (isOneOf(state.phase, {Phase::kIdle, Phase::kFinished}))
      return ignored();
    return finish(state, {event.code, false, event.message});
  }

  [[nodiscard]] Transition ignored() const { return {state, Wait{}}; }
};

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

std::string State::currentAction() const
{
  if (!plan || plan_index >= plan->plan.steps.size() || plan->plan.steps[plan_index].empty())
    return {};
  return plan->plan.steps[plan_index].front();
}

std::vector<reasoner::Record> recordsOf(const std::string& action, int step, ActionResult result,
                                        const Assessment& assessment, double threshold)
{
  using reasoner::Record;
  using reasoner::RecordKind;
  std::vector<Record> records;
  if (result == ActionResult::kAchieved)
  {
    records.push_back({RecordKind::kHappened, action, true, step, 1.0, "robot"});
    for (const auto& effect : assessment.effects)
    {
      records.push_back({RecordKind::kObserved, effect, true, step + 1,
                         confidenceOf(assessment.achieved), "robot"});
    }
    return records;
  }
  for (const auto& refutation : assessment.refutations)
  {
    if (refutation.probability > threshold)
    {
      records.push_back({RecordKind::kObserved, refutation.literal, false, step,
                         confidenceOf(refutation.probability), "robot"});
    }
  }
  if (!assessment.changed.empty())
  {
    records.push_back(
        assessment.happened
            ? Record{RecordKind::kHappened, *assessment.happened, true, step, 1.0, "robot"}
            : Record{RecordKind::kAttempted, action, true, step, 1.0, "robot"});
    for (const auto& literal : assessment.changed)
      records.push_back({RecordKind::kObserved, literal, true, step + 1, 1.0, "robot"});
  }
  else if (assessment.attempted)
  {
    records.push_back({RecordKind::kAttempted, action, true, step, 1.0, "robot"});
    // Of several effects it is not known which one failed; a single one is known to have failed.
    if (assessment.effects.size() == 1 && 1.0 - assessment.achieved > threshold)
    {
      records.push_back({RecordKind::kObserved, assessment.effects.front(), false, step + 1,
                         confidenceOf(1.0 - assessment.achieved), "robot"});
    }
  }
  return records;
}

Transition step(const State& state, const Event& event)
{
  return std::visit(Stepper{state}, event);
}

}  // namespace kr3::executive
