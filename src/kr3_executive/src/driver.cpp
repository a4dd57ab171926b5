#include "kr3_executive/driver.hpp"

#include <algorithm>
#include <utility>

#include "literal_text.hpp"

namespace kr3::executive
{
namespace
{

/// Actions that occur together are executed one after the other.
reasoner::Plan serialised(const reasoner::Plan& plan)
{
  reasoner::Plan flat{plan.hypothesis, {}};
  for (const auto& together : plan.steps)
  {
    for (const auto& action : together)
      flat.steps.push_back({action});
  }
  return flat;
}

/// Whether a record that a statement has a truth value settles that a literal holds.
bool settles(const LiteralText& statement, bool value, const LiteralText& literal)
{
  if (statement.fluent() != literal.fluent() || !statement.equal || !literal.equal)
    return false;
  if (!literal.isBoolean())
    return value && statement.value == literal.value;
  return (statement.value == "true") == value ? literal.value == "true" : literal.value == "false";
}

}  // namespace

MissionDriver::MissionDriver(const refinement::LowLevelDomain& domain,
                             const refinement::Models& models, const Narrator& narrator,
                             HighLevelReasoner& reasoner, PolicyServer& policies,
                             LowLevelExecutor& executor, MissionObserver& observer, Clock clock,
                             DriverConfig config)
  : domain_(domain)
  , models_(models)
  , narrator_(narrator)
  , reasoner_(reasoner)
  , policies_(policies)
  , executor_(executor)
  , observer_(observer)
  , clock_(std::move(clock))
  , config_(std::move(config))
  , high_level_laws_(domain.highLevel())
{
}

void MissionDriver::setKnowledge(Knowledge knowledge)
{
  const std::lock_guard<std::mutex> lock(mission_mutex_);
  reasoner_.setHistory(knowledge.history);
  supports_.clear();
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
  const double start_s = clock_();
  deadline_s_.reset();
  if (time_limit_s > 0.0)
    deadline_s_ = start_s + time_limit_s;

  if (state_.phase != Phase::kIdle)
    state_ = {};
  GoalGiven given{goal, limits, {}, currentStep(knowledge_.history)};
  if (knowledge_.history.empty())
    given.records = initial;
  running_ = true;
  note(MissionBegun{goal, initial, limits, time_limit_s, config_, knowledge_});
  apply(given);
  while (state_.phase != Phase::kFinished)
  {
    std::optional<Event> event = interruption();
    ll_action_.clear();
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
  note(reported(decision_, state_));

  if (std::holds_alternative<GoalGiven>(event))
    report(EventKind::kGoal, narrator_.goal(state_.goal));
  if (const auto* plans = std::get_if<PlanReady>(&event); plans != nullptr && state_.plan)
  {
    if (state_.plan_index == 0 && phase == Phase::kPreparing)
      report(EventKind::kPlan, narrator_.plan(*state_.plan, plans->plans.size()));
  }
  if (std::holds_alternative<RequestPlan>(decision_) && had_plan && !replaced.empty() &&
      state_.last_result != ActionResult::kAchieved)
  {
    report(EventKind::kReplan, narrator_.replan(replaced + " was " + toString(state_.last_result)));
  }
  if (const auto* request = std::get_if<RequestPolicy>(&decision_);
      request != nullptr && !request->rebuild)
    report(EventKind::kHighLevelAction, narrator_.highLevelAction(request->action, state_.step));
  if (const auto* finish = std::get_if<Finish>(&decision_))
  {
    const EventKind kind = finish->achieved                        ? EventKind::kDone
                           : finish->code == ErrorCode::kCancelled ? EventKind::kCancelled
                                                                   : EventKind::kFailed;
    report(kind, narrator_.end(*finish, state_));
  }
  publish();
}

Event MissionDriver::perform(const Decision& decision)
{
  if (std::holds_alternative<RequestPlan>(decision))
    return performPlan();
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

Event MissionDriver::performPlan()
{
  const reasoner::PlanResult result = reasoner_.plan(state_.goal, cancel_);
  PlanReady event{result.goal_entailed, {}, result.reason};
  if (result.goal_entailed || result.plans.empty())
  {
    note(reported(event.plans));
    return event;
  }
  const std::vector<reasoner::Literal> known = believedState({});
  for (const auto& found : result.plans)
  {
    CostedPlan plan{serialised(found), 0.0};
    std::vector<reasoner::Literal> state = known;
    for (const auto& literal : plan.plan.hypothesis)
      state.push_back(reasoner::parseGroundLiteral(literal, domain_.highLevel()));
    if (result.plans.size() > 1)
      plan.cost_s = refinement::estimatedCost(domain_, models_, state, plan.plan.steps);
    event.plans.push_back(std::move(plan));
  }
  note(reported(event.plans));
  return event;
}

std::vector<reasoner::Literal> MissionDriver::believedState(
    const std::vector<std::string>& hypothesis)
{
  std::vector<reasoner::Literal> state;
  std::vector<std::string> settled;
  for (const auto& text : reasoner_.entailedAt(state_.step))
  {
    reasoner::Literal literal = reasoner::parseGroundLiteral(text, domain_.highLevel());
    if (!literal.equal)
      continue;
    settled.push_back(reasoner::toString(literal.atom));
    state.push_back(std::move(literal));
  }
  for (const auto& text : hypothesis)
  {
    reasoner::Literal literal = reasoner::parseGroundLiteral(text, domain_.highLevel());
    if (std::find(settled.begin(), settled.end(), reasoner::toString(literal.atom)) ==
        settled.end())
      state.push_back(std::move(literal));
  }
  return state;
}

Support MissionDriver::supportOf(const std::string& literal)
{
  return supportOf(literal, state_.step);
}

Support MissionDriver::supportOf(const std::string& literal, int step)
{
  const auto known = supports_.find({literal, step});
  if (known != supports_.end())
    return known->second;
  Support support = findSupport(literal, step);
  supports_[{literal, step}] = support;
  return support;
}

Support MissionDriver::findSupport(const std::string& literal, int step)
{
  if (reasoner_.entails(literal, step) != reasoner::Answer::kTrue)
  {
    // A hypothesis, one of those that are left.
    const LiteralText parts = takeApart(literal);
    const auto* fluent = domain_.highLevel().findFluent(parts.symbol);
    std::size_t open = 0;
    if (fluent != nullptr && fluent->value_sort)
    {
      for (const auto& value : domain_.highLevel().findSort(*fluent->value_sort)->elements)
        open += reasoner_.possible(parts.fluent() + " = " + value, step) ? 1 : 0;
    }
    const double share = 1.0 / static_cast<double>(std::max<std::size_t>(open, 2));
    return {std::max(share, config_.least_hypothesis_probability), "assumed"};
  }
  // What was observed last needs no search for reasons.
  const LiteralText asked = takeApart(literal);
  const reasoner::Record* seen = nullptr;
  for (const auto& record : knowledge_.history)
  {
    const bool about = (record.kind == reasoner::RecordKind::kObserved ||
                        record.kind == reasoner::RecordKind::kInitially) &&
                       record.step <= step;
    if (about && settles(takeApart(record.statement), record.value, asked))
      seen = &record;
  }
  if (seen != nullptr)
    return {seen->confidence, "observed at step " + std::to_string(seen->step)};

  const reasoner::Explanation why = reasoner_.explain(literal, step);
  const std::string by_default = narrator_.defaultIn(why);
  if (!by_default.empty())
  {
    expected_by_default_[literal] = by_default;
    return {config_.default_probability, "default " + by_default};
  }
  double probability = 1.0;
  for (const auto& record : knowledge_.history)
  {
    const std::string text = reasoner::toString(record);
    if (std::find(why.records.begin(), why.records.end(), text) != why.records.end())
      probability *= record.confidence;
  }
  return {probability, why.reasons.empty() ? std::string() : why.reasons.back()};
}

Event MissionDriver::performPolicy(const RequestPolicy& request)
{
  try
  {
    task_state_ = believedState(state_.plan->plan.hypothesis);
    const auto zoom = refinement::zoom(
        domain_, task_state_, reasoner::parseGroundAction(request.action, domain_.highLevel()));
    const auto knowledge = initialKnowledge(domain_, zoom, knowledge_.memory,
                                            [this](const std::string& l) { return supportOf(l); });
    task_ = std::make_unique<LowLevelTask>(
        domain_, refinement::generatePomdp(domain_, models_, zoom, knowledge), knowledge);
  }
  catch (const FailedPrecondition& e)
  {
    return ActionImpossible{e.what()};
  }
  const SolvedPolicy policy = solvePolicy(request.action);
  report(EventKind::kPolicy, narrator_.policy(request.action, policy, task_->pomdp()));
  return PolicyReady{task_->assess()};
}

SolvedPolicy MissionDriver::solvePolicy(const std::string& action)
{
  const SolvedPolicy policy = policies_.solve(task_->pomdp().model(), config_.budget, cancel_);
  policy_id_ = policy.id;
  note(reported(action, policy, task_->belief()));
  return policy;
}

Event MissionDriver::performAction()
{
  std::size_t index = 0;
  try
  {
    index = policies_.actionAt(policy_id_, task_->belief());
  }
  catch (const NotFound&)  // the server was restarted: tell it again
  {
    static_cast<void>(solvePolicy(state_.currentAction()));
    index = policies_.actionAt(policy_id_, task_->belief());
  }
  const bool finishes = task_->isFinish(index);
  note(reportedLowLevel(finishes ? std::string() : task_->action(index).text, task_->belief()));
  if (finishes)
    return PolicyFinished{task_->assess()};

  const LowLevelAction action = task_->action(index);
  ll_action_ = action.text;
  publish();
  const LowLevelResult result = execute(action);
  ll_action_.clear();
  const bool explained = task_->update(index, result.observation);
  task_->remember(knowledge_.memory);
  report(EventKind::kLowLevelAction, narrator_.lowLevelAction(action, result, *task_));
  ReportedBelief belief{state_.currentAction(),
                        static_cast<std::uint32_t>(state_.step),
                        {},
                        task_->pomdp().summary(task_->belief())};
  for (const auto& fluent : task_->pomdp().fluents())
    belief.fluents[fluent.name] = task_->pomdp().fineMarginal(task_->belief(), fluent.name);
  observer_.onBelief(belief);
  return afterObservation(action, explained);
}

LowLevelResult MissionDriver::execute(const LowLevelAction& action)
{
  const FluentLookup believed = [this](const std::string& fluent) { return believedValue(fluent); };
  for (std::uint32_t attempt = 0;; ++attempt)
  {
    try
    {
      LowLevelResult result = executor_.execute(action, believed, cancel_);
      note(SkillEnded{action, ErrorCode::kOk, {}, result});
      return result;
    }
    catch (const Error& e)
    {
      note(SkillEnded{action, e.code(), e.what(), {}});
      const bool may_retry =
          e.code() == ErrorCode::kUnavailable || e.code() == ErrorCode::kDeadlineExceeded;
      if (!may_retry || attempt >= config_.max_skill_retries || cancel_)
        throw;
    }
  }
}

void MissionDriver::note(const Input& input)
{
  observer_.onInput(input);
}

void MissionDriver::note(ReportedDecision decision)
{
  decision.sequence = num_decisions_++;
  observer_.onDecision(decision);
}

std::string MissionDriver::believedValue(const std::string& fluent) const
{
  refinement::Distribution values;
  const auto& zoomed = task_->pomdp().fluents();
  if (std::any_of(zoomed.begin(), zoomed.end(), [&](const auto& f) { return f.name == fluent; }))
    values = task_->pomdp().fineMarginal(task_->belief(), fluent);
  else if (const auto found = knowledge_.memory.find(fluent); found != knowledge_.memory.end())
    values = found->second.values;
  const auto most =
      std::max_element(values.begin(), values.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == values.end() || most->first == refinement::kElsewhere ? std::string()
                                                                       : most->first;
}

Event MissionDriver::afterObservation(const LowLevelAction& action, bool explained)
{
  Assessment assessment = task_->assess();
  if (explained)
    return ActionExecuted{action.text, std::move(assessment)};

  // The zoomed model has no place for what was seen: judge by what was observed alone.
  std::vector<std::string> seen;
  for (const auto& [fluent, value] : task_->observed())
  {
    const std::string whole = coarseFluent(domain_, fluent);
    const auto* declared = domain_.highLevel().findFluent(takeApart(whole).symbol);
    if (declared == nullptr || (whole != fluent && value == "false"))
      continue;  // a part that is not so says nothing about its whole
    if (declared->value_sort)
      seen.push_back(whole + " = " + domain_.coarse(value));
    else
      seen.push_back(value == "true" ? whole : "-" + whole);
  }
  const auto isSeen = [&](const std::string& literal) {
    return std::find(seen.begin(), seen.end(), literal) != seen.end();
  };
  if (!assessment.effects.empty() &&
      std::all_of(assessment.effects.begin(), assessment.effects.end(), isSeen))
  {
    assessment.achieved = 1.0;
    return ActionExecuted{action.text, std::move(assessment)};
  }
  for (const auto& literal : seen)
  {
    const bool before = std::any_of(task_state_.begin(), task_state_.end(), [&](const auto& known) {
      return reasoner::toString(known) == literal;
    });
    const auto& effects = assessment.effects;
    const bool after = std::find(effects.begin(), effects.end(), literal) != effects.end();
    if (!before && !after && takeApart(literal).value != "false")
      assessment.changed.push_back(literal);
  }
  if (assessment.changed.empty())
    return TaskLost{"what was observed is impossible in the model of " + state_.currentAction()};
  assessment.happened = happened(assessment.changed);
  return ActionExecuted{action.text, std::move(assessment)};
}

std::optional<std::string> MissionDriver::happened(const std::vector<std::string>& changed) const
{
  FluentValues before;
  for (const auto& literal : task_state_)
    before[reasoner::toString(literal.atom)] = literal.value.name;
  std::vector<reasoner::Literal> wanted;
  for (const auto& text : changed)
    wanted.push_back(reasoner::parseGroundLiteral(text, domain_.highLevel()));
  const OutcomeChooser first{[](const auto&, const auto&) { return std::size_t{0}; },
                             [](std::size_t) { return std::size_t{0}; }};
  for (const auto& declaration : domain_.highLevel().actions)
  {
    if (declaration.exogenous)
      continue;
    for (const auto& action : high_level_laws_.instances(declaration))
    {
      if (!high_level_laws_.executable(before, action))
        continue;
      const FluentValues after = high_level_laws_.successor(before, action, first);
      if (std::all_of(wanted.begin(), wanted.end(),
                      [&](const auto& literal) { return high_level_laws_.holds(after, literal); }))
        return reasoner::toString(action);
    }
  }
  return std::nullopt;
}

}  // namespace kr3::executive
