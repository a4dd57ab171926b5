#include "replay_peers.hpp"

#include <chrono>
#include <utility>

#include <kr3_common/error.hpp>

namespace kr3::executive
{
namespace
{

/// Not the recorded wall time: a plan that was found then is found now, on any machine.
reasoner::PlanOptions patient(reasoner::PlanOptions options)
{
  constexpr std::chrono::hours kPatience{1};
  options.time_limit = kPatience;
  return options;
}

}  // namespace

InterruptedReasoner::InterruptedReasoner(reasoner::Description description,
                                         const reasoner::PlanOptions& options,
                                         const ReasonerSettings& settings,
                                         const Interruption& interruption)
  : InProcessReasoner(std::move(description), patient(options), settings)
  , interruption_(interruption)
{
}

void InterruptedReasoner::addRecords(const std::vector<reasoner::Record>& records)
{
  interruption_.raise();
  InProcessReasoner::addRecords(records);
}

reasoner::Diagnosis InterruptedReasoner::minimalExplanations()
{
  interruption_.raise();
  return InProcessReasoner::minimalExplanations();
}

reasoner::Diagnosis InterruptedReasoner::diagnose()
{
  interruption_.raise();
  return InProcessReasoner::diagnose();
}

reasoner::Answer InterruptedReasoner::entails(const std::string& literal, int step)
{
  interruption_.raise();
  return InProcessReasoner::entails(literal, step);
}

bool InterruptedReasoner::possible(const std::string& literal, int step)
{
  interruption_.raise();
  return InProcessReasoner::possible(literal, step);
}

std::vector<std::string> InterruptedReasoner::entailedAt(int step)
{
  interruption_.raise();
  return InProcessReasoner::entailedAt(step);
}

reasoner::Explanation InterruptedReasoner::explain(const std::string& literal, int step)
{
  interruption_.raise();
  return InProcessReasoner::explain(literal, step);
}

reasoner::PlanResult InterruptedReasoner::plan(const std::string& goal, std::uint32_t max_plans,
                                               const std::atomic<bool>& cancel)
{
  interruption_.raise();
  return InProcessReasoner::plan(goal, max_plans, cancel);
}

ReplayedPolicies::ReplayedPolicies(Budget budget, std::function<bool()> is_lost,
                                   const Interruption& interruption)
  : budget_(std::move(budget)), is_lost_(std::move(is_lost)), interruption_(interruption)
{
}

SolvedPolicy ReplayedPolicies::solve(const pomdp::Model& model, const SolveBudget& budget,
                                     const std::atomic<bool>& cancel)
{
  interruption_.raise();
  return InProcessPolicyServer::solve(model, budget_(budget), cancel);
}

std::size_t ReplayedPolicies::actionAt(const std::string& policy_id, const pomdp::Belief& belief)
{
  interruption_.raise();
  if (is_lost_())
    throw NotFound("policy '" + policy_id + "'");
  return InProcessPolicyServer::actionAt(policy_id, belief);
}

}  // namespace kr3::executive
