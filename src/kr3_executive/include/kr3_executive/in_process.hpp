#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include <kr3_pomdp/policy.hpp>

#include "kr3_executive/interfaces.hpp"

namespace kr3::executive
{

/// The reasoner as a library.
class InProcessReasoner : public HighLevelReasoner
{
public:
  InProcessReasoner(reasoner::Description description, reasoner::PlanOptions options);

  void setHistory(const std::vector<reasoner::Record>& records) override;
  void addRecords(const std::vector<reasoner::Record>& records) override;
  reasoner::Diagnosis diagnose() override;
  reasoner::Answer entails(const std::string& literal, int step) override;
  bool possible(const std::string& literal, int step) override;
  std::vector<std::string> entailedAt(int step) override;
  reasoner::Explanation explain(const std::string& literal, int step) override;
  reasoner::PlanResult plan(const std::string& goal, const std::atomic<bool>& cancel) override;

private:
  reasoner::Reasoner reasoner_;
  reasoner::PlanOptions options_;
};

/// The solver as a library, with a cache by the content of the model.
class InProcessPolicyServer : public PolicyServer
{
public:
  SolvedPolicy solve(const pomdp::Model& model, const SolveBudget& budget,
                     const std::atomic<bool>& cancel) override;
  std::size_t actionAt(const std::string& policy_id, const pomdp::Belief& belief) override;

private:
  struct Entry
  {
    SolvedPolicy solved;
    pomdp::Policy policy;
  };
  std::map<std::string, Entry> policies_;  // by id, a hash of the model's text and the budget
};

}  // namespace kr3::executive
