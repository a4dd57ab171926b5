#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include <kr3_pomdp/model.hpp>
#include <kr3_pomdp/policy.hpp>
#include <kr3_pomdp/solver.hpp>

#include "coarse_plan.hpp"
#include "flat_model.hpp"
#include "lower_level.hpp"

namespace kr3::executive
{

/// What the upper level may do at a belief.
struct CoarseChoice
{
  bool is_finish = true;
  std::size_t action = 0;   ///< of the high level
  std::size_t variant = 0;  ///< where its possibility is hidden: how likely it is taken to be
  double value = 0.0;       ///< expected reward from here on
};

/// How an action comes out in a state where it is possible, by the variant.
using OutcomesOf = std::function<const OptionOutcomes&(refinement::StateId state,
                                                       std::size_t action, std::size_t variant)>;

/// The upper level of the hierarchy as a POMDP that is solved ahead.
///
/// States are those of the high level, with `done`. Time passes as on the low level: after an
/// option of k low-level steps the discount is that of k steps, by a transition to `done`. An
/// action that is impossible whatever is hidden is never begun; one whose possibility is hidden
/// comes out as its low-level policy was simulated to, and tells how much speaks for its being
/// possible.
///
/// Source: Sutton, Precup and Singh (1999), options; the discount of a semi-Markov process.
class CoarsePolicy
{
public:
  struct Limits
  {
    std::size_t max_rows = 400000;  ///< of actions times states
    pomdp::SolverLimits solver;
  };

  /// @param plan      must outlive the policy
  /// @param variants  of each action whose possibility is hidden
  /// @throws ResourceExhausted  the model is larger than that
  CoarsePolicy(CoarsePlan& plan, const CoarseBelief& start, const Objective& objective,
               std::size_t variants, const OutcomesOf& outcomes, const Limits& limits,
               const std::atomic<bool>& cancel);

  /// Every choice once, the best first; all variants of an action are one. Empty when the belief is
  /// not over the model's states.
  [[nodiscard]] std::vector<CoarseChoice> ranked(const CoarseBelief& belief) const;

  /// What the mission is worth at a belief. @return nothing when it is not over the model's states
  [[nodiscard]] std::optional<double> value(const CoarseBelief& belief) const;

  /// A lower task's model whose endings are worth what this level expects of the rest of the
  /// mission. Where nothing has changed but what is believed, what is done next is not the same
  /// again: the task can go on with that by itself.
  [[nodiscard]] pomdp::Model paid(const refinement::PomdpTask& task, CoarsePlan& plan,
                                  const CoarseStart& start, std::size_t action) const;

  /// Bounds of the model's value at the start.
  [[nodiscard]] double lower() const { return lower_; }
  [[nodiscard]] double upper() const { return upper_; }
  /// Whether they are close enough for the policy to be followed and its values to be paid by.
  [[nodiscard]] bool isGood() const;
  [[nodiscard]] std::size_t numStates() const { return states_.size(); }

private:
  [[nodiscard]] std::optional<pomdp::Belief> dense(const CoarseBelief& belief) const;
  void enumerate(CoarsePlan& plan, const CoarseBelief& start, std::size_t max_rows);
  void findChoices(CoarsePlan& plan, std::size_t variants);
  [[nodiscard]] pomdp::Model build(CoarsePlan& plan, const CoarseBelief& start,
                                   const OutcomesOf& outcomes) const;
  /// Expected reward of an action of the model and the best that follows.
  [[nodiscard]] double actionValue(const pomdp::Belief& belief, std::size_t action) const;

  /// The actions that may be best next, seen from anywhere in the likeliest state, with their
  /// values; `without` is left out.
  [[nodiscard]] std::vector<EndingLine> actionValues(CoarsePlan& plan, const pomdp::Belief& belief,
                                                     std::optional<std::size_t> without) const;
  [[nodiscard]] double valueIfNext(const pomdp::Belief& belief,
                                   std::optional<std::size_t> action) const;

  [[nodiscard]] std::vector<EndingLine> endings(CoarsePlan& plan, const CoarseStart& start,
                                                std::optional<std::size_t> without) const;
  /// What the way to the goal is worth if the state is known.
  [[nodiscard]] EndingLine routeValue(CoarsePlan& plan, refinement::StateId state) const;

  Objective objective_;
  std::vector<refinement::StateId> states_;
  std::unordered_map<refinement::StateId, std::size_t> number_;
  std::vector<CoarseChoice> choices_;  ///< actions of the model, without `finish`
  /// Of each high-level action where it is possible: the state that follows.
  std::vector<std::unordered_map<std::size_t, std::size_t>> results_;
  std::optional<pomdp::Model> model_;
  std::optional<pomdp::Policy> policy_;
  double lower_ = 0.0;
  double upper_ = 0.0;
};

}  // namespace kr3::executive
