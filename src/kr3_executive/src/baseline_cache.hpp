#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>

#include <kr3_refinement/domain_task.hpp>

#include "flat_model.hpp"
#include "kr3_executive/domain_belief.hpp"
#include "kr3_executive/interfaces.hpp"

namespace kr3::executive
{

class CoarsePlan;
class CoarsePolicy;
class TestPlan;

/// A flat model with the policy found for it.
struct FlatPlan
{
  FlatModel model;
  SolvedPolicy policy;
  double stake = 0.0;  ///< reward of success less that of a wrong end
  DomainBelief start;  ///< for which it was solved
};

/// What does not change from one mission to the next, by what it depends on. For one domain, its
/// models and one policy server.
class BaselineCache
{
public:
  std::map<std::string, std::set<std::string>> constants;  ///< by goal and history
  std::map<std::set<std::string>, std::shared_ptr<refinement::DomainTask>> tasks;
  std::map<std::string, refinement::InitialKnowledge> knowledge;  ///< by goal, history and bias
  std::map<std::string, std::shared_ptr<FlatPlan>> flat;          ///< by task, goal and belief
  std::map<std::string, std::string> too_large;                   ///< likewise: what was said
  std::map<std::string, std::shared_ptr<CoarsePlan>> coarse;      ///< likewise
  /// Likewise; null where the upper level is too large.
  std::map<std::string, std::shared_ptr<CoarsePolicy>> coarse_policies;
  std::map<std::string, std::shared_ptr<TestPlan>> tests;  ///< likewise
};

/// A key for what depends on a task, a goal and a belief over its states.
[[nodiscard]] std::string keyOf(const refinement::DomainTask& task, const std::string& goal,
                                const refinement::SparseBelief& belief);

/// The plan of tests for a start, kept in the cache.
[[nodiscard]] std::shared_ptr<TestPlan> testPlanFor(const DomainBelief& start,
                                                    const reasoner::Formula& goal,
                                                    BaselineCache& cache);

}  // namespace kr3::executive
