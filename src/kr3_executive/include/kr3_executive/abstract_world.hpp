#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include <kr3_refinement/low_level_domain.hpp>
#include <kr3_refinement/models.hpp>

#include "kr3_executive/interfaces.hpp"
#include "kr3_executive/rule_interpreter.hpp"

namespace kr3::executive
{

/// A simulated world at the low level, for missions without a robot: one true fine state of the
/// whole domain, changed by the low-level laws with the probabilities of the models, and observed
/// through their noise. It knows nothing of zooms, POMDPs or histories.
///
/// Not thread-safe. The domain and the models must outlive it.
class AbstractWorld : public LowLevelExecutor
{
public:
  AbstractWorld(const refinement::LowLevelDomain& domain, const refinement::Models& models,
                std::uint64_t seed);

  /// Starts from a high-level state; each value becomes one of its components at random, and what
  /// is not given takes any value.
  /// @throws InvalidArgument  no such state satisfies the constraints
  void reset(const FluentValues& coarse);

  LowLevelResult execute(const LowLevelAction& action, const FluentLookup& believed,
                         const std::atomic<bool>& cancel) override;

  /// The truth, at the low and at the high level.
  [[nodiscard]] const FluentValues& fine() const { return state_; }
  [[nodiscard]] FluentValues coarse() const;
  /// Whether a goal of the high level is true.
  [[nodiscard]] bool holds(const reasoner::Formula& goal) const;

  /// Simulated seconds since the start.
  [[nodiscard]] double now() const { return now_s_; }

private:
  [[nodiscard]] double durationOf(const LowLevelAction& action) const;
  [[nodiscard]] std::string observe(const LowLevelAction& action, const std::string& fluent,
                                    const std::string& asked);
  [[nodiscard]] bool chance(double probability);
  [[nodiscard]] std::size_t anyOf(std::size_t count);

  const refinement::LowLevelDomain& domain_;
  const refinement::Models& models_;
  RuleInterpreter laws_;
  RuleInterpreter high_level_laws_;
  std::mt19937_64 random_;
  FluentValues state_;
  double now_s_ = 0.0;
};

}  // namespace kr3::executive
