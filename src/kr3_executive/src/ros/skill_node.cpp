#include "skill_node.hpp"

#include <std_msgs/String.h>
#include <yaml-cpp/yaml.h>

#include <kr3_common/error.hpp>
#include <kr3_common/ros/status.hpp>

#include "skill_names.hpp"

namespace kr3::executive::skills
{
namespace
{

std::set<std::string> objectNames(const std::string& path)
{
  try
  {
    std::set<std::string> names;
    for (const YAML::Node& object : YAML::LoadFile(path)["objects"])
      names.insert(object["name"].as<std::string>());
    if (names.empty())
      throw InvalidArgument(path + ": expected a list named 'objects'");
    return names;
  }
  catch (const YAML::BadFile&)
  {
    throw Unavailable("cannot read objects file '" + path + "'");
  }
  catch (const YAML::Exception& e)
  {
    throw InvalidArgument(path + ": " + e.what());
  }
}

/// The literal of the bindings that says where an object was seen; empty when there is none.
std::string seenLiteral(const std::string& path)
{
  if (path.empty())
    return {};
  try
  {
    const YAML::Node sightings = YAML::LoadFile(path)["sightings"];
    if (!sightings || !sightings["seen"])
      return {};
    const auto text = sightings["seen"].as<std::string>();
    for (const char* part : {"${object}", "${cell}"})
    {
      if (text.find(part) == std::string::npos)
        throw InvalidArgument(path + ": sightings: seen: '" + text + "' without " + part);
    }
    return text;
  }
  catch (const YAML::BadFile&)
  {
    throw Unavailable("cannot read bindings file '" + path + "'");
  }
  catch (const YAML::Exception& e)
  {
    throw InvalidArgument(path + ": " + e.what());
  }
}

}  // namespace

SkillNode::SkillNode(const ros::NodeHandle& nh, const SkillNodeConfig& config)
  : config_(config)
  , objects_(objectNames(config.objects))
  , seen_literal_(seenLiteral(config.bindings))
  , robot_(nh, config.robot)
{
  ros::NodeHandle handle(nh);
  request_ = handle.advertise<std_msgs::String>(names::kHandOverRequest, 1, true);
  const auto offerAnswer = [&](const char* name, Answer answer) {
    return handle.advertiseService<std_srvs::Trigger::Request, std_srvs::Trigger::Response>(
        name, [this, answer](std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
          robot_.notify([&] { answer_ = answer; });
          response.success = true;
          return true;
        });
  };
  confirm_ = offerAnswer(names::kHandOverConfirm, Answer::kConfirmed);
  refuse_ = offerAnswer(names::kHandOverRefuse, Answer::kRefused);
  diagnostics_.setHardwareID("none");
  diagnostics_.add("skills", [this](diagnostic_updater::DiagnosticStatusWrapper& status) {
    const std::string current = current_.load();
    status.summary(diagnostic_msgs::DiagnosticStatus::OK, current.empty() ? "idle" : current);
    status.add("done", num_done_.load());
    status.add("failed", num_failed_.load());
  });
  diagnostics_timer_ = handle.createWallTimer(
      ros::WallDuration(1.0), [this](const ros::WallTimerEvent&) { diagnostics_.force_update(); });
  offer("search", names::kSearch, &SkillNode::search, config.search_time_limit_s);
  offer("grasp", names::kGrasp, &SkillNode::grasp, config.grasp_time_limit_s);
  offer("put_down", names::kPutDown, &SkillNode::putDown, config.put_down_time_limit_s);
  offer("hand_over", names::kHandOver, &SkillNode::handOver, config.hand_over_time_limit_s);
  for (const auto& each : offers_)
    each->server->start();
  ROS_INFO("skills ready: %zu objects may be asked for", objects_.size());
}

SkillNode::~SkillNode()
{
  for (const auto& each : offers_)
    each->server->shutdown();
}

void SkillNode::offer(const std::string& name, const std::string& topic, Skill skill,
                      double time_limit_s)
{
  auto added = std::make_unique<Offer>();
  added->name = name;
  added->skill = skill;
  added->time_limit_s = time_limit_s;
  Offer* const mine = added.get();  // stays where it is: offers_ owns it by pointer
  added->server = std::make_unique<Server>(
      topic, [this, mine](const kr3_msgs::ExecuteSkillGoalConstPtr& goal) { serve(*mine, *goal); },
      false);
  offers_.push_back(std::move(added));
}

void SkillNode::serve(Offer& offer, const kr3_msgs::ExecuteSkillGoal& goal)
{
  kr3_msgs::ExecuteSkillResult result;
  const ros::Time start = clock_.now();
  const ros::Duration limit =
      goal.time_limit.isZero() ? ros::Duration(offer.time_limit_s) : goal.time_limit;
  const Run run{[&] {
    if (offer.server->isPreemptRequested() || !ros::ok())
      throw Cancelled(offer.name + " was cancelled");
    if (clock_.now() - start > limit)
      throw DeadlineExceeded(offer.name + " took more than " + std::to_string(limit.toSec()) +
                             " s");
                },
                [&](const std::string& phase, double progress) {
    kr3_msgs::ExecuteSkillFeedback feedback;
    feedback.phase = phase;
    feedback.progress = progress;
    offer.server->publishFeedback(feedback);
  }};
  respond(result.status, offer.name, [&] {
    const std::unique_lock<std::mutex> lock(running_, std::try_to_lock);
    if (!lock.owns_lock())
      throw FailedPrecondition("another skill is under way");
    if (!goal.skill.empty() && goal.skill != offer.name)
      throw InvalidArgument("found skill '" + goal.skill + "', this is '" + offer.name + "'");
    if (limit < ros::Duration(0.0))
      throw InvalidArgument("the time limit is negative");
    current_ = offer.name.c_str();
    noticed_.clear();
    try
    {
      const Outcome outcome = (this->*offer.skill)(goal.arguments, run);
      result.outcome = outcome.label;
      result.observation = outcome.observation;
      result.confidence = outcome.confidence;
      result.sightings = seenByTheWay(goal.arguments, outcome, run);
    }
    catch (...)
    {
      robot_.stop();
      robot_.restEyes();
      current_ = "";
      throw;
    }
    robot_.stop();
    robot_.restEyes();
    current_ = "";
  });
  result.duration_s = (clock_.now() - start).toSec();
  const auto code = static_cast<ErrorCode>(result.status.code);
  ++(code == ErrorCode::kOk ? num_done_ : num_failed_);
  if (code == ErrorCode::kOk)
    offer.server->setSucceeded(result);
  else if (code == ErrorCode::kCancelled)
    offer.server->setPreempted(result, result.status.message);
  else
    offer.server->setAborted(result, result.status.message);
}

void SkillNode::checkObject(const std::string& name) const
{
  if (objects_.count(name) == 0)
    throw InvalidArgument("no object is called '" + name + "'");
}

void SkillNode::checkCell(const std::string& name, const Run& run)
{
  (void)robot_.cells(run.interruption).at(name);
}

}  // namespace kr3::executive::skills
