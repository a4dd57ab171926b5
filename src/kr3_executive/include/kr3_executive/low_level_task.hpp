#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include <kr3_pomdp/belief.hpp>
#include <kr3_refinement/pomdp_task.hpp>

#include "kr3_executive/interfaces.hpp"
#include "kr3_executive/mission.hpp"

namespace kr3::executive
{

/// What a ground action's observation laws tell about.
struct ObservedFluent
{
  std::string fluent;  ///< "loc(rob1)"
  std::string value;   ///< of `observes f = v`: v; empty for `observes f`
};

/// A ground low-level fluent as the high level names it: `opened(cover_2)` is `opened(box)`.
[[nodiscard]] std::string coarseFluent(const refinement::LowLevelDomain& domain,
                                       const std::string& fluent);

/// The observation laws of a ground low-level action, in the order of the description.
[[nodiscard]] std::vector<ObservedFluent> observedFluents(const reasoner::Description& low_level,
                                                          const LowLevelAction& action);

/// What the low level last believed about a fluent.
struct RememberedFluent
{
  refinement::Distribution values;  ///< over low-level values and refinement::kElsewhere
  std::string assumed;              ///< the high-level value on which it rested
};
/// The low level's memory between high-level actions, by ground fluent.
using LowLevelMemory = std::map<std::string, RememberedFluent>;

/// How sure the high level is of a literal, and why.
struct Support
{
  double probability = 1.0;  ///< 1: held for certain
  std::string reason;        ///< for people: "default d1(tb1)", "observed", "assumed"
};
using SupportOf = std::function<Support(const std::string& literal)>;

/// Line 10: the initial belief for a zoom.
///
/// What the low level remembers wins while it rests on the value that the high level holds now, or
/// puts most of its mass there; otherwise the high level's support counts, spread over the
/// components.
[[nodiscard]] refinement::InitialKnowledge initialKnowledge(
    const refinement::LowLevelDomain& domain, const refinement::Zoom& zoom,
    const LowLevelMemory& memory, const SupportOf& support);

/// One high-level action under execution: its POMDP, its belief, and what both mean.
class LowLevelTask
{
public:
  /// @param domain     must outlive the task
  /// @param knowledge  from which the task's initial belief was made
  LowLevelTask(const refinement::LowLevelDomain& domain, refinement::PomdpTask pomdp,
               const refinement::InitialKnowledge& knowledge);

  [[nodiscard]] const refinement::PomdpTask& pomdp() const { return pomdp_; }
  [[nodiscard]] const pomdp::Belief& belief() const { return belief_; }
  [[nodiscard]] LowLevelAction action(std::size_t index) const;
  [[nodiscard]] bool isFinish(std::size_t action) const { return action == pomdp_.finishAction(); }

  /// Line 14: the exact belief update.
  /// @param observation  as LowLevelResult
  /// @return false when the observation is impossible at the belief or lies outside the zoom; the
  ///         belief then stays as it was
  /// @throws InvalidArgument  a value that is neither in the model nor a component
  [[nodiscard]] bool update(std::size_t action, const std::vector<std::string>& observation);

  /// Values that were observed without doubt or left the zoom, by fluent: the latest of each.
  [[nodiscard]] const std::map<std::string, std::string>& observed() const { return observed_; }

  /// What the belief says about the high-level action; `changed` and `happened` are left empty.
  [[nodiscard]] Assessment assess() const;

  /// Adds what this task believes to the memory.
  void remember(LowLevelMemory& memory) const;

private:
  [[nodiscard]] std::size_t observationIndex(std::size_t action,
                                             const std::vector<std::string>& observation) const;

  const refinement::LowLevelDomain& domain_;
  refinement::PomdpTask pomdp_;
  pomdp::Belief belief_;
  std::string symbol_;  // of the high-level action
  bool remembered_ = false;
  bool attempted_ = false;
  std::map<std::string, std::string> observed_;
};

}  // namespace kr3::executive
