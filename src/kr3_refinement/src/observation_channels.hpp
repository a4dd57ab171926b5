#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <kr3_pomdp/factored_model.hpp>

#include "kr3_refinement/pomdp_task.hpp"

namespace kr3::refinement
{

/// What the laws of all actions tell of one fluent: one part of a task's observations. An immutable
/// value; the task must outlive it.
class ObservationChannel
{
public:
  /// @param part  which part of each action's observations it is, shape [actions]; kSilent where
  /// the
  ///              action tells nothing of the fluent
  ObservationChannel(const PomdpTask& task, std::string name, const std::vector<std::size_t>& part);
  static constexpr std::size_t kSilent = static_cast<std::size_t>(-1);

  /// Its values: `none`, then what is told.
  [[nodiscard]] const pomdp::Variable& variable() const { return variable_; }

  /// Probabilities of the values when an action has led to a state, shape [values].
  [[nodiscard]] std::vector<double> told(std::size_t action, std::size_t state) const;

private:
  const PomdpTask* task_;
  pomdp::Variable variable_;
  std::vector<std::vector<std::size_t>> value_of_;  // [action][observation of the task]
};

/// A channel for each observed fluent, `seen_loc(tb1)`, and another where an action has two laws on
/// the same, `seen_loc(tb1)_2`.
[[nodiscard]] std::vector<ObservationChannel> observationChannels(const PomdpTask& task);

}  // namespace kr3::refinement
