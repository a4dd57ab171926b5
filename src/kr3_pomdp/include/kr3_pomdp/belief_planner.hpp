#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "kr3_pomdp/belief.hpp"
#include "kr3_pomdp/model.hpp"
#include "kr3_pomdp/policy.hpp"

namespace kr3::pomdp
{

struct BeliefPlannerOptions
{
  double precision = 1e-3;           ///< gap at the belief below which it stops, >= 0
  double time_s = 0.1;               ///< wall time for a decision; 0 = no limit
  std::uint64_t max_expansions = 0;  ///< counted work, repeats exactly; 0 = no limit
};

struct BeliefDecision
{
  std::size_t action;
  double lower;  ///< planning on like this earns at least this much
  double upper;  ///< nobody earns more
  std::uint64_t expansions;
};

/// Plans one action at a time on a model by searching the tree of exact beliefs that follow, from
/// the belief where the robot is: an offline policy is the lower bound at the leaves, the fast
/// informed bound the upper one. What was searched below the next belief is kept when the robot
/// gets there. It never does worse than the offline policy, because an action is preferred to the
/// policy's only when its lower bound is higher.
///
/// For models that fit into memory; OnlinePlanner needs samples only. Not thread-safe.
/// Sources: Ross, Pineau, Paquet, Chaib-draa (2008), online planning algorithms for POMDPs; Smith
/// and Simmons (2004), the choice of where to search.
class BeliefPlanner
{
public:
  /// Starts at the model's initial belief, or at its first initial outcome if it has several.
  ///
  /// @param model   copied
  /// @param policy  of the same model
  /// @throws InvalidArgument  a policy that does not fit, an option out of range or no limit at
  ///                          all, a discount of 1
  BeliefPlanner(const Model& model, const Policy& policy, const BeliefPlannerOptions& options);
  ~BeliefPlanner();
  BeliefPlanner(BeliefPlanner&&) noexcept;
  BeliefPlanner& operator=(BeliefPlanner&&) noexcept;
  BeliefPlanner(const BeliefPlanner&) = delete;
  BeliefPlanner& operator=(const BeliefPlanner&) = delete;

  /// Begins anew at a belief that can follow from one of the model's initial outcomes.
  /// @throws InvalidArgument  another belief, or one of another size
  void restart(const Belief& belief);

  /// Where the robot is.
  [[nodiscard]] const Belief& belief() const;

  [[nodiscard]] BeliefDecision plan();

  /// Goes on to the belief after an action and an observation.
  /// @return the probability that the observation had
  /// @throws InvalidArgument, FailedPrecondition  as updated(); the belief stays
  double advance(std::size_t action, std::size_t observation);

private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kr3::pomdp
