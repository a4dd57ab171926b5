#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <kr3_reasoner/reasoner.hpp>
#include <kr3_refinement/pomdp_task.hpp>

#include "kr3_executive/content_cache.hpp"
#include "kr3_executive/task_cache.hpp"

namespace kr3::executive
{

/// Seconds that the low level is expected to spend on one high-level action.
struct Effort
{
  double success_s = 0.0;  ///< until its effects hold, when what is assumed is so
  double failure_s = 0.0;  ///< until the assumption is refuted, when it is not so
  bool checks = false;     ///< the action looks for what is assumed; else failure_s says nothing
};

/// A plan with the probability of the hypothesis on which it rests.
struct WeightedPlan
{
  reasoner::Plan plan;  ///< one action a step
  double probability = 1.0;
};

/// What carrying out a plan costs from some state.
struct PlanEffort
{
  double before_s = 0.0;   ///< until the action that checks the hypothesis
  double success_s = 0.0;  ///< from there to the goal, if it holds
  double failure_s = 0.0;  ///< from there to its refutation, if not
  std::shared_ptr<const HighLevelState> refuted = {};  ///< the state then
};

/// Lines 4-6 of Algorithm 1: the expected low-level cost of plans, from the learned models alone;
/// no policy is solved. The formulas are in docs/control_loop.md.
///
/// An action's effort comes from the POMDP that is generated for it: the expected cost of reaching
/// its effects when the state is known (a shortest path among chances: repeated failures, slips and
/// distances count), and, where it rests on an assumption, that of looking through the components
/// one after the other, nearest first, with as many looks as the sensor's errors call for.
///
/// The cost of a plan among several with different hypotheses is the expected time to the goal when
/// the mission begins with it and goes on with the others in the best order: with probability P_i
/// its hypothesis holds; otherwise the time to find that out is spent, and the others remain. (For
/// checks whose costs do not depend on the order this is the rule to look where P/cost is largest.)
///
/// Thread-safe. Efforts are kept by the content of the state, the action or plan, and the numbers.
class PlanCosts
{
public:
  explicit PlanCosts(std::shared_ptr<TaskCache> tasks) : tasks_(std::move(tasks)) {}

  [[nodiscard]] TaskCache& tasks() const { return *tasks_; }

  /// @param state      what the high level believes, without any hypothesis, as literals `f = v`
  /// @param plans      their probabilities sum to 1 where they exclude each other
  /// @param threshold  belief that counts as knowledge, in (0.5, 1)
  /// @param prior      belief in an assumption when the low level begins to check it, in (0, 1)
  /// @return seconds, shape [plans]; infinite where an action of a plan cannot be carried out
  [[nodiscard]] std::vector<double> expected(const std::vector<reasoner::Literal>& state,
                                             const std::vector<WeightedPlan>& plans,
                                             double threshold, double prior);

  /// @param assumed  the literals among `state` that are assumptions
  /// @throws FailedPrecondition  the action is impossible in the state, or changes nothing
  [[nodiscard]] Effort effort(const std::vector<reasoner::Literal>& state,
                              const std::string& action, const std::vector<std::string>& assumed,
                              double threshold, double prior);

  [[nodiscard]] ContentCacheStats effortStats() const { return efforts_.stats(); }
  [[nodiscard]] ContentCacheStats planStats() const { return plans_.stats(); }

private:
  [[nodiscard]] Effort effort(const HighLevelState& state, const std::string& action,
                              const std::vector<std::string>& assumed, double threshold,
                              double prior);
  [[nodiscard]] std::shared_ptr<const PlanEffort> walked(const HighLevelState& state,
                                                         const reasoner::Plan& plan,
                                                         double threshold, double prior);

  std::shared_ptr<TaskCache> tasks_;
  ContentCache<Effort> efforts_;
  ContentCache<PlanEffort> plans_;
};

/// The effort of a task whose start belief has mass `prior` on the assumed value.
/// @param assumed  the hidden fluent that is looked for, as the task names it; empty: none
[[nodiscard]] Effort effortOf(const refinement::PomdpTask& task, const std::string& assumed,
                              double threshold, double prior);

}  // namespace kr3::executive
