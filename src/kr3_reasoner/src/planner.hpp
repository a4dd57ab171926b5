#pragma once

#include <atomic>
#include <vector>

#include "kr3_reasoner/reasoner.hpp"
#include "models.hpp"
#include "plan_program.hpp"

namespace kr3::reasoner
{

/// Finds plans from the current step of a history (docs/semantics_tests.md, row 8). Private to the
/// package.
///
/// A plan found in one model is only a proposal. It is then tried in all models with minimal
/// explanations: a counterexample (an action that is impossible or leads nowhere, the goal missed,
/// a higher cost where the cheapest plan is wanted) says on which unknown fluents it depends, and
/// those make the hypothesis, minimized literal by literal. Models that a hypothesis covers are
/// left out of the next search, so there is one plan for each hypothesis.
class Planner
{
public:
  /// All must outlive the planner.
  Planner(DomainKnowledge& domain, const HistoryProgram& program,
          const std::vector<CheckedRecord>& records, int current_step, const Optimum& optimum,
          const Consequences& consequences);

  /// @throws as Reasoner::plan
  [[nodiscard]] PlanResult plan(const Formula& goal, const PlanOptions& options,
                                const std::atomic<bool>* cancel) const;

private:
  class Search;

  PlanningProblem problem_;
};

}  // namespace kr3::reasoner
