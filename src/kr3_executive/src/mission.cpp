#include "kr3_executive/mission.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace kr3::executive
{
namespace
{

constexpr double kMoreLikelyThanNot = 0.5;

std::string firstAction(const reasoner::Plan& plan)
{
  return plan.steps.empty() || plan.steps.front().empty() ? std::string() : plan.steps.front()[0];
}

const Refutation* strongest(const Assessment& assessment)
{
  const auto& all = assessment.refutations;
  const auto best = std::max_element(all.begin(), all.end(), [](const auto& a, const auto& b) {
    return a.probability < b.probability;
  });
  return best == all.end() ? nullptr : &*best;
}

/// A sighting contradicts what the plan rests on.
bool overturned(const Assessment& assessment)
{
  return std::any_of(assessment.noticed.begin(), assessment.noticed.end(),
                     [](const auto& noticed) { return noticed.overturns; });
}

/// How the action stands. What is achieved has to be believed above the threshold always.
///
/// @param least  belief that refutes an assumption
ActionResult resultOf(const Assessment& assessment, double threshold, double least)
{
  if (assessment.denied)
    return ActionResult::kDisplaced;
  if (assessment.achieved > threshold)
    return ActionResult::kAchieved;
  const Refutation* refutation = strongest(assessment);
  if (refutation != nullptr && refutation->probability > least)
    return ActionResult::kRefuted;
  return assessment.changed.empty() && !overturned(assessment) ? ActionResult::kUnresolved
                                                               : ActionResult::kDisplaced;
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
  state.replan = false;
  const bool alternatives = state.alternatives;
  return {std::move(state), RequestPlan{alternatives}};
}

std::string keyOfCurrent(const State& state)
{
  return attemptKey(state.currentAction(), state.plan->plan.hypothesis, state.situation);
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
  state.situation.clear();
  std::string action = state.currentAction();
  return {std::move(state), RequestPolicy{std::move(action), false}};
}

/// Belief above which an assumption counts as refuted. A policy that gave up below the threshold,
/// and has nothing better to do when it is asked again with the belief it left, will never get
/// there: another look is not worth its time to it. Then that belief counts, if it says more than a
/// coin, and the record carries it as its confidence.
double leastRefutation(const State& state)
{
  const bool nothing_new = state.ll_actions_here == 0 && state.assessment.remembered;
  return nothing_new ? kMoreLikelyThanNot : state.limits.threshold;
}

/// Line 16: the action is over, completed or not achievable.
Transition endAction(State state)
{
  const std::string action = state.currentAction();
  const double least = leastRefutation(state);
  const ActionResult result = resultOf(state.assessment, state.limits.threshold, least);
  state.last_result = result;
  state.replan = overturned(state.assessment);
  ++state.hl_actions_done;
  if (result != ActionResult::kAchieved)
    ++state.failures[keyOfCurrent(state)];
  // What was refuted or is otherwise is planned for anew; what came to nothing needs another way.
  state.alternatives = state.alternatives || result == ActionResult::kUnresolved;
  AddRecords decision{recordsOf(action, state.step, result, state.assessment, least)};
  state.phase = Phase::kRecording;
  return {std::move(state), std::move(decision)};
}

/// Line 12: go on while the action is neither completed nor known to be unachievable.
Transition continueAction(State state)
{
  const double threshold = state.limits.threshold;
  const ActionResult result = resultOf(state.assessment, threshold, threshold);
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

std::uint32_t failuresOf(const State& state, const CostedPlan& candidate)
{
  return state.failuresOf(firstAction(candidate.plan), candidate.plan.hypothesis,
                          candidate.situation);
}

bool isImpossible(const State& state, const CostedPlan& candidate)
{
  return state.impossible.count(attemptKey(firstAction(candidate.plan), candidate.plan.hypothesis,
                                           candidate.situation)) > 0;
}

/// Its first action was not tried in vain as often as is allowed, and may be possible.
bool isOpen(const State& state, const CostedPlan& candidate)
{
  return failuresOf(state, candidate) < state.limits.max_attempts &&
         !isImpossible(state, candidate);
}

std::string whyNoneIsLeft(const State& state, const PlanReady& event)
{
  const auto failed = [&](const CostedPlan& candidate) {
    return failuresOf(state, candidate) >= state.limits.max_attempts;
  };
  if (std::any_of(event.plans.begin(), event.plans.end(), failed))
  {
    return "every plan left was tried " + std::to_string(state.limits.max_attempts) +
           " times without result";
  }
  if (!event.plans.empty())
    return "every plan left begins with an action that is impossible in what is known";
  return "no plan is left: " + event.reason;
}

bool everyOneLeftIsRefuted(const State& state, const std::vector<CostedPlan>& plans)
{
  return std::all_of(plans.begin(), plans.end(), [&](const CostedPlan& candidate) {
    return candidate.refuted || !isOpen(state, candidate);
  });
}

/// Lines 4-6: the lowest expected cost wins, among plans that are not known to lead nowhere. When
/// the best one begins with what was tried in vain, another one of its hypothesis is taken if there
/// is one (lines 20-22), and ways round only when nothing else is left.
///
/// @return null when none is left
const CostedPlan* choose(const State& state, const std::vector<CostedPlan>& plans)
{
  const auto cheapest = [&plans](const auto& admits) {
    const CostedPlan* best = nullptr;
    for (const auto& candidate : plans)
    {
      if (admits(candidate) && (best == nullptr || candidate.cost_s < best->cost_s))
        best = &candidate;
    }
    return best;
  };
  const CostedPlan* best = cheapest(
      [&](const CostedPlan& candidate) { return !candidate.detour && isOpen(state, candidate); });
  if (best == nullptr && state.detours < state.limits.max_detours)
  {
    return cheapest(
        [&](const CostedPlan& candidate) { return candidate.detour && isOpen(state, candidate); });
  }
  if (best == nullptr || failuresOf(state, *best) == 0)
    return best;
  const CostedPlan* untried = cheapest([&](const CostedPlan& candidate) {
    return !candidate.detour && candidate.plan.hypothesis == best->plan.hypothesis &&
           failuresOf(state, candidate) == 0 && !isImpossible(state, candidate);
  });
  return untried == nullptr ? best : untried;
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
  const CostedPlan* chosen = choose(state, event.plans);
  if (chosen == nullptr)
    return reopen(std::move(state), whyNoneIsLeft(state, event));
  if (everyOneLeftIsRefuted(state, event.plans))
  {
    return reopen(std::move(state),
                  "everything that the goal may rest on was looked for in vain; " +
                      std::to_string(state.reopened) + " refutations were taken back");
  }
  state.detours += chosen->detour ? 1 : 0;
  state.plan = *chosen;
  state.plan_index = 0;
  return startAction(std::move(state));
}

Transition onRecords(State state, const RecordsAdded& event)
{
  const bool after_action = state.phase == Phase::kRecording;
  state.step = event.step;
  state.impossible.clear();
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
    if (!state.replan && state.plan_index < state.plan->plan.steps.size())
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
      --state.failures[keyOfCurrent(state)];
  }
  else if (state.phase != Phase::kIdle && state.phase != Phase::kFinished)
  {
    return {std::move(state), Wait{}};  // the driver offers it again in a phase that can take it
  }
  state.replan = true;  // whatever is left of the plan: another one may be better now
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
    next.situation = event.situation;
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
  Transition operator()(const TaskLost& event) const
  {
    if (state.phase != Phase::kExecuting)
      return ignored();
    State next = state;
    ++next.ll_actions_done;
    ++next.ll_actions_here;
    next.assessment = event.assessment;
    if (++next.rebuilds > next.limits.max_rebuilds)
      return endAction(std::move(next));
    next.phase = Phase::kPreparing;
    std::string action = next.currentAction();
    return {std::move(next), RequestPolicy{std::move(action), true}};
  }
  Transition operator()(const ActionImpossible& event) const
  {
    if (state.phase != Phase::kPreparing)
      return ignored();
    State next = state;
    ++next.hl_actions_done;  // so that this ends too
    next.situation = event.situation;
    next.alternatives = true;
    ++next.failures[keyOfCurrent(next)];
    next.impossible.insert(keyOfCurrent(next));
    next.last_result = ActionResult::kUnresolved;
    return requestPlan(std::move(next));  // line 20: the plan is invalid
  }
  Transition operator()(const DiagnosisReady& event) const
  {
    if (state.phase != Phase::kDiagnosing)
      return ignored();
    if (!event.consistent)
      return reopen(state, "the history is inconsistent; " + std::to_string(state.reopened) +
                               " times the least certain records were taken back");
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
    next.impossible.clear();
    next.alternatives = false;
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

std::string State::currentAction() const
{
  if (!plan || plan_index >= plan->plan.steps.size() || plan->plan.steps[plan_index].empty())
    return {};
  return plan->plan.steps[plan_index].front();
}

std::uint32_t State::failuresOf(const std::string& action,
                                const std::vector<std::string>& hypothesis,
                                const std::string& where) const
{
  const auto found = failures.find(attemptKey(action, hypothesis, where));
  return found == failures.end() ? 0 : found->second;
}

std::string attemptKey(const std::string& action, const std::vector<std::string>& hypothesis,
                       const std::string& situation)
{
  std::string key = action;
  for (const auto& literal : hypothesis)
    key += " | " + literal;
  return situation.empty() ? key : key + " where " + situation;
}

Transition step(const State& state, const Event& event)
{
  return std::visit(Stepper{state}, event);
}

}  // namespace kr3::executive
