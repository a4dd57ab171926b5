#pragma once

#include <cstddef>
#include <string>
#include <unordered_map>
#include <vector>

#include <kr3_pomdp/model.hpp>
#include <kr3_reasoner/language.hpp>
#include <kr3_refinement/domain_task.hpp>

namespace kr3::executive
{

/// What ending a mission earns, and how later costs count.
struct Objective
{
  double success = 0.0;       ///< the goal holds
  double given_up = 0.0;      ///< it cannot be reached
  double wrong_finish = 0.0;  ///< it could be
  double discount = 1.0;

  /// What a mission can win or lose by how it ends.
  [[nodiscard]] double stake() const { return success - wrong_finish; }
};

/// The models' rewards are for tasks of one or two wholes (a room to search). For a domain of n
/// wholes rewards are n / 2 times as high, and the discounted horizon n / 2 times as long, so that
/// searching the n-th whole is worth as much to the flat model as searching one is to a zoom.
[[nodiscard]] Objective objectiveFor(const refinement::LowLevelDomain& domain,
                                     const refinement::Models& models);

/// What ending a mission now is worth where the goal holds with a probability and could be reached.
[[nodiscard]] double endWorth(const Objective& objective, double achieved);

/// The states of a domain that can be reached, as a POMDP with a goal: the task's states, `done`,
/// and the action `finish`.
struct FlatModel
{
  pomdp::Model model;
  std::vector<refinement::StateId> states;  ///< of the task, by number in the model
  std::unordered_map<refinement::StateId, std::size_t> number;

  [[nodiscard]] std::size_t finishAction() const { return model.numActions() - 1; }
  /// The same belief over the model's states.
  /// @throws FailedPrecondition  a state is not in the model
  [[nodiscard]] pomdp::Belief belief(const refinement::SparseBelief& states) const;
};

/// @param start     where it begins; all that can be reached from its states is in the model
/// @param max_rows  of actions times states
/// @throws ResourceExhausted  there are more
[[nodiscard]] FlatModel flatModel(refinement::DomainTask& task,
                                  const refinement::SparseBelief& start,
                                  const reasoner::Formula& goal, const Objective& objective,
                                  std::size_t max_rows);

}  // namespace kr3::executive
