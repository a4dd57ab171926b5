#include "reasoner_node.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <utility>

#include <kr3_common/ros/param_reader.hpp>
#include <kr3_common/ros/status.hpp>

#include "conversions.hpp"
#include "texts.hpp"

namespace kr3::reasoner
{

namespace
{

bool same(const Record& a, const Record& b)
{
  return a.kind == b.kind && a.statement == b.statement && a.value == b.value && a.step == b.step &&
         a.confidence == b.confidence && a.source == b.source;
}

/// Brings a reasoner to a history from step 0; what it has already stays, so that it need not be
/// read again.
void follow(const std::vector<Record>& history, Reasoner& reasoner)
{
  const std::vector<Record>& known = reasoner.history();
  const bool longer = reasoner.firstStep() == 0 && known.size() <= history.size() &&
                      std::equal(known.begin(), known.end(), history.begin(), same);
  if (!longer)
  {
    reasoner.setHistory(history);
  }
  else if (known.size() < history.size())
  {
    reasoner.addRecords(
        {history.begin() + static_cast<std::ptrdiff_t>(known.size()), history.end()});
  }
}

}  // namespace

ReasonerNodeConfig loadReasonerNodeConfig(const ros::NodeHandle& private_nh)
{
  ReasonerNodeConfig config;
  ParamReader params(private_nh);
  config.domain = params.require<std::string>("domain");
  config.more_files = params.get("more_files", config.more_files);
  config.max_horizon = params.get("max_horizon", config.max_horizon);
  params.check(config.max_horizon >= 1, "max_horizon", "must be at least 1");
  config.time_limit_s = params.get("time_limit_s", config.time_limit_s);
  params.check(config.time_limit_s > 0.0, "time_limit_s", "must be positive");
  config.question_time_limit_s = params.get("question_time_limit_s", config.question_time_limit_s);
  params.check(config.question_time_limit_s > 0.0, "question_time_limit_s", "must be positive");
  config.max_records = params.get("max_records", config.max_records);
  params.check(config.max_records >= 1, "max_records", "must be at least 1");
  config.options.diagnose_exogenous =
      params.get("diagnose_exogenous", config.options.diagnose_exogenous);
  config.options.exception_weight = params.get("exception_weight", config.options.exception_weight);
  params.check(config.options.exception_weight >= 1, "exception_weight", "must be at least 1");
  config.options.exogenous_weight = params.get("exogenous_weight", config.options.exogenous_weight);
  params.check(config.options.exogenous_weight >= 1, "exogenous_weight", "must be at least 1");
  config.options.window = params.get("window", config.options.window);
  params.check(config.options.window >= 0, "window", "must be at least 0");
  config.options.max_combinations = params.get("max_combinations", config.options.max_combinations);
  params.check(config.options.max_combinations >= 1, "max_combinations", "must be at least 1");
  params.finish();
  return config;
}

Description readDomain(const ReasonerNodeConfig& config)
{
  std::vector<std::string> files = {config.domain};
  files.insert(files.end(), config.more_files.begin(), config.more_files.end());
  return readDescription(files);
}

ReasonerNode::ReasonerNode(ros::NodeHandle nh, const ReasonerNodeConfig& config)
  : config_(config)
  , reasoner_(readDomain(config), config.options)
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
  offerHistory(nh);
  offerQuestions(nh);
  offerAnalyses(nh);
  plan_.start();
  ROS_INFO("reasoning about %s", config_.domain.c_str());
}

ReasonerNode::~ReasonerNode()
{
  plan_.shutdown();
  for (Work& work : abandoned_)
  {
    work.result.wait();
  }
}

Limits ReasonerNode::questionLimits() const
{
  return {std::chrono::milliseconds(std::llround(config_.question_time_limit_s * 1e3)), nullptr};
}

ReasonerNode::Work ReasonerNode::startPlanning(const kr3_msgs::MakePlanGoal& goal)
{
  PlanOptions options;
  options.max_horizon = config_.max_horizon;
  options.time_limit = std::chrono::milliseconds(std::llround(config_.time_limit_s * 1e3));
  options = fromMsg(goal, options);
  const std::string formula = checkedText(goal.goal, "goal");
  auto cancel = std::make_shared<std::atomic<bool>>(false);
  options.on_horizon = [this, cancel](int horizon) {
    if (!*cancel)
    {
      kr3_msgs::MakePlanFeedback feedback;
      feedback.horizon = static_cast<std::uint32_t>(horizon);
      plan_.publishFeedback(feedback);
    }
  };
  std::unique_lock<std::mutex> lock(mutex_);
  std::shared_ptr<Reasoner> planner = std::exchange(planner_, nullptr);
  if (!planner)
  {
    ReasonerOptions planning = config_.options;
    planning.window = 0;  // it follows the other's beginning
    planner = std::make_shared<Reasoner>(reasoner_.description(), planning);
  }
  const bool progressed = reasoner_.firstStep() > 0;
  std::vector<Record> records;
  if (progressed)
  {
    planner->follow(reasoner_);
  }
  else
  {
    records = reasoner_.history();
  }
  const std::size_t version = domain_version_;
  lock.unlock();
  Work work{cancel, {}};
  work.result = std::async(std::launch::async, [this, planner, cancel, options, formula, version,
                                                progressed, records = std::move(records)] {
    if (!progressed)
    {
      follow(records, *planner);
    }
    kr3_msgs::MakePlanResult result =
        toMsg(planner->plan(formula, options, cancel.get()), planner->currentStep());
    const std::lock_guard<std::mutex> guard(mutex_);
    ++num_plans_;
    if (version == domain_version_)
    {
      planner_ = planner;
    }
    return result;
  });
  return work;
}

void ReasonerNode::onPlan(const kr3_msgs::MakePlanGoalConstPtr& goal)
{
  constexpr std::chrono::milliseconds kPoll(10);
  constexpr std::chrono::milliseconds kPatience(100);
  const auto ended = [](Work& work) {
    return work.result.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  };
  abandoned_.erase(std::remove_if(abandoned_.begin(), abandoned_.end(), ended), abandoned_.end());
  kr3_msgs::MakePlanResult result;
  try
  {
    Work work = startPlanning(*goal);
    while (work.result.wait_for(kPoll) != std::future_status::ready)
    {
      if (!plan_.isPreemptRequested() && ros::ok())
      {
        continue;
      }
      *work.cancel = true;
      if (work.result.wait_for(kPatience) != std::future_status::ready)
      {
        abandoned_.push_back(std::move(work));  // it is grounding, and ends after that
        throw Cancelled("planning was cancelled");
      }
    }
    result = work.result.get();
    result.status = okStatus();
    plan_.setSucceeded(result);
  }
  catch (...)
  {
    result.status = statusFromCurrentException();
    result.status.message = printable(result.status.message);
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
  status.add("first step", reasoner_.firstStep());
  status.add("current step", reasoner_.currentStep());
  status.add("plans made", num_plans_);
  status.add("questions answered", num_questions_);
  if (num_questions_ > 0)
  {
    status.add("last question", last_question_);
    status.add("last question took (s)", last_duration_s_);
    status.add("time since last question (s)", (ros::WallTime::now() - last_time_).toSec());
  }
}

}  // namespace kr3::reasoner
