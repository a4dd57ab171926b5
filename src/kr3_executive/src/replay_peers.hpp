#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "kr3_executive/in_process.hpp"

/// Reasoner and policy server of a replay: those in process, which fail where the recorded ones
/// did.
namespace kr3::executive
{

/// A recorded failure that is still to happen.
struct Interruption
{
  std::function<void()> error;  ///< throws; empty when nothing is to happen

  void raise() const
  {
    if (error)
      error();
  }
};

class InterruptedReasoner : public InProcessReasoner
{
public:
  /// @param interruption  must outlive the reasoner
  InterruptedReasoner(reasoner::Description description, const reasoner::PlanOptions& options,
                      const ReasonerSettings& settings, const Interruption& interruption);

  void addRecords(const std::vector<reasoner::Record>& records) override;
  reasoner::Diagnosis diagnose() override;
  reasoner::Diagnosis minimalExplanations() override;
  reasoner::Answer entails(const std::string& literal, int step) override;
  bool possible(const std::string& literal, int step) override;
  std::vector<std::string> entailedAt(int step) override;
  reasoner::Explanation explain(const std::string& literal, int step) override;
  /// As long as it takes: time limits are not repeatable.
  reasoner::PlanResult plan(const std::string& goal, std::uint32_t max_plans,
                            const std::atomic<bool>& cancel) override;

private:
  const Interruption& interruption_;
};

class ReplayedPolicies : public InProcessPolicyServer
{
public:
  using Budget = std::function<SolveBudget(const SolveBudget&)>;

  /// @param budget        what to solve with instead
  /// @param is_lost       whether the policy that is asked for is unknown, as after a restart
  /// @param interruption  must outlive the server
  ReplayedPolicies(Budget budget, std::function<bool()> is_lost, const Interruption& interruption);

  SolvedPolicy solve(const pomdp::Model& model, const SolveBudget& budget,
                     const std::atomic<bool>& cancel) override;
  std::size_t actionAt(const std::string& policy_id, const pomdp::Belief& belief) override;

private:
  Budget budget_;
  std::function<bool()> is_lost_;
  const Interruption& interruption_;
};

}  // namespace kr3::executive
