#include "clients.hpp"

#include <algorithm>
#include <functional>
#include <sstream>
#include <utility>

#include <std_srvs/Trigger.h>

#include <kr3_common/error.hpp>
#include <kr3_msgs/AddRecords.h>
#include <kr3_msgs/Diagnose.h>
#include <kr3_msgs/Entails.h>
#include <kr3_msgs/ExplainLiteral.h>
#include <kr3_msgs/FindRetractions.h>
#include <kr3_msgs/GetPolicyAction.h>
#include <kr3_msgs/GetState.h>
#include <kr3_msgs/ProgressHistory.h>
#include <kr3_msgs/SetHistory.h>
#include <kr3_pomdp/pomdp_format.hpp>

#include "conversions.hpp"
#include "kr3_executive/mission_recording.hpp"
#include "kr3_executive/names.hpp"

namespace kr3::executive
{
namespace
{

/// Between the statements of an explanation in Diagnose.srv.
const std::string kSeparator = "; ";

/// Calls a service whose reply begins with a status. A node that is being restarted gets some time.
/// @param renew  called after a call in vain: a persistent client does not outlive its server
template <typename Service>
void callService(
    ros::ServiceClient& client, Service& service, const std::function<void()>& renew = [] {})
{
  const ros::WallTime deadline = ros::WallTime::now() + ros::WallDuration(5.0);
  while (!client.call(service.request, service.response))
  {
    if (!ros::ok() || ros::WallTime::now() > deadline)
      throw Unavailable("service '" + client.getService() + "' does not answer");
    ros::WallDuration(0.05).sleep();  // waitForExistence uses simulated time, which may stand
    renew();
  }
  throwIfFailed(service.response.status, client.getService());
}

void noteMissing(ros::ServiceClient& client, std::vector<std::string>& missing)
{
  if (!client.exists())
    missing.push_back("service " + client.getService());
}

}  // namespace

RosReasoner::RosReasoner(ros::NodeHandle nh, const reasoner::PlanOptions& options,
                         std::uint32_t history_window)
  : options_(options)
  , history_window_(history_window)
  , window_(history_window)
  , set_history_(nh.serviceClient<kr3_msgs::SetHistory>(names::kSetHistory))
  , add_records_(nh.serviceClient<kr3_msgs::AddRecords>(names::kAddRecords))
  , entails_(nh.serviceClient<kr3_msgs::Entails>(names::kEntails))
  , explain_(nh.serviceClient<kr3_msgs::ExplainLiteral>(names::kExplain))
  , diagnose_(nh.serviceClient<kr3_msgs::Diagnose>(names::kDiagnose))
  , get_state_(nh.serviceClient<kr3_msgs::GetState>(names::kGetState))
  , find_retractions_(nh.serviceClient<kr3_msgs::FindRetractions>(names::kFindRetractions))
  , progress_(nh.serviceClient<kr3_msgs::ProgressHistory>(names::kProgress))
  , get_options_(nh.serviceClient<std_srvs::Trigger>(names::kGetOptions))
  , plan_(nh, names::kPlan)
{
}

std::optional<ReasonerSettings> RosReasoner::settings()
{
  std_srvs::Trigger service;
  if (!get_options_.exists() || !get_options_.call(service) || service.response.success == 0)
  {
    ROS_WARN("%s does not answer: its parameters are not recorded, and a replay uses the defaults",
             get_options_.getService().c_str());
    return std::nullopt;
  }
  ReasonerSettings settings = settingsFromText(service.response.message, history_window_);
  if (settings.options.window != 0)
  {
    throw FailedPrecondition(
        "the reasoner has the parameter window: " + std::to_string(settings.options.window) +
        ", expected 0; the executive has its own, history_window");
  }
  return settings;
}

std::vector<std::string> RosReasoner::missing()
{
  std::vector<std::string> missing;
  for (auto* client : {&set_history_, &add_records_, &entails_, &explain_, &diagnose_, &get_state_,
                       &find_retractions_, &progress_})
    noteMissing(*client, missing);
  if (!plan_.connected())
    missing.push_back("action " + plan_.name());
  return missing;
}

void RosReasoner::setHistory(const std::vector<reasoner::Record>& records)
{
  suppose(records);
  progressIfDue();
}

void RosReasoner::suppose(const std::vector<reasoner::Record>& records)
{
  kr3_msgs::SetHistory service;
  service.request.records = toMsg(records);
  callService(set_history_, service);
  window_.reset(records);
}

void RosReasoner::progressIfDue()
{
  const auto step = window_.due();
  if (!step)
    return;
  kr3_msgs::ProgressHistory service;
  service.request.step = static_cast<std::uint32_t>(*step);
  try
  {
    callService(progress_, service);
    window_.beginsAt(static_cast<int>(service.response.first_step));
  }
  catch (const FailedPrecondition&)  // it is inconsistent: that has to be mended first
  {
  }
}

void RosReasoner::addRecords(const std::vector<reasoner::Record>& records)
{
  kr3_msgs::AddRecords service;
  service.request.expected_num_records = static_cast<std::uint32_t>(window_.all().size());
  service.request.records = toMsg(records);
  callService(add_records_, service);
  window_.add(records);
  if (!records.empty())
    progressIfDue();
}

void RosReasoner::synchronise()
{
  try
  {
    addRecords({});
  }
  catch (const FailedPrecondition&)
  {
    ROS_WARN("the reasoner holds another history; telling it again");
    setHistory(std::vector<reasoner::Record>(window_.all()));
  }
}

reasoner::Diagnosis RosReasoner::diagnose()
{
  synchronise();
  kr3_msgs::Diagnose service;
  callService(diagnose_, service);
  reasoner::Diagnosis diagnosis;
  diagnosis.consistent = service.response.consistent;
  diagnosis.cost = static_cast<int>(service.response.cost);
  diagnosis.conflict = service.response.conflict;
  for (const auto& text : service.response.explanations)
  {
    diagnosis.explanations.emplace_back();
    for (std::size_t begin = 0; begin < text.size();)
    {
      const auto end = std::min(text.find(kSeparator, begin), text.size());
      diagnosis.explanations.back().push_back(text.substr(begin, end - begin));
      begin = end + kSeparator.size();
    }
  }
  for (const auto& alternative : service.response.alternatives)
  {
    diagnosis.in_words.push_back(alternative.in_words);
  }
  diagnosis.complete = service.response.complete;
  return diagnosis;
}

reasoner::Answer RosReasoner::entails(const std::string& literal, int step)
{
  synchronise();
  kr3_msgs::Entails service;
  service.request.literal = literal;
  service.request.step = static_cast<std::uint32_t>(step);
  callService(entails_, service);
  return static_cast<reasoner::Answer>(service.response.answer);
}

bool RosReasoner::possible(const std::string& literal, int step)
{
  synchronise();
  kr3_msgs::Entails service;
  service.request.literal = literal;
  service.request.step = static_cast<std::uint32_t>(step);
  callService(entails_, service);
  return service.response.possible;
}

std::vector<std::string> RosReasoner::entailedAt(int step)
{
  synchronise();
  kr3_msgs::GetState service;
  service.request.step = static_cast<std::uint32_t>(step);
  callService(get_state_, service);
  std::vector<std::string> literals;
  for (const auto& literal : service.response.literals)
    literals.push_back(literal.literal);
  return literals;
}

reasoner::Explanation RosReasoner::explain(const std::string& literal, int step)
{
  synchronise();
  kr3_msgs::ExplainLiteral service;
  service.request.literal = literal;
  service.request.step = static_cast<std::uint32_t>(step);
  callService(explain_, service);
  reasoner::Explanation explanation;
  explanation.entailed = service.response.entailed != 0;
  explanation.reasons = service.response.reasons;
  explanation.records = service.response.records;
  explanation.record_indices.assign(service.response.record_indices.begin(),
                                    service.response.record_indices.end());
  explanation.defaults = service.response.defaults;
  explanation.proof = fromMsg(service.response.proof);
  return explanation;
}

std::vector<reasoner::Retraction> RosReasoner::retractions(const std::string& literal, int step)
{
  synchronise();
  kr3_msgs::FindRetractions service;
  service.request.literal = literal;
  service.request.step = static_cast<std::uint32_t>(step);
  callService(find_retractions_, service);
  std::vector<reasoner::Retraction> retractions;
  for (const auto& message : service.response.retractions)
  {
    retractions.push_back({window_.amongAll({message.records.begin(), message.records.end()}),
                           message.log_odds, message.opens, message.in_words});
  }
  return retractions;
}

reasoner::PlanResult RosReasoner::plan(const std::string& goal, std::uint32_t max_plans,
                                       const std::atomic<bool>& cancel)
{
  synchronise();
  kr3_msgs::MakePlanGoal request;
  request.goal = goal;
  request.max_horizon = static_cast<std::uint32_t>(options_.max_horizon);
  request.all = static_cast<std::uint8_t>(max_plans > 1);
  request.max_plans = max_plans;
  const double time_s = std::chrono::duration<double>(options_.time_limit).count();
  request.time_limit = ros::Duration(time_s);
  // The node keeps its own limit; ours is for a node that hangs.
  const kr3_msgs::MakePlanResult answer = plan_.call(request, cancel, 2.0 * time_s + 5.0);
  throwIfFailed(answer.status, plan_.name());
  reasoner::PlanResult result;
  result.goal_entailed = answer.goal_entailed;
  result.reason = answer.reason;
  result.cpu_s = answer.cpu_s;
  result.complete = answer.complete != 0;
  for (const auto& plan : answer.plans)
    result.plans.push_back(fromMsg(plan));
  return result;
}

RosPolicyServer::RosPolicyServer(ros::NodeHandle nh)
  : nh_(nh)
  , solve_(nh, names::kSolve)
  , get_action_(nh.serviceClient<kr3_msgs::GetPolicyAction>(names::kGetAction))
{
}

std::vector<std::string> RosPolicyServer::missing()
{
  std::vector<std::string> missing;
  noteMissing(get_action_, missing);
  if (!solve_.connected())
    missing.push_back("action " + solve_.name());
  return missing;
}

SolvedPolicy RosPolicyServer::solve(const pomdp::Model& model, const SolveBudget& budget,
                                    const std::atomic<bool>& cancel)
{
  std::ostringstream text;
  pomdp::writePomdp(text, model);
  kr3_msgs::SolveGoal request;
  request.format = "pomdp";
  request.model = text.str();
  request.precision = budget.precision;
  request.max_backups = budget.max_backups;
  request.time_limit = ros::Duration(budget.time_s);
  const double patience_s = budget.time_s > 0.0 ? 2.0 * budget.time_s + 10.0 : 0.0;
  const kr3_msgs::SolveResult answer = solve_.call(request, cancel, patience_s);
  if (cancel)
    throw Cancelled("solving was cancelled");
  throwIfFailed(answer.status, solve_.name());
  return {answer.policy_id, answer.lower_bound, answer.upper_bound,
          answer.backups,   answer.cpu_s,       answer.cached != 0};
}

std::size_t RosPolicyServer::actionAt(const std::string& policy_id, const pomdp::Belief& belief)
{
  // A decision may ask thousands of times: one connection, not one for each.
  const auto connect = [this] {
    connected_action_ = nh_.serviceClient<kr3_msgs::GetPolicyAction>(names::kGetAction, true);
  };
  if (!connected_action_.isValid())
    connect();
  kr3_msgs::GetPolicyAction service;
  service.request.policy_id = policy_id;
  for (std::size_t state = 0; state < belief.size(); ++state)
  {
    if (belief[state] == 0.0)
      continue;
    service.request.states.push_back(static_cast<std::uint32_t>(state));
    service.request.belief.push_back(belief[state]);
  }
  callService(connected_action_, service, connect);
  return service.response.action_index;
}

RosExecutor::RosExecutor(ros::NodeHandle nh, const Bindings& bindings)
  : bindings_(bindings), watches_(nh, bindings.watches())
{
  for (const auto& name : bindings.servers())
    servers_[name] = std::make_unique<ActionPeer<kr3_msgs::ExecuteSkillAction>>(nh, name);
}

std::vector<std::string> RosExecutor::missing()
{
  std::vector<std::string> missing;
  for (auto& [name, server] : servers_)
  {
    if (!server->connected())
      missing.push_back("action " + name);
  }
  return missing;
}

LowLevelResult RosExecutor::execute(const LowLevelAction& action, const FluentLookup& believed,
                                    const std::atomic<bool>& cancel)
{
  const SkillCall call = bindings_.call(action, believed);
  kr3_msgs::ExecuteSkillGoal request;
  request.skill = call.skill;
  request.arguments = call.arguments;
  request.time_limit = ros::Duration(call.time_limit_s);
  watches_.begin();
  const kr3_msgs::ExecuteSkillResult answer = servers_.at(call.server)->call(request, cancel, 0.0);
  if (cancel)
    throw Cancelled(action.text + " was cancelled");
  throwIfFailed(answer.status, action.text + " by " + call.server);
  LowLevelResult result;
  result.outcome = answer.outcome;
  result.observation = bindings_.observation(action, answer.outcome, answer.observation);
  result.confidence = answer.confidence;
  result.duration_s = answer.duration_s;
  for (const auto& sighting : answer.sightings)
    result.sightings.push_back({sighting.literal, sighting.confidence});
  for (auto& sighting : watches_.sightings(believed))
    result.sightings.push_back(std::move(sighting));
  return result;
}

}  // namespace kr3::executive
