#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <kr3_pomdp/model.hpp>

#include "coarse_plan.hpp"
#include "kr3_executive/interfaces.hpp"
#include "kr3_executive/low_level_task.hpp"

namespace kr3::executive
{

/// A belief over states of the high level.
using CoarseBelief = std::map<refinement::StateId, double>;

/// What the rest of the mission is worth if it begins with an action: a linear function of the
/// probability that the action which was begun is possible.
struct EndingLine
{
  std::optional<std::size_t> next;  ///< of the high level; nothing: the mission ends
  double if_possible = 0.0;
  double if_impossible = 0.0;
};

/// What a lower task is begun with, seen from above.
struct CoarseStart
{
  refinement::StateId supposed = 0;  ///< a state in which the action is possible
  CoarseBelief possible;             ///< the belief's states in which it is, not empty
  CoarseBelief impossible;

  [[nodiscard]] double probability() const;  ///< that it is possible
  /// The same belief but for that probability.
  [[nodiscard]] CoarseBelief at(double probability) const;
};

/// The belief taken apart by whether an action is possible.
[[nodiscard]] CoarseStart coarseStart(CoarsePlan& plan, const CoarseBelief& belief,
                                      refinement::StateId supposed, std::size_t action);

/// What the rest of the mission is worth by what is done next, as functions of the probability that
/// the start's action is possible: the greatest counts. Not empty.
using EndingsOf = std::function<std::vector<EndingLine>(const CoarseStart&, bool unchanged)>;

/// The task's model with several actions in the place of `finish`; the first has its index. Each
/// ends the task and earns what is said of one thing to do next. So a policy of the model ends
/// where the rest of the mission is worth more than going on, by what is believed then.
/// @param endings  asked for the start (`unchanged`), and for what it becomes where the task
///                 changes what is known
/// @param outside  what it is worth that an outcome has left the zoom
[[nodiscard]] pomdp::Model withEndings(const refinement::PomdpTask& task, CoarsePlan& plan,
                                       const CoarseStart& start, const EndingsOf& endings,
                                       double outside);

/// How a high-level action comes out, carried out by a low-level policy. Weights of an outcome
/// after k low-level actions are discounted by k - 1 of them: the upper level's model discounts
/// once.
struct OptionOutcomes
{
  /// What the upper level is told: that it succeeded, or how much speaks for its being possible.
  static constexpr std::size_t kSucceeded = 0;
  static constexpr std::size_t kNumTold = 9;

  struct Case
  {
    double cost = 0.0;  ///< discounted seconds
    /// Of having succeeded and of having changed nothing, with what is told.
    std::vector<double> succeeded = std::vector<double>(kNumTold, 0.0);
    std::vector<double> unchanged = std::vector<double>(kNumTold, 0.0);
  };
  Case possible;
  Case impossible;
};

/// A lower task ready to be solved and simulated.
struct LowerProblem
{
  LowLevelTask begun;
  pomdp::Model model;  ///< of the task, or with endings
};

/// Simulates a policy of the problem's model, half the runs where the action is possible, and adds
/// up what a run shows by the probabilities of both that it leaves believed, so that no error is
/// held for impossible because no run made it.
[[nodiscard]] OptionOutcomes simulatedOutcomes(const LowerProblem& problem, PolicyServer& policies,
                                               const std::string& policy,
                                               const OptionTrials& trials, double discount);

}  // namespace kr3::executive
