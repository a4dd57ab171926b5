#include "executive_node.hpp"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <utility>

#include <kr3_common/error.hpp>
#include <kr3_common/ros/status.hpp>
#include <kr3_msgs/CellArray.h>
#include <kr3_refinement/low_level_files.hpp>

#include "../yaml_reader.hpp"
#include "conversions.hpp"
#include "kr3_executive/domain_files.hpp"
#include "kr3_executive/in_process.hpp"
#include "kr3_executive/names.hpp"

namespace kr3::executive
{
namespace
{

/// A mission has some hundred inputs and decisions; none may be lost.
constexpr std::uint32_t kInputQueue = 10000;

std::string listedLines(const std::vector<std::string>& items)
{
  std::string text;
  for (const auto& item : items)
    text += (text.empty() ? "" : ", ") + item;
  return text;
}

/// The map's cells, latched by whoever made the map.
kr3_msgs::CellArray waitForCells(ros::NodeHandle& nh, double deadline_s,
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
  return *cells;
}

}  // namespace

ExecutiveNode::ExecutiveNode(ros::NodeHandle nh, const ros::NodeHandle& private_nh,
                             ExecutiveNodeConfig config, const std::atomic<bool>& stop)
  : config_(std::move(config))
  , reasoner_(nh, config_.plan, config_.driver.history_window)
  , policies_(nh)
  , diagnostics_(nh, private_nh)
  , state_publisher_(nh.advertise<kr3_msgs::MissionState>(names::kState, 1, true))
  , event_publisher_(nh.advertise<kr3_msgs::MissionEvent>(names::kEvents, 100))
  , belief_publisher_(nh.advertise<kr3_msgs::BeliefState>(names::kBelief, 10))
  , belief_markers_publisher_(
        nh.advertise<visualization_msgs::MarkerArray>(names::kBeliefMarkers, 1, true))
  , plan_markers_publisher_(
        nh.advertise<visualization_msgs::MarkerArray>(names::kPlanMarkers, 1, true))
  , input_publisher_(nh.advertise<kr3_msgs::MissionInput>(names::kInputs, kInputQueue))
{
  const auto high_level = reasoner::readDescription(config_.domain);
  const auto refined = refinement::readRefinementFile(config_.refinement, high_level);
  if (!config_.scenario.empty())
    scenario_ = readScenario(config_.scenario, high_level);
  const kr3_msgs::CellArray cells = waitForCells(nh, config_.peer_deadline_s, stop);
  markers_ = std::make_unique<MissionMarkers>(cells);
  LoadedDomain loaded =
      load(high_level, refined, fromMsg(cells), {config_.models, readTextFile(config_.models)},
           {config_.bindings, readTextFile(config_.bindings)});
  domain_ = std::move(loaded.domain);
  models_ = std::move(loaded.models);
  bindings_ = std::move(loaded.bindings);
  narrator_ = std::make_unique<Narrator>(bindings_.phrases());
  executor_ = std::make_unique<RosExecutor>(nh, bindings_);
  const auto now_s = [this] { return clock_.now().toSec(); };
  recorder_ = std::make_unique<MissionRecorder>(
      readDomainFiles(config_.domain, config_.refinement, config_.models, config_.bindings,
                      domain_->map()),
      config_.plan, now_s,
      [this](const RecordedInput& input) { input_publisher_.publish(toMsg(input)); },
      PlanningMethod{config_.method, config_.baseline});
  waitForPeers(stop);
  static_cast<void>(reasoner_.settings());  // refuses a reasoner that counts records otherwise
  const bool knows_defaults = config_.method == Method::kPa || config_.method == Method::kPomdp2;
  if (!knows_defaults)
  {
    own_reasoner_ = std::make_unique<InProcessReasoner>(
        descriptionFor(config_.method, high_level), config_.plan,
        ReasonerSettings{{}, config_.driver.history_window});
  }
  HighLevelReasoner& reasoner = knows_defaults ? reasoner_ : *own_reasoner_;
  LowLevelExecutor* executor = executor_.get();
  if (config_.lockstep)
  {
    pace_ = std::make_unique<LockstepConsumer>(nh);
    paced_executor_ = std::make_unique<PacedExecutor>(*executor_, *pace_);
    executor = paced_executor_.get();
  }
  driver_ = makeMission(
      config_.method,
      {*domain_, models_, *narrator_, reasoner, policies_, *executor, *this, now_s, config_.driver},
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
  belief_markers_publisher_.publish(markers_->of(message));
  const std::lock_guard<std::mutex> lock(mutex_);
  belief_ = belief.summary;
}

void ExecutiveNode::onSnapshot(const Snapshot& snapshot)
{
  kr3_msgs::MissionState message = toMsg(snapshot);
  message.header.stamp = ros::Time::now();
  state_publisher_.publish(message);
  plan_markers_publisher_.publish(markers_->of(message));
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    snapshot_ = snapshot;
  }
  save();
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
