#include "flat_controller.hpp"

#include <cstdio>
#include <utility>

#include <kr3_common/error.hpp>

#include "search_policy.hpp"

namespace kr3::executive
{

SolvedPolicy solvedFlat(const FlatModel& model, TestPlan& tests, const DomainBelief& start,
                        double threshold, const BaselineOptions& options, PolicyServer& policies,
                        const std::atomic<bool>& cancel)
{
  const auto first = searchPolicy(model, tests, start, threshold,
                                  {options.online_candidates, options.online_prospects});
  return first ? policies.solveFrom(*first, model.model, options.budget, cancel)
               : policies.solve(model.model, options.budget, cancel);
}

FlatController::FlatController(const DomainBelief& start, const reasoner::Formula& goal,
                               double threshold, PolicyServer& policies,
                               const BaselineOptions& options, std::shared_ptr<BaselineCache> cache,
                               const std::atomic<bool>& cancel)
  : goal_(goal)
  , threshold_(threshold)
  , policies_(policies)
  , options_(options)
  , cache_(std::move(cache))
{
  plan(start, cancel);
}

SolvedPolicy FlatController::solve(const FlatModel& model, const DomainBelief& start,
                                   const std::atomic<bool>& cancel)
{
  const auto tests = testPlanFor(start, goal_, *cache_);
  return solvedFlat(model, *tests, start, threshold_, options_, policies_, cancel);
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
    SolvedPolicy policy = solve(model, start, cancel);
    const Objective objective = objectiveFor(task.domain(), task.models());
    kept = std::make_shared<FlatPlan>(FlatPlan{std::move(model), std::move(policy),
                                               objective.success - objective.wrong_finish, start});
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
    plan_->policy = solve(plan_->model, plan_->start, cancel);
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
