#include "online_service.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include <kr3_common/error.hpp>

#include "conversions.hpp"
#include "kr3_pomdp/names.hpp"

namespace kr3::pomdp
{

namespace
{

constexpr std::size_t kMaxPrepared = 2;
constexpr std::size_t kMaxScenarios = 100000;

}  // namespace

struct OnlineService::Prepared
{
  explicit Prepared(std::shared_ptr<const SolvedModel> model)
    : solved(std::move(model))
    , sampled(solved->model(), solved->policy ? &*solved->policy : nullptr)
  {
  }
  std::shared_ptr<const SolvedModel> solved;
  SampledModel sampled;  // refers to `solved`
};

std::shared_ptr<const OnlineService::Prepared> OnlineService::prepared(
    const std::shared_ptr<const SolvedModel>& solved)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = std::find_if(prepared_.begin(), prepared_.end(),
                                  [&solved](const auto& known) { return known->solved == solved; });
  if (found != prepared_.end())
  {
    prepared_.splice(prepared_.begin(), prepared_, found);
    return prepared_.front();
  }
  prepared_.push_front(std::make_shared<const Prepared>(solved));
  if (prepared_.size() > kMaxPrepared)
  {
    prepared_.pop_back();
  }
  return prepared_.front();
}

OnlineOptions OnlineService::optionsFrom(const kr3_msgs::PlanOnline::Request& request) const
{
  const double time_s = request.time_limit.toSec();
  if (time_s < 0.0 || time_s > limits_.max_time_s)
  {
    throw InvalidArgument("time limit " + std::to_string(time_s) + " s, expected it in [0, " +
                          std::to_string(limits_.max_time_s) + "] s (parameter max_online_time_s)");
  }
  if (request.num_scenarios > kMaxScenarios)
  {
    throw InvalidArgument(std::to_string(request.num_scenarios) + " scenarios, expected at most " +
                          std::to_string(kMaxScenarios));
  }
  OnlineOptions options;
  options.max_expansions = request.max_expansions;
  if (time_s > 0.0)
  {
    options.time_s = time_s;
  }
  else
  {
    options.time_s = request.max_expansions > 0 ? limits_.max_time_s : limits_.default_time_s;
  }
  options.num_scenarios =
      request.num_scenarios > 0 ? request.num_scenarios : limits_.default_scenarios;
  return options;
}

void OnlineService::plan(const kr3_msgs::PlanOnline::Request& request,
                         kr3_msgs::PlanOnline::Response& response)
{
  const OnlineOptions options = optionsFrom(request);
  std::shared_ptr<const SolvedModel> solved;
  std::optional<Belief> belief;
  if (!request.belief_id.empty())
  {
    if (!(request.policy_id.empty() && request.belief.empty() && request.states.empty()))
    {
      throw InvalidArgument("a kept belief and another, expected one of them");
    }
    const StoredBelief stored = store_->belief(request.belief_id);
    const KeptBelief::Snapshot now = stored.belief->snapshot();
    solved = stored.belief->sharedSolved();
    belief = now.belief;
    response.version = now.version;
  }
  else
  {
    solved = store_->policy(request.policy_id);
    const bool initial = request.belief.empty() && request.states.empty();
    belief = initial ? initialBelief(solved->model(), "")
                     : beliefFromMsg(request.belief, request.states, solved->model().numStates());
  }
  const auto ready = prepared(solved);
  const auto start = std::chrono::steady_clock::now();
  const OnlineDecision decision =
      OnlinePlanner(ready->sampled, options).plan(sampler(*belief), request.seed);
  response.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  response.action_index = static_cast<std::uint32_t>(decision.action);
  response.action = solved->model().actionName(decision.action);
  response.lower_bound = decision.lower;
  response.upper_bound = decision.upper;
  response.expansions = decision.expansions;
  response.num_nodes = decision.num_nodes;
}

void offerOnlineService(ros::NodeHandle& nh, const std::shared_ptr<PolicyStore>& store,
                        const OnlineLimits& limits, ServiceList& services)
{
  const auto service = std::make_shared<OnlineService>(store, limits);  // for calls under way
  services.offer<kr3_msgs::PlanOnline>(
      nh, names::kPlanOnline,
      [service](const auto& request, auto& response) { service->plan(request, response); });
}

}  // namespace kr3::pomdp
