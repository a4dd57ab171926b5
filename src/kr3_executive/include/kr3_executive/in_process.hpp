#pragma once

#include <memory>
#include <string>
#include <vector>

#include <kr3_pomdp/policy.hpp>

#include "kr3_executive/history_window.hpp"
#include "kr3_executive/interfaces.hpp"
#include "kr3_executive/policy_cache.hpp"

namespace kr3::executive
{

/// The reasoner as a library.
class InProcessReasoner : public HighLevelReasoner
{
public:
  InProcessReasoner(reasoner::Description description, reasoner::PlanOptions options,
                    const ReasonerSettings& settings = {});

  void setHistory(const std::vector<reasoner::Record>& records) override;
  void addRecords(const std::vector<reasoner::Record>& records) override;
  void suppose(const std::vector<reasoner::Record>& records) override;
  reasoner::Diagnosis diagnose() override;
  reasoner::Diagnosis minimalExplanations() override;
  bool isConsistent() override;
  reasoner::Answer entails(const std::string& literal, int step) override;
  bool possible(const std::string& literal, int step) override;
  std::vector<std::string> entailedAt(int step) override;
  reasoner::Explanation explain(const std::string& literal, int step) override;
  std::vector<reasoner::Retraction> retractions(const std::string& literal, int step) override;
  reasoner::PlanResult plan(const std::string& goal, std::uint32_t max_plans,
                            const std::atomic<bool>& cancel) override;
  std::optional<ReasonerSettings> settings() override { return settings_; }

private:
  void progressIfDue();

  reasoner::Reasoner reasoner_;
  reasoner::PlanOptions options_;
  ReasonerSettings settings_;
  HistoryWindow window_;
};

/// The solver as a library, with policies cached by the content of their models. Thread-safe.
class InProcessPolicyServer : public PolicyServer
{
public:
  /// @param cache  shared with other servers, of other threads too; null: one of its own
  explicit InProcessPolicyServer(std::shared_ptr<PolicyCache> cache = nullptr);

  /// `cpu_s` of a policy that was cached is what solving it once took.
  SolvedPolicy solve(const pomdp::Model& model, const SolveBudget& budget,
                     const std::atomic<bool>& cancel) override;
  SolvedPolicy solveFrom(const pomdp::Policy& first, const pomdp::Model& model,
                         const SolveBudget& budget, const std::atomic<bool>& cancel) override;
  std::size_t actionAt(const std::string& policy_id, const pomdp::Belief& belief) override;

  [[nodiscard]] PolicyCacheStats stats() const { return cache_->stats(); }
  [[nodiscard]] const std::shared_ptr<PolicyCache>& cache() const { return cache_; }

private:
  /// @param first  null: none
  SolvedPolicy solved(const PolicyCache::Key& key, const pomdp::Model& model,
                      const pomdp::Policy* first, const SolveBudget& budget,
                      const std::atomic<bool>& cancel);

  std::shared_ptr<PolicyCache> cache_;  // shared by the trials of several threads
};

}  // namespace kr3::executive
