#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <kr3_refinement/low_level_domain.hpp>
#include <kr3_refinement/models.hpp>

#include "kr3_executive/abstract_world.hpp"
#include "kr3_executive/interfaces.hpp"

namespace kr3::executive
{

/// What one noisy observation law said, and what was so.
struct TrainingObservation
{
  std::string fluent;  ///< name of the observed fluent
  bool truth = false;  ///< whether it is so; true for a law that tells a value
  bool said = false;   ///< whether the action said so; of a law that tells a value: said the right
  bool tells_value = false;
};

/// One trial of a low-level action, with the truth of what came of it.
struct TrainingAttempt
{
  LowLevelAction action;
  std::string outcome;  ///< label; empty where the action's laws have none
  std::vector<TrainingObservation> observed;
  double duration_s = 0.0;
  std::optional<double> metres;  ///< where the action's cost depends on a distance
};

/// The training phase in a simulated world of known models: each low-level action is tried in
/// states in which it is possible, an action that asks whether something is so as often where it is
/// so as where it is not. Every trial has a state of its own, drawn at random, so that trials are
/// independent: what a learner makes of them differs from the models by the chances of sampling
/// alone. Not thread-safe.
class AbstractTraining
{
public:
  /// @param domain, world  must outlive it
  AbstractTraining(const refinement::LowLevelDomain& domain, const refinement::Models& world,
                   std::uint64_t seed);

  /// One trial of each action and each truth of what it asks, in turn. Repeated calls go on: the
  /// first trials do not depend on how many are made.
  /// @throws FailedPrecondition  no state was found in which an action is possible
  std::vector<TrainingAttempt> round();

private:
  struct Kind
  {
    std::string symbol;
    std::vector<LowLevelAction> instances;
    std::optional<bool> truth;  ///< of what it asks first; none: it asks nothing that can err
  };

  [[nodiscard]] std::vector<Kind> kinds() const;
  /// What the action's first noisy law asks about.
  [[nodiscard]] std::optional<std::size_t> askingLaw(const LowLevelAction& action) const;
  TrainingAttempt attempt(const Kind& kind);
  /// Draws a world in which the action is possible and its question has this answer.
  bool prepare(const LowLevelAction& action, std::optional<bool> truth);
  [[nodiscard]] bool isReady(const LowLevelAction& action, std::optional<bool> truth) const;
  bool imposeTruth(const LowLevelAction& action, bool truth);
  bool impose(const std::string& fluent, const std::string& value);
  /// The ground inertial fluents that the action's executability conditions are about.
  [[nodiscard]] std::vector<std::string> conditionsOf(const LowLevelAction& action) const;
  [[nodiscard]] std::string valueFor(const std::string& fluent, const LowLevelAction& action);
  [[nodiscard]] std::vector<std::string> valuesOf(const std::string& fluent) const;
  [[nodiscard]] std::size_t anyOf(std::size_t count);

  const refinement::LowLevelDomain& domain_;
  const refinement::Models& models_;
  AbstractWorld world_;
  std::mt19937_64 random_;
  std::vector<Kind> kinds_;
};

}  // namespace kr3::executive
