#include "kr3_executive/in_process.hpp"

#include <cstdint>
#include <cstdio>
#include <sstream>
#include <utility>

#include <kr3_common/error.hpp>
#include <kr3_pomdp/pomdp_format.hpp>
#include <kr3_pomdp/solver.hpp>

namespace kr3::executive
{
namespace
{

/// FNV-1a with two offsets: 128 bits, so that different models do not meet by chance.
std::string contentHash(const std::string& text)
{
  std::uint64_t low = 1469598103934665603ULL;
  std::uint64_t high = 1099511628211ULL * 31;
  for (const char c : text)
  {
    low = (low ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
    high = (high ^ (low >> 32U)) * 1099511628211ULL;
  }
  char hash[40];
  std::snprintf(hash, sizeof hash, "%016llx%016llx", static_cast<unsigned long long>(high),
                static_cast<unsigned long long>(low));
  return hash;
}

}  // namespace

InProcessReasoner::InProcessReasoner(reasoner::Description description,
                                     reasoner::PlanOptions options)
  : reasoner_(std::move(description)), options_(options)
{
}

void InProcessReasoner::setHistory(const std::vector<reasoner::Record>& records)
{
  reasoner_.setHistory(records);
}

void InProcessReasoner::addRecords(const std::vector<reasoner::Record>& records)
{
  reasoner_.addRecords(records);
}

reasoner::Diagnosis InProcessReasoner::diagnose()
{
  return reasoner_.diagnose();
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

reasoner::PlanResult InProcessReasoner::plan(const std::string& goal,
                                             const std::atomic<bool>& cancel)
{
  return reasoner_.plan(goal, options_, &cancel);
}

SolvedPolicy InProcessPolicyServer::solve(const pomdp::Model& model, const SolveBudget& budget,
                                          const std::atomic<bool>& cancel)
{
  std::ostringstream text;
  pomdp::writePomdp(text, model);
  text << budget.precision << ' ' << budget.time_s << ' ' << budget.max_backups;
  const std::string id = contentHash(text.str());
  if (const auto found = policies_.find(id); found != policies_.end())
  {
    SolvedPolicy solved = found->second.solved;
    solved.cached = true;
    return solved;
  }
  auto result = pomdp::solve(model, {budget.precision, budget.time_s, budget.max_backups},
                             [&cancel](const pomdp::SolverProgress&) { return !cancel; });
  if (cancel)
    throw Cancelled("solving was cancelled");
  SolvedPolicy solved{id, result.lower, result.upper, result.backups, result.cpu_s, false};
  policies_.insert_or_assign(id, Entry{solved, std::move(result.policy)});
  return solved;
}

std::size_t InProcessPolicyServer::actionAt(const std::string& policy_id,
                                            const pomdp::Belief& belief)
{
  const auto found = policies_.find(policy_id);
  if (found == policies_.end())
    throw NotFound("policy '" + policy_id + "'");
  return found->second.policy.actionAt(belief);
}

}  // namespace kr3::executive
