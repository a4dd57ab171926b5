#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <kr3_reasoner/language.hpp>
#include <kr3_refinement/domain_task.hpp>

#include "kr3_executive/interfaces.hpp"

namespace kr3::executive
{

/// What a purely probabilistic method believes: an exact distribution over the low-level states of
/// the whole domain.
///
/// Invariant: probabilities are positive and sum to 1.
class DomainBelief
{
public:
  /// @param task  shared by all beliefs over one domain, never null
  DomainBelief(std::shared_ptr<refinement::DomainTask> task, refinement::SparseBelief states);

  [[nodiscard]] refinement::DomainTask& task() const { return *task_; }
  [[nodiscard]] const refinement::SparseBelief& states() const { return states_; }

  [[nodiscard]] LowLevelAction action(std::size_t index) const;

  /// The Bayesian update. What the belief holds for impossible corrects it: a fluent whose value
  /// was observed takes that value, the others stay.
  /// @param observation  as LowLevelResult
  /// @return false when it had to be corrected so
  /// @throws InvalidArgument  not one value for each observation law of the action
  bool update(std::size_t action, const std::vector<std::string>& observation);

  /// Takes in a statement about the present, right with a probability; a wrong one is as likely to
  /// name any other value. Nothing happens when the task has no such fluent.
  /// @param literal     of the high or the low level, such as "loc(tb1) = kitchen"
  /// @param confidence  in (0, 1]; 1 counts as 0.999, so that errors can be mended
  void weigh(const std::string& literal, double confidence);

  [[nodiscard]] double probability(const reasoner::Formula& goal) const;
  /// Of each fluent, over its low-level values. Sums to 1.
  [[nodiscard]] std::map<std::string, refinement::Distribution> marginals() const;
  /// The likeliest value of a fluent of the low level; empty when the task has none of that name.
  [[nodiscard]] std::string likeliest(const std::string& fluent) const;
  /// In a line, the likeliest values first.
  [[nodiscard]] std::string summary() const;

private:
  bool replace(refinement::SparseBelief states);

  std::shared_ptr<refinement::DomainTask> task_;
  refinement::SparseBelief states_;
};

}  // namespace kr3::executive
