#include "reasoner_node.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

#include <kr3_common/ros/param_reader.hpp>
#include <kr3_common/ros/status.hpp>

#include "conversions.hpp"

namespace kr3::reasoner
{

namespace
{

int stepOf(std::uint32_t step)
{
  return static_cast<int>(std::min<std::uint32_t>(step, 1000000));
}

static_assert(static_cast<int>(Answer::kFalse) == kr3_msgs::Entails::Request::FALSE);
static_assert(static_cast<int>(Answer::kTrue) == kr3_msgs::Entails::Request::TRUE);
static_assert(static_cast<int>(Answer::kUnknown) == kr3_msgs::Entails::Request::UNKNOWN);

}  // namespace

ReasonerNodeConfig loadReasonerNodeConfig(const ros::NodeHandle& private_nh)
{
  ReasonerNodeConfig config;
  ParamReader params(private_nh);
  config.domain = params.require<std::string>("domain");
  config.max_horizon = params.get("max_horizon", config.max_horizon);
  params.check(config.max_horizon >= 1, "max_horizon", "must be at least 1");
  config.time_limit_s = params.get("time_limit_s", config.time_limit_s);
  params.check(config.time_limit_s > 0.0, "time_limit_s", "must be positive");
  config.options.diagnose_exogenous =
      params.get("diagnose_exogenous", config.options.diagnose_exogenous);
  config.options.exception_weight = params.get("exception_weight", config.options.exception_weight);
  params.check(config.options.exception_weight >= 1, "exception_weight", "must be at least 1");
  config.options.exogenous_weight = params.get("exogenous_weight", config.options.exogenous_weight);
  params.check(config.options.exogenous_weight >= 1, "exogenous_weight", "must be at least 1");
  params.finish();
  return config;
}

ReasonerNode::ReasonerNode(ros::NodeHandle nh, const ReasonerNodeConfig& config)
  : config_(config)
  , reasoner_(readDescription(config.domain), config.options)
  , set_history_(nh.advertiseService("reasoner/set_history", &ReasonerNode::onSetHistory, this))
  , add_records_(nh.advertiseService("reasoner/add_records", &ReasonerNode::onAddRecords, this))
  , entails_(nh.advertiseService("reasoner/entails", &ReasonerNode::onEntails, this))
  , explain_(nh.advertiseService("reasoner/explain", &ReasonerNode::onExplain, this))
  , diagnose_(nh.advertiseService("reasoner/diagnose", &ReasonerNode::onDiagnose, this))
  , get_state_(nh.advertiseService("reasoner/get_state", &ReasonerNode::onGetState, this))
  , plan_(
        nh, "reasoner/plan", [this](const kr3_msgs::MakePlanGoalConstPtr& goal) { onPlan(goal); },
        false)
{
  constexpr double kDiagnosticsPeriodS = 1.0;
  diagnostics_.setHardwareID("none");
  diagnostics_.add("reasoner", this, &ReasonerNode::report);
  diagnostics_timer_ =
      nh.createWallTimer(ros::WallDuration(kDiagnosticsPeriodS),
                         [this](const ros::WallTimerEvent&) { diagnostics_.update(); });
  plan_.registerPreemptCallback([this] { cancel_ = true; });
  plan_.start();
  ROS_INFO("reasoning about %s", config_.domain.c_str());
}

ReasonerNode::~ReasonerNode()
{
  cancel_ = true;
  plan_.shutdown();
}

bool ReasonerNode::onSetHistory(kr3_msgs::SetHistory::Request& request,
                                kr3_msgs::SetHistory::Response& response)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  respond(response.status, "set_history", [&] { reasoner_.setHistory(fromMsg(request.records)); });
  response.num_records = static_cast<std::uint32_t>(reasoner_.history().size());
  return true;
}

bool ReasonerNode::onAddRecords(kr3_msgs::AddRecords::Request& request,
                                kr3_msgs::AddRecords::Response& response)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  respond(response.status, "add_records", [&] {
    if (request.expected_num_records != reasoner_.history().size())
    {
      throw FailedPrecondition("there are " + std::to_string(reasoner_.history().size()) +
                               " records, the client expected " +
                               std::to_string(request.expected_num_records) +
                               "; set the history again");
    }
    reasoner_.addRecords(fromMsg(request.records));
  });
  response.num_records = static_cast<std::uint32_t>(reasoner_.history().size());
  return true;
}

bool ReasonerNode::onEntails(kr3_msgs::Entails::Request& request,
                             kr3_msgs::Entails::Response& response)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return respond(response.status, "entails", [&] {
    const int step = stepOf(request.step);
    response.answer = static_cast<std::uint8_t>(reasoner_.entails(request.literal, step));
    response.possible = reasoner_.possible(request.literal, step);
  });
}

bool ReasonerNode::onExplain(kr3_msgs::ExplainLiteral::Request& request,
                             kr3_msgs::ExplainLiteral::Response& response)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return respond(response.status, "explain", [&] {
    const Explanation explanation = reasoner_.explain(request.literal, stepOf(request.step));
    response.entailed = explanation.entailed;
    response.reasons = explanation.reasons;
    response.records = explanation.records;
  });
}

bool ReasonerNode::onDiagnose(kr3_msgs::Diagnose::Request&, kr3_msgs::Diagnose::Response& response)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return respond(response.status, "diagnose", [&] {
    const Diagnosis diagnosis = reasoner_.diagnose();
    response.consistent = diagnosis.consistent;
    response.cost = static_cast<std::uint32_t>(diagnosis.cost);
    response.conflict = diagnosis.conflict;
    for (const std::vector<std::string>& explanation : diagnosis.explanations)
    {
      response.explanations.push_back(joined(explanation, "; "));
    }
  });
}

bool ReasonerNode::onGetState(kr3_msgs::GetState::Request& request,
                              kr3_msgs::GetState::Response& response)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return respond(response.status, "get_state", [&] {
    for (const Literal& literal : reasoner_.entailedAt(stepOf(request.step)))
    {
      kr3_msgs::ExplainedLiteral explained;
      explained.literal = toString(literal);
      explained.step = request.step;
      if (request.explain)
      {
        explained.reason =
            joined(reasoner_.explain(explained.literal, stepOf(request.step)).reasons, "; ");
      }
      response.literals.push_back(explained);
    }
  });
}

kr3_msgs::MakePlanResult ReasonerNode::makePlan(const kr3_msgs::MakePlanGoal& goal)
{
  PlanOptions options;
  options.max_horizon = goal.max_horizon == 0 ? config_.max_horizon : stepOf(goal.max_horizon);
  const double limit_s = goal.time_limit.isZero() ? config_.time_limit_s : goal.time_limit.toSec();
  options.time_limit = std::chrono::milliseconds(static_cast<std::int64_t>(limit_s * 1e3));
  options.on_horizon = [this](int horizon) {
    kr3_msgs::MakePlanFeedback feedback;
    feedback.horizon = static_cast<std::uint32_t>(horizon);
    plan_.publishFeedback(feedback);
  };
  std::unique_lock<std::mutex> lock(mutex_);
  Reasoner planner(reasoner_.description(), config_.options);
  std::vector<Record> records = reasoner_.history();
  lock.unlock();
  planner.setHistory(std::move(records));
  const kr3_msgs::MakePlanResult result =
      toMsg(planner.plan(goal.goal, options, &cancel_), planner.currentStep());
  lock.lock();
  ++num_plans_;
  return result;
}

void ReasonerNode::onPlan(const kr3_msgs::MakePlanGoalConstPtr& goal)
{
  cancel_ = plan_.isPreemptRequested() || !ros::ok();
  kr3_msgs::MakePlanResult result;
  try
  {
    result = makePlan(*goal);
    result.status = okStatus();
    plan_.setSucceeded(result);
  }
  catch (...)
  {
    result.status = statusFromCurrentException();
    if (result.status.code == kr3_msgs::Status::CANCELLED)
    {
      plan_.setPreempted(result, result.status.message);
      return;
    }
    logFailure("plan", result.status);
    plan_.setAborted(result, result.status.message);
  }
}

void ReasonerNode::report(diagnostic_updater::DiagnosticStatusWrapper& status)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  status.summary(diagnostic_msgs::DiagnosticStatus::OK, plan_.isActive() ? "planning" : "ready");
  status.add("domain", config_.domain);
  status.add("records", reasoner_.history().size());
  status.add("current step", reasoner_.currentStep());
  status.add("plans made", num_plans_);
}

}  // namespace kr3::reasoner
