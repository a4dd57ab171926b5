#include "kr3_executive/in_process.hpp"

#include <cstdint>
#include <utility>

#include <kr3_common/error.hpp>
#include <kr3_pomdp/solver.hpp>

namespace kr3::executive
{
bool SolvedPolicy::isCutShort(const SolveBudget& budget) const
{
  const bool precise = upper - lower <= budget.precision;
  const bool worked = budget.max_backups > 0 && backups >= budget.max_backups;
  return !precise && !worked;
}

InProcessReasoner::InProcessReasoner(reasoner::Description description,
                                     reasoner::PlanOptions options,
                                     const ReasonerSettings& settings)
  : reasoner_(std::move(description), settings.options)
  , options_(std::move(options))
  , settings_(settings)
  , window_(settings.history_window)
{
}

void InProcessReasoner::setHistory(const std::vector<reasoner::Record>& records)
{
  suppose(records);
  progressIfDue();
}

void InProcessReasoner::suppose(const std::vector<reasoner::Record>& records)
{
  reasoner_.setHistory(records);
  window_.reset(records);
}

void InProcessReasoner::progressIfDue()
{
  const auto step = window_.due();
  if (!step)
    return;
  try
  {
    window_.beginsAt(reasoner_.progress(*step).first_step);
  }
  catch (const FailedPrecondition&)  // it is inconsistent: that has to be mended first
  {
  }
}

void InProcessReasoner::addRecords(const std::vector<reasoner::Record>& records)
{
  reasoner_.addRecords(records);
  window_.add(records);
  progressIfDue();
}

reasoner::Diagnosis InProcessReasoner::diagnose()
{
  return reasoner_.diagnose();
}

reasoner::Diagnosis InProcessReasoner::minimalExplanations()
{
  return reasoner_.minimalExplanations();
}

bool InProcessReasoner::isConsistent()
{
  return reasoner_.isConsistent();
}

reasoner::Answer InProcessReasoner::entails(const std::string& literal, int step)
{
  return reasoner_.entails(literal, step);
}

bool InProcessReasoner::possible(const std::string& literal, int step)
{
  return reasoner_.possible(literal, step);
}

std::vector<std::string> InProcessReasoner::entailedAt(int step)
{
  std::vector<std::string> literals;
  for (const auto& literal : reasoner_.entailedAt(step))
    literals.push_back(reasoner::toString(literal));
  return literals;
}

reasoner::Explanation InProcessReasoner::explain(const std::string& literal, int step)
{
  return reasoner_.explain(literal, step);
}

std::vector<reasoner::Retraction> InProcessReasoner::retractions(const std::string& literal,
                                                                 int step)
{
  auto found = literal.empty() ? reasoner_.retractions() : reasoner_.retractionsFor(literal, step);
  for (auto& retraction : found)
    retraction.records = window_.amongAll(retraction.records);
  return found;
}

reasoner::PlanResult InProcessReasoner::plan(const std::string& goal, std::uint32_t max_plans,
                                             const std::atomic<bool>& cancel)
{
  reasoner::PlanOptions options = options_;
  options.all = max_plans > 1;
  options.max_plans = static_cast<int>(max_plans);
  return reasoner_.plan(goal, options, &cancel);
}

InProcessPolicyServer::InProcessPolicyServer(std::shared_ptr<PolicyCache> cache)
  : cache_(cache ? std::move(cache) : std::make_shared<PolicyCache>())
{
}

SolvedPolicy InProcessPolicyServer::solve(const pomdp::Model& model, const SolveBudget& budget,
                                          const std::atomic<bool>& cancel)
{
  return solved(PolicyCache::keyOf(model, budget), model, nullptr, budget, cancel);
}

SolvedPolicy InProcessPolicyServer::solveFrom(const pomdp::Policy& first, const pomdp::Model& model,
                                              const SolveBudget& budget,
                                              const std::atomic<bool>& cancel)
{
  const PolicyCache::Key of_model = PolicyCache::keyOf(model, budget);
  Fingerprinter key;
  key.add(of_model.high);
  key.add(of_model.low);
  for (const auto& vector : first.alphaVectors())
  {
    key.add(static_cast<std::uint64_t>(vector.action));
    key.add(static_cast<std::uint64_t>(vector.states.size()));
    for (const std::uint32_t state : vector.states)
      key.add(static_cast<std::uint64_t>(state));
    for (const double value : vector.values)
      key.add(value);
  }
  return solved(key.result(), model, &first, budget, cancel);
}

SolvedPolicy InProcessPolicyServer::solved(const PolicyCache::Key& key, const pomdp::Model& model,
                                           const pomdp::Policy* first, const SolveBudget& budget,
                                           const std::atomic<bool>& cancel)
{
  const PolicyCache::Found found = cache_->findOrSolve(
      key, model,
      [&] {
    pomdp::SolverLimits limits;
    limits.precision = budget.precision;
    limits.time_s = budget.time_s;
    limits.max_backups = budget.max_backups;
    pomdp::SolveResult result = pomdp::solve(
        model, limits, [&cancel](const pomdp::SolverProgress&) { return !cancel; }, first);
    if (cancel)
      throw Cancelled("solving was cancelled");
    return CachedPolicy{std::move(result.policy), result.lower, result.upper, result.backups,
                        result.cpu_s};
      },
      cancel);
  const CachedPolicy& policy = *found.policy;
  return {toString(key), policy.lower, policy.upper, policy.backups, policy.cpu_s, found.cached};
}

std::size_t InProcessPolicyServer::actionAt(const std::string& policy_id,
                                            const pomdp::Belief& belief)
{
  const auto key = parseFingerprint(policy_id);
  const auto found = key ? cache_->find(*key) : nullptr;
  if (!found)
    throw NotFound("policy '" + policy_id + "'");
  return found->policy.actionAt(belief);
}

}  // namespace kr3::executive
