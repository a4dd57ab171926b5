#include "flat_controller.hpp"

#include <cstdio>
#include <utility>

#include <kr3_common/error.hpp>

namespace kr3::executive
{

FlatController::FlatController(const DomainBelief& start, const reasoner::Formula& goal,
                               PolicyServer& policies, const BaselineOptions& options,
                               std::shared_ptr<BaselineCache> cache,
                               const std::atomic<bool>& cancel)
  : goal_(goal), policies_(policies), options_(options), cache_(std::move(cache))
{
  plan(start, cancel);
}

void FlatController::plan(const DomainBelief& start, const std::atomic<bool>& cancel)
{
  auto& task = start.task();
  const std::string key = keyOf(task, reasoner::toString(goal_), start.states());
  if (const auto known = cache_->too_large.find(key); known != cache_->too_large.end())
    throw ResourceExhausted(known->second);
  auto& kept = cache_->flat[key];
  if (!kept)
  {
    std::optional<FlatModel> found;
    try
    {
      found = flatModel(task, start.states(), goal_, objectiveFor(task.domain(), task.models()),
                        options_.max_rows);
    }
    catch (const ResourceExhausted& e)
    {
      cache_->too_large[key] = e.what();
      throw;
    }
    FlatModel& model = *found;
    SolvedPolicy policy = policies_.solve(model.model, options_.budget, cancel);
    const Objective objective = objectiveFor(task.domain(), task.models());
    kept = std::make_shared<FlatPlan>(
        FlatPlan{std::move(model), std::move(policy), objective.success - objective.wrong_finish});
  }
  plan_ = kept;
}

std::optional<std::size_t> FlatController::next(const DomainBelief& belief,
                                                const std::atomic<bool>& cancel)
{
  std::optional<pomdp::Belief> dense;
  try
  {
    dense = plan_->model.belief(belief.states());
  }
  catch (const FailedPrecondition&)  // something happened that no law allows: plan anew from here
  {
    plan(belief, cancel);
    dense = plan_->model.belief(belief.states());
  }
  std::size_t action = 0;
  try
  {
    action = policies_.actionAt(plan_->policy.id, *dense);
  }
  catch (const NotFound&)  // the server was restarted: tell it again
  {
    plan_->policy = policies_.solve(plan_->model.model, options_.budget, cancel);
    action = policies_.actionAt(plan_->policy.id, *dense);
  }
  return action == plan_->model.finishAction() ? std::nullopt : std::optional(action);
}

double FlatController::relativeGap() const
{
  return (plan_->policy.upper - plan_->policy.lower) / plan_->stake;
}

std::string FlatController::description() const
{
  char bounds[64];
  std::snprintf(bounds, sizeof bounds, "[%.1f, %.1f]", plan_->policy.lower, plan_->policy.upper);
  const auto& model = plan_->model.model;
  return "policy for the whole domain: " + std::to_string(model.numStates()) + " states, " +
         std::to_string(model.numActions()) + " actions, value in " + bounds + " after " +
         std::to_string(plan_->policy.backups) + " backups";
}

}  // namespace kr3::executive
