#include "executive_node.hpp"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <fstream>
#include <sstream>
#include <utility>

#include <kr3_common/error.hpp>
#include <kr3_common/ros/param_reader.hpp>
#include <kr3_common/ros/status.hpp>
#include <kr3_msgs/CellArray.h>
#include <kr3_refinement/low_level_files.hpp>

#include "conversions.hpp"
#include "kr3_executive/domain_files.hpp"
#include "kr3_executive/in_process.hpp"
#include "kr3_executive/knowledge_file.hpp"
#include "kr3_executive/names.hpp"

namespace kr3::executive
{
namespace
{

/// A mission has some hundred inputs and decisions; none may be lost.
constexpr std::uint32_t kInputQueue = 10000;
constexpr double kLeastTimeLeft_s = 1e-3;  // 0 would mean no limit

std::string listedLines(const std::vector<std::string>& items)
{
  std::string text;
  for (const auto& item : items)
    text += (text.empty() ? "" : ", ") + item;
  return text;
}

std::string readText(const std::string& path)
{
  std::ifstream file(path);
  std::ostringstream text;
  if (!file || !(text << file.rdbuf()))
    throw Unavailable("cannot read '" + path + "'");
  return text.str();
}

/// The map's cells, latched by whoever made the map.
refinement::ComponentMap waitForCells(ros::NodeHandle& nh, double deadline_s,
                                      const std::atomic<bool>& stop)
{
  std::mutex mutex;
  std::condition_variable arrived;
  kr3_msgs::CellArray::ConstPtr cells;
  const ros::Subscriber subscriber = nh.subscribe<kr3_msgs::CellArray>(
      names::kCells, 1, [&](const kr3_msgs::CellArray::ConstPtr& message) {
        const std::lock_guard<std::mutex> lock(mutex);
        cells = message;
        arrived.notify_all();
      });
  const auto deadline =
      std::chrono::steady_clock::now() + std::chrono::duration<double>(deadline_s);
  std::unique_lock<std::mutex> lock(mutex);
  while (!arrived.wait_for(lock, std::chrono::milliseconds(50), [&] { return cells != nullptr; }))
  {
    if (stop || !ros::ok())
      throw Cancelled("stopped while waiting for " + subscriber.getTopic());
    if (std::chrono::steady_clock::now() > deadline)
      throw Unavailable("no message on topic " + subscriber.getTopic() +
                        " (the map's cells) in time");
  }
  return fromMsg(*cells);
}

ErrorCode codeOf(const std::exception& e)
{
  const auto* error = dynamic_cast<const Error*>(&e);
  return error == nullptr ? ErrorCode::kInternal : error->code();
}

}  // namespace

ExecutiveNodeConfig loadExecutiveNodeConfig(const ros::NodeHandle& private_nh)
{
  ExecutiveNodeConfig config;
  ParamReader params(private_nh);
  config.domain = params.require<std::string>("domain");
  config.refinement = params.require<std::string>("refinement");
  config.models = params.require<std::string>("models");
  config.bindings = params.require<std::string>("bindings");
  config.scenario = params.get("scenario", config.scenario);
  config.state_file = params.get("state_file", config.state_file);
  const std::string method = params.get("method", std::string(toString(config.method)));
  const auto& methods = allMethods();
  const auto named = std::find_if(methods.begin(), methods.end(),
                                  [&](Method known) { return method == toString(known); });
  params.check(named != methods.end(), "method",
               "must be pa, pa_star, pomdp1, pomdp2 or hierarchical");
  config.method = named == methods.end() ? config.method : *named;
  double& bias = config.baseline.default_probability;
  bias = params.get("pomdp2_bias", bias);
  params.check(bias > 0.0 && bias < 1.0, "pomdp2_bias", "must be in (0, 1)");
  config.peer_deadline_s = params.get("peer_deadline_s", config.peer_deadline_s);
  params.check(config.peer_deadline_s > 0.0, "peer_deadline_s", "must be positive");

  const auto count = [&params](const std::string& name, int fallback, int least) {
    const int value = params.get(name, fallback);
    params.check(value >= least, name, "must be at least " + std::to_string(least));
    return static_cast<std::uint32_t>(std::max(value, least));
  };
  Limits& limits = config.driver.limits;
  limits.max_hl_actions = count("max_hl_actions", static_cast<int>(limits.max_hl_actions), 1);
  limits.max_ll_actions = count("max_ll_actions", static_cast<int>(limits.max_ll_actions), 1);
  limits.max_attempts = count("max_attempts", static_cast<int>(limits.max_attempts), 1);
  limits.max_reopened = count("max_reopened", static_cast<int>(limits.max_reopened), 0);
  config.driver.max_skill_retries =
      count("max_skill_retries", static_cast<int>(config.driver.max_skill_retries), 0);
  limits.threshold = params.get("threshold", limits.threshold);
  params.check(limits.threshold > 0.5 && limits.threshold < 1.0, "threshold",
               "must be in (0.5, 1)");
  double& by_default = config.driver.default_probability;
  by_default = params.get("default_probability", by_default);
  params.check(by_default > 0.0 && by_default < 1.0, "default_probability", "must be in (0, 1)");

  double& least = config.driver.least_hypothesis_probability;
  least = params.get("least_hypothesis_probability", least);
  params.check(least > 0.0 && least < 1.0, "least_hypothesis_probability", "must be in (0, 1)");
  double& change = config.driver.change_probability;
  change = params.get("change_probability", change);
  params.check(change >= 0.0 && change < 1.0, "change_probability", "must be in [0, 1)");

  SolveBudget& budget = config.driver.budget;
  budget.precision = params.get("precision", budget.precision);
  params.check(budget.precision > 0.0, "precision", "must be positive");
  budget.time_s = params.get("solve_time_s", budget.time_s);
  params.check(budget.time_s >= 0.0, "solve_time_s", "must not be negative");
  budget.max_backups = count("max_backups", static_cast<int>(budget.max_backups), 0);

  config.plan.max_horizon = static_cast<int>(count("max_horizon", config.plan.max_horizon, 1));
  const double plan_time_s = params.get("plan_time_s", 10.0);
  params.check(plan_time_s > 0.0, "plan_time_s", "must be positive");
  config.plan.time_limit = std::chrono::milliseconds(static_cast<int>(1000.0 * plan_time_s));
  config.driver.explain_facts = true;
  params.finish();
  return config;
}

ExecutiveNode::ExecutiveNode(ros::NodeHandle nh, const ros::NodeHandle& private_nh,
                             ExecutiveNodeConfig config, const std::atomic<bool>& stop)
  : config_(std::move(config))
  , reasoner_(nh, config_.plan)
  , policies_(nh)
  , diagnostics_(nh, private_nh)
  , state_publisher_(nh.advertise<kr3_msgs::MissionState>(names::kState, 1, true))
  , event_publisher_(nh.advertise<kr3_msgs::MissionEvent>(names::kEvents, 100))
  , belief_publisher_(nh.advertise<kr3_msgs::BeliefState>(names::kBelief, 10))
  , input_publisher_(nh.advertise<kr3_msgs::MissionInput>(names::kInputs, kInputQueue))
{
  const auto high_level = reasoner::readDescription(config_.domain);
  const auto refined = refinement::readRefinementFile(config_.refinement, high_level);
  if (!config_.scenario.empty())
    scenario_ = readScenario(config_.scenario, high_level);
  LoadedDomain loaded = load(high_level, refined, waitForCells(nh, config_.peer_deadline_s, stop),
                             {config_.models, readText(config_.models)},
                             {config_.bindings, readText(config_.bindings)});
  domain_ = std::move(loaded.domain);
  models_ = std::move(loaded.models);
  bindings_ = std::move(loaded.bindings);
  narrator_ = std::make_unique<Narrator>(bindings_.phrases(), high_level);
  executor_ = std::make_unique<RosExecutor>(nh, bindings_);
  const auto now_s = [] { return ros::Time::now().toSec(); };
  recorder_ = std::make_unique<MissionRecorder>(
      readDomainFiles(config_.domain, config_.refinement, config_.models, config_.bindings,
                      domain_->map()),
      config_.plan, now_s,
      [this](const RecordedInput& input) { input_publisher_.publish(toMsg(input)); },
      PlanningMethod{config_.method, config_.baseline});
  waitForPeers(stop);
  const bool knows_defaults = config_.method == Method::kPa || config_.method == Method::kPomdp2;
  if (!knows_defaults)
  {
    own_reasoner_ = std::make_unique<InProcessReasoner>(descriptionFor(config_.method, high_level),
                                                        config_.plan);
  }
  HighLevelReasoner& reasoner = knows_defaults ? reasoner_ : *own_reasoner_;
  driver_ = makeMission(config_.method,
                        {*domain_, models_, *narrator_, reasoner, policies_, *executor_, *this,
                         now_s, config_.driver},
                        config_.baseline);
  restoreKnowledge();
  onSnapshot({State{}, {}, driver_->knowledge().history, {}, {}});

  diagnostics_.setHardwareID("none");
  diagnostics_.add("mission", this, &ExecutiveNode::diagnose);
  diagnostics_timer_ = nh.createWallTimer(
      ros::WallDuration(1.0), [this](const ros::WallTimerEvent&) { diagnostics_.force_update(); });
  tell_ = nh.advertiseService(names::kTell, &ExecutiveNode::onTell, this);
  achieve_ = std::make_unique<AchieveServer>(
      nh, names::kAchieve, [this](const kr3_msgs::AchieveGoalConstPtr& goal) { onAchieve(goal); },
      false);
  achieve_->registerPreemptCallback([this] { driver_->cancel(); });
  cancel_ = nh.advertiseService(names::kCancel, &ExecutiveNode::onCancel, this);
  achieve_->start();
  ROS_INFO("ready: %zu cells, %zu records in the history", domain_->map().size(),
           driver_->knowledge().history.size());
  resumeMission();
}

ExecutiveNode::~ExecutiveNode()
{
  // Ends a mission under way: its skill is cancelled, so that the robot stands. It stays in the
  // state file.
  stopping_ = true;
  if (driver_)
    driver_->cancel();
  endResumedMission();
  if (achieve_)
    achieve_->shutdown();
}

void ExecutiveNode::waitForPeers(const std::atomic<bool>& stop)
{
  const ros::WallTime deadline = ros::WallTime::now() + ros::WallDuration(config_.peer_deadline_s);
  while (true)
  {
    std::vector<std::string> missing = reasoner_.missing();
    for (const auto& more : {policies_.missing(), executor_->missing()})
      missing.insert(missing.end(), more.begin(), more.end());
    if (missing.empty())
      return;
    if (stop || !ros::ok())
      throw Cancelled("stopped while waiting for " + listedLines(missing));
    if (ros::WallTime::now() > deadline)
      throw Unavailable("did not answer in time: " + listedLines(missing));
    ROS_INFO_THROTTLE(5.0, "waiting for %s", listedLines(missing).c_str());
    ros::WallDuration(0.1).sleep();  // neither services nor action servers announce themselves
  }
}

void ExecutiveNode::restoreKnowledge()
{
  if (config_.state_file.empty())
    return;
  if (auto knowledge = readKnowledge(config_.state_file))
  {
    driver_->setKnowledge(std::move(*knowledge));
    ROS_INFO("picked up %zu records from %s", driver_->knowledge().history.size(),
             config_.state_file.c_str());
  }
  under_way_ = readMissionUnderWay(config_.state_file);
  mission_start_s_ = ros::Time::now().toSec();
}

void ExecutiveNode::onAchieve(const kr3_msgs::AchieveGoalConstPtr& goal)
{
  kr3_msgs::AchieveResult result;
  endResumedMission();  // a new goal takes its place
  try
  {
    const MissionResult mission = runMission(
        {goal->goal,
         goal->max_hl_actions > 0 ? goal->max_hl_actions : config_.driver.limits.max_hl_actions,
         goal->time_limit.toSec()});
    result.status = makeStatus(mission.code, mission.code == ErrorCode::kOk ? "" : mission.reason);
    result.achieved = mission.achieved;
    result.reason = mission.reason;
    result.hl_actions = mission.hl_actions;
    result.ll_actions = mission.ll_actions;
    result.duration_s = mission.duration_s;
  }
  catch (const std::exception& e)
  {
    result.status = makeStatus(codeOf(e), e.what());
    result.reason = e.what();
  }
  if (result.status.code == kr3_msgs::Status::OK)
    achieve_->setSucceeded(result);
  else if (result.status.code == kr3_msgs::Status::CANCELLED)
    achieve_->setPreempted(result);
  else
  {
    logFailure("achieve '" + goal->goal + "'", result.status);
    achieve_->setAborted(result);
  }
}

MissionResult ExecutiveNode::runMission(const MissionUnderWay& mission)
{
  Limits limits = config_.driver.limits;
  limits.max_hl_actions = mission.max_hl_actions;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    under_way_ = mission;
    mission_start_s_ = ros::Time::now().toSec();
  }
  const auto over = [this] {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      under_way_.reset();
    }
    save();
  };
  try
  {
    const MissionResult result =
        driver_->achieve(mission.goal, scenario_.initial_records, limits, mission.time_left_s);
    const bool cut_off = stopping_ || (result.code == ErrorCode::kUnavailable && !ros::ok());
    if (!cut_off)
      over();
    return result;
  }
  catch (const InvalidArgument&)
  {
    over();
    throw;
  }
}

void ExecutiveNode::resumeMission()
{
  const std::optional<MissionUnderWay> mission = under_way_;  // no mission runs yet
  if (!mission)
    return;
  ROS_INFO("going on with '%s'", mission->goal.c_str());
  resumed_ = std::async(std::launch::async, [this, mission] {
    try
    {
      const MissionResult result = runMission(*mission);
      ROS_INFO("'%s' ended: %s", mission->goal.c_str(), result.reason.c_str());
    }
    catch (const std::exception& e)
    {
      ROS_ERROR("'%s' cannot be taken up again: %s", mission->goal.c_str(), e.what());
    }
  });
}

void ExecutiveNode::endResumedMission()
{
  while (resumed_.valid() &&
         resumed_.wait_for(std::chrono::milliseconds(20)) != std::future_status::ready)
    driver_->cancel();  // again, as it may not have begun
}

bool ExecutiveNode::onCancel(std_srvs::Trigger::Request& /*request*/,
                             std_srvs::Trigger::Response& response)
{
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    response.success = static_cast<unsigned char>(under_way_.has_value());
  }
  driver_->cancel();
  response.message = response.success != 0 ? "the mission ends" : "no mission is under way";
  return true;
}

bool ExecutiveNode::onTell(kr3_msgs::Tell::Request& request, kr3_msgs::Tell::Response& response)
{
  return respond(response.status, "tell '" + request.literal + "'", [&] {
    driver_->tell({reasoner::RecordKind::kObserved, request.literal, request.value != 0, 0,
                   request.confidence, "person"});
  });
}

void ExecutiveNode::onEvent(const ReportedEvent& event)
{
  kr3_msgs::MissionEvent message = toMsg(event);
  message.header.stamp = ros::Time::now();
  event_publisher_.publish(message);
  ROS_INFO("[%s] %s", toString(event.kind), event.narration.text.c_str());
  if (!achieve_ || !achieve_->isActive())
    return;
  if (achieve_->isPreemptRequested())  // it may have come before the mission began
    driver_->cancel();
  const std::lock_guard<std::mutex> lock(mutex_);
  feedback_.event = message;
  feedback_.hl_step = event.hl_step;
  feedback_.hl_action = event.hl_action;
  feedback_.ll_action = snapshot_.ll_action;
  feedback_.belief = belief_;
  achieve_->publishFeedback(feedback_);
}

void ExecutiveNode::onBelief(const ReportedBelief& belief)
{
  kr3_msgs::BeliefState message = toMsg(belief);
  message.header.stamp = ros::Time::now();
  belief_publisher_.publish(message);
  const std::lock_guard<std::mutex> lock(mutex_);
  belief_ = belief.summary;
}

void ExecutiveNode::onSnapshot(const Snapshot& snapshot)
{
  kr3_msgs::MissionState message = toMsg(snapshot);
  message.header.stamp = ros::Time::now();
  state_publisher_.publish(message);
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    snapshot_ = snapshot;
  }
  save();
}

void ExecutiveNode::save()
{
  if (config_.state_file.empty() || !driver_)
    return;
  std::optional<MissionUnderWay> mission;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    mission = under_way_;
    if (mission)
    {
      const std::uint32_t done = snapshot_.state.hl_actions_done;
      mission->max_hl_actions = mission->max_hl_actions > done ? mission->max_hl_actions - done : 1;
      if (mission->time_left_s > 0.0)
      {
        const double elapsed_s = ros::Time::now().toSec() - mission_start_s_;
        mission->time_left_s = std::max(kLeastTimeLeft_s, mission->time_left_s - elapsed_s);
      }
    }
  }
  try
  {
    writeKnowledge(config_.state_file, driver_->knowledge(), mission);
  }
  catch (const Error& e)
  {
    ROS_ERROR_THROTTLE(10.0, "the history is not kept: %s", e.what());
  }
}

void ExecutiveNode::onInput(const Input& input)
{
  recorder_->onInput(input);
}

void ExecutiveNode::onDecision(const ReportedDecision& decision)
{
  recorder_->onDecision(decision);
}

void ExecutiveNode::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  const State& state = snapshot_.state;
  const bool failed = state.phase == Phase::kFinished && state.outcome &&
                      state.outcome->code != ErrorCode::kOk &&
                      state.outcome->code != ErrorCode::kCancelled;
  status.summary(
      failed ? diagnostic_msgs::DiagnosticStatus::WARN : diagnostic_msgs::DiagnosticStatus::OK,
      failed ? "the last mission failed: " + state.outcome->reason : toString(state.phase));
  status.add("goal", state.goal);
  status.add("high-level step", state.step);
  status.add("high-level actions", state.hl_actions_done);
  status.add("low-level actions", state.ll_actions_done);
  status.add("records", snapshot_.history.size());
}

}  // namespace kr3::executive
