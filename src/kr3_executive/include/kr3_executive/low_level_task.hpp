#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <kr3_pomdp/belief.hpp>
#include <kr3_refinement/pomdp_task.hpp>

#include "kr3_executive/interfaces.hpp"
#include "kr3_executive/low_level_memory.hpp"
#include "kr3_executive/mission.hpp"

namespace kr3::executive
{

/// What a ground action's observation laws tell about.
struct ObservedFluent
{
  std::string fluent;  ///< "loc(rob1)"
  std::string value;   ///< of `observes f = v`: v; empty for `observes f`
};

/// The observation laws of a ground low-level action, in the order of the description.
[[nodiscard]] std::vector<ObservedFluent> observedFluents(const reasoner::Description& low_level,
                                                          const LowLevelAction& action);

/// One high-level action under execution: its POMDP, its belief, and what both mean.
class LowLevelTask
{
public:
  /// @param domain     must outlive the task
  /// @param knowledge  from which the task's initial belief was made
  LowLevelTask(const refinement::LowLevelDomain& domain,
               std::shared_ptr<const refinement::PomdpTask> pomdp,
               const refinement::InitialKnowledge& knowledge);

  [[nodiscard]] const refinement::PomdpTask& pomdp() const { return *pomdp_; }
  [[nodiscard]] const pomdp::Belief& belief() const { return belief_; }
  [[nodiscard]] LowLevelAction action(std::size_t index) const;
  [[nodiscard]] bool isFinish(std::size_t action) const { return action == pomdp_->finishAction(); }

  /// Line 14: the belief update, exact when the confidence is 1. With confidence c the observation
  /// is as the model says with probability c, and otherwise any one that the action can give, all
  /// equally likely: O'(o | a, s) = c O(o | a, s) + (1 - c) / m, and 0 where O(o | a, s) is 0: a
  /// sensor that the model holds for exact is trusted.
  ///
  /// @param observation  as LowLevelResult
  /// @param confidence   of the observation, (0, 1]
  /// @return false when the observation is impossible at the belief, however doubtful it is, or
  ///         tells that a fluent has left the zoom, which no error of a sensor explains; the belief
  ///         then stays as it was
  /// @throws InvalidArgument  another number of observations than the action's laws, or a
  ///                          confidence out of range
  [[nodiscard]] bool update(std::size_t action, const std::vector<std::string>& observation,
                            double confidence = 1.0);

  /// Takes in what was noticed by the way, by Bayes' rule: into the belief where the zoom has the
  /// fluent, and into what was noticed of it since the action began.
  void notice(const SightingLikelihood& sighting);

  /// What sightings alone say about each fluent that was noticed, over low-level values.
  [[nodiscard]] const std::map<std::string, refinement::Distribution>& noticed() const
  {
    return noticed_;
  }

  /// Values that were observed without doubt or left the zoom, by fluent: the latest of each.
  [[nodiscard]] const std::map<std::string, std::string>& observed() const { return observed_; }
  /// Those that the last action observed.
  [[nodiscard]] const std::map<std::string, std::string>& observedLast() const
  {
    return observed_last_;
  }

  /// What the belief says about the high-level action; `changed`, `happened` and `noticed` are left
  /// empty.
  [[nodiscard]] Assessment assess() const;

  /// Belief in a value of a high-level fluent; nothing when the zoom does not have it.
  [[nodiscard]] std::optional<double> beliefIn(const std::string& coarse_fluent,
                                               const std::string& value) const;

  /// Adds what this task believes to the memory, which nobody else changes while the task lasts.
  void remember(LowLevelMemory& memory);

private:
  [[nodiscard]] std::size_t observationIndex(std::size_t action,
                                             const std::vector<std::string>& observation) const;
  /// The model explains an observation otherwise than by an outcome that left the zoom.
  [[nodiscard]] bool mayErr(std::size_t action, std::size_t observation) const;
  [[nodiscard]] refinement::Distribution rememberedValues(const std::string& fluent,
                                                          const refinement::Distribution& inside,
                                                          const LowLevelMemory& memory) const;
  /// RememberedFluent::odds of a value with which the task began.
  [[nodiscard]] double oddsOf(const std::string& fluent, const std::string& value,
                              const LowLevelMemory& memory);

  const refinement::LowLevelDomain& domain_;
  std::shared_ptr<const refinement::PomdpTask> pomdp_;  // shared with a cache
  pomdp::Belief belief_;
  std::string symbol_;  // of the high-level action
  bool remembered_ = false;
  bool attempted_ = false;
  std::map<std::string, std::string> observed_;
  std::map<std::string, std::string> observed_last_;
  std::map<std::string, refinement::Distribution> noticed_;
  std::map<std::string, double> odds_;  // RememberedFluent::odds, by fluent
};

}  // namespace kr3::executive
