#include "online_controller.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include <kr3_common/error.hpp>

namespace kr3::executive
{
namespace
{

using refinement::StateId;

constexpr double kCertain = 1.0 - 1e-9;

}  // namespace

OnlineController::OnlineController(const DomainBelief& start, const reasoner::Formula& goal,
                                   double threshold, const BaselineOptions& options,
                                   const std::shared_ptr<BaselineCache>& cache)
  : goal_(goal)
  , objective_(objectiveFor(start.task().domain(), start.task().models()))
  , threshold_(threshold)
  , order_options_{options.online_candidates, options.online_prospects}
  , num_actions_(start.task().numActions())
  , num_hypotheses_(start.states().size())
{
  plan_ = testPlanFor(start, goal, *cache);
}

std::optional<SearchChoice> OnlineController::searchOrder(const Hypotheses& now)
{
  // By number, which does not depend on what earlier missions met first.
  std::map<std::uint32_t, double> probability_of;
  for (std::size_t i = 0; i < now.states.size(); ++i)
    probability_of[plan_->parts(now.states[i]).hidden] += now.probability[i];
  std::vector<std::uint32_t> hidden;
  std::vector<double> probability;
  for (const auto& [values, share] : probability_of)
  {
    hidden.push_back(values);
    probability.push_back(share);
  }
  std::vector<std::size_t> known;
  for (const std::uint32_t values : order_)
  {
    const auto at = std::lower_bound(hidden.begin(), hidden.end(), values);
    if (at != hidden.end() && *at == values)
      known.push_back(static_cast<std::size_t>(at - hidden.begin()));
  }
  const ProspectOf prospect = [&](std::size_t place, std::size_t hypothesis) {
    return plan_->prospect({static_cast<std::uint32_t>(place), hidden[hypothesis]});
  };
  auto found = orderOfTests(probability, plan_->parts(now.likeliestState()).place, prospect,
                            order_options_, known);
  order_.clear();
  if (found)
  {
    for (const std::size_t hypothesis : found->order)
      order_.push_back(hidden[hypothesis]);
  }
  return found;
}

std::optional<std::size_t> OnlineController::next(const DomainBelief& belief,
                                                  const std::atomic<bool>& cancel)
{
  if (cancel)
    throw Cancelled("planning was cancelled");
  const Hypotheses now = hypothesesOf(belief.states());
  const StateId likeliest = now.likeliestState();
  const auto toGoal = [&]() -> std::optional<std::size_t> {
    const auto& route = plan_->goalFrom(likeliest);
    return route && !route->steps.empty() ? std::optional(route->steps.front().action)
                                          : std::nullopt;
  };
  const double achieved = belief.probability(goal_);
  if (achieved > kCertain)
    return std::nullopt;
  const bool seems_done = belief.task().holds(goal_, likeliest);
  if (now.highest() > threshold_ && !seems_done)
    return toGoal();
  if (const auto action = plan_->orienting(belief, likeliest))
    return action;
  const auto search = searchOrder(now);
  if (!search)
    return toGoal();
  // Searching on until the goal is certain, against ending now.
  if (endWorth(objective_, achieved) >= objective_.success - search->expected_s)
    return std::nullopt;
  const auto state = plan_->state({plan_->parts(likeliest).place, order_.front()});
  return plan_->testFrom(*state)->steps.front().action;
}

std::string OnlineController::description() const
{
  return "planning online over the whole domain: " + std::to_string(num_hypotheses_) +
         " hypotheses, " + std::to_string(num_actions_) + " actions";
}

}  // namespace kr3::executive
