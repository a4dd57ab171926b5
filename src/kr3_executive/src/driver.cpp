#include "kr3_executive/driver.hpp"

#include <algorithm>
#include <utility>

namespace kr3::executive
{
MissionDriver::MissionDriver(const refinement::LowLevelDomain& domain,
                             const refinement::Models& models, const Narrator& narrator,
                             HighLevelReasoner& reasoner, PolicyServer& policies,
                             LowLevelExecutor& executor, MissionObserver& observer, Clock clock,
                             DriverConfig config, std::shared_ptr<PlanCosts> costs)
  : domain_(domain)
  , narrator_(narrator)
  , reasoner_(reasoner)
  , policies_(policies)
  , executor_(executor)
  , observer_(observer)
  , interest_(observer.interest())
  , clock_(std::move(clock))
  , config_(std::move(config))
  , high_level_laws_(domain.highLevel())
  , costs_(costs ? std::move(costs)
                 : std::make_shared<PlanCosts>(std::make_shared<TaskCache>(domain, models)))
  , literals_(domain.highLevel())
{
}

void MissionDriver::setKnowledge(Knowledge knowledge)
{
  const std::lock_guard<std::mutex> lock(mission_mutex_);
  reasoner_.setHistory(knowledge.history);
  forgetAnswers();
  knowledge_ = std::move(knowledge);
}

MissionResult MissionDriver::achieve(const std::string& goal,
                                     const std::vector<reasoner::Record>& initial,
                                     const Limits& limits, double time_limit_s)
{
  const std::lock_guard<std::mutex> lock(mission_mutex_);
  static_cast<void>(reasoner::parseGoal(goal, domain_.highLevel()));
  cancel_ = false;
  sequence_ = 0;
  num_decisions_ = 0;
  task_.reset();
  surprises_.clear();
  surprised_fluents_.clear();
  given_up_.clear();
  surprises_without_.clear();
  const double start_s = clock_();
  deadline_s_.reset();
  if (time_limit_s > 0.0)
    deadline_s_ = start_s + time_limit_s;

  if (state_.phase != Phase::kIdle)
    state_ = {};
  std::optional<ReasonerSettings> settings;
  int summed_up = 0;
  try
  {
    settings = reasoner_.settings();
    summed_up = sumUpHistory();
  }
  catch (const Error& e)  // the reasoner does not answer
  {
    return {e.code(), false, e.what()};
  }
  GoalGiven given{goal, limits, {}, currentStep(knowledge_.history)};
  if (knowledge_.history.empty())
    given.records = initial;
  running_ = true;
  if (interest_.log)
    note(MissionBegun{goal, initial, limits, time_limit_s, config_, knowledge_, settings});
  apply(given);
  if (summed_up > 0)
    report(EventKind::kRecord,
           [&] { return narrator_.summedUp(summed_up, knowledge_.history.size()); });
  while (state_.phase != Phase::kFinished)
  {
    std::optional<Event> event = interruption();
    try
    {
      if (!event)
        event = perform(decision_);
    }
    catch (const Cancelled&)
    {
      note(MissionCancelled{});
      event = CancelRequested{};
    }
    catch (const Error& e)
    {
      note(RequestRefused{e.code(), e.what()});
      event = RequestFailed{e.code(), e.what()};
    }
    catch (const std::exception& e)
    {
      note(RequestRefused{ErrorCode::kInternal, e.what()});
      event = RequestFailed{ErrorCode::kInternal, e.what()};
    }
    ll_action_.clear();  // also when it was cancelled or failed
    apply(*event);
  }
  running_ = false;
  takeInTold();
  const Finish& outcome = *state_.outcome;
  return {outcome.code,           outcome.achieved,       outcome.reason,
          state_.hl_actions_done, state_.ll_actions_done, clock_() - start_s};
}

std::optional<Event> MissionDriver::interruption()
{
  if (state_.cancelling)
    return std::nullopt;
  const bool recording = std::holds_alternative<AddRecords>(decision_);
  if (cancel_ && !recording)  // records that were decided on are true, whoever cancels
  {
    note(MissionCancelled{});
    return CancelRequested{};
  }
  if (deadline_s_ && clock_() > *deadline_s_ && !recording)
  {
    note(TimeExpired{});
    return RequestFailed{ErrorCode::kDeadlineExceeded, "the time allowed for the mission ran out"};
  }
  if (state_.phase == Phase::kExecuting || state_.phase == Phase::kPreparing)
  {
    std::optional<Told> told;
    {
      const std::lock_guard<std::mutex> lock(told_mutex_);
      if (!told_.empty())
      {
        told = Told{told_.front()};
        told_.erase(told_.begin());
      }
    }
    if (told)
    {
      note(FactTold{told->record, true});
      return *told;
    }
  }
  return std::nullopt;
}

void MissionDriver::apply(const Event& event)
{
  const std::string replaced = state_.currentAction();
  const bool had_plan = state_.plan.has_value();
  Transition transition = step(state_, event);
  const Phase phase = transition.state.phase;
  if (std::holds_alternative<Wait>(transition.decision) && phase != Phase::kFinished)
  {
    state_ = std::move(transition.state);  // the pending decision stays
    return;
  }
  state_ = std::move(transition.state);
  decision_ = std::move(transition.decision);
  note([this] { return reported(decision_, state_); });

  if (std::holds_alternative<GoalGiven>(event))
    report(EventKind::kGoal, [this] { return narrator_.goal(state_.goal); });
  if (const auto* plans = std::get_if<PlanReady>(&event); plans != nullptr && state_.plan)
  {
    if (state_.plan_index == 0 && phase == Phase::kPreparing)
    {
      report(EventKind::kPlan, [&] { return narrator_.plan(*state_.plan, plans->plans.size()); });
    }
  }
  if (std::holds_alternative<RequestPlan>(decision_) && had_plan && !replaced.empty() &&
      state_.last_result != ActionResult::kAchieved)
  {
    report(EventKind::kReplan,
           [&] { return narrator_.replan(replaced + " was " + toString(state_.last_result)); });
  }
  if (const auto* request = std::get_if<RequestPolicy>(&decision_);
      request != nullptr && !request->rebuild)
  {
    report(EventKind::kHighLevelAction,
           [&] { return narrator_.highLevelAction(request->action, state_.step); });
  }
  if (const auto* finish = std::get_if<Finish>(&decision_))
  {
    const EventKind kind = finish->achieved                        ? EventKind::kDone
                           : finish->code == ErrorCode::kCancelled ? EventKind::kCancelled
                                                                   : EventKind::kFailed;
    report(kind, [&] { return narrator_.end(*finish, state_); });
  }
  publish();
}

Event MissionDriver::perform(const Decision& decision)
{
  if (const auto* request = std::get_if<RequestPlan>(&decision))
    return performPlan(*request);
  if (const auto* request = std::get_if<RequestPolicy>(&decision))
    return performPolicy(*request);
  if (std::holds_alternative<ExecutePolicyAction>(decision))
    return performAction();
  if (const auto* request = std::get_if<AddRecords>(&decision))
    return performRecords(request->records);
  if (std::holds_alternative<RequestDiagnosis>(decision))
    return performDiagnosis();
  if (std::holds_alternative<ReopenRefutation>(decision))
    return performReopen();
  throw InternalError("the mission waits for nothing");
}

void MissionDriver::note(const Input& input)
{
  if (interest_.log)
    observer_.onInput(input);
}

void MissionDriver::note(const std::function<ReportedDecision()>& decision)
{
  if (!interest_.log)
    return;
  ReportedDecision reported = decision();
  reported.sequence = num_decisions_++;
  observer_.onDecision(reported);
}

}  // namespace kr3::executive
