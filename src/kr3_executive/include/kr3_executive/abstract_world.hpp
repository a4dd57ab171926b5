#pragma once

#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <kr3_refinement/low_level_domain.hpp>
#include <kr3_refinement/models.hpp>

#include "kr3_executive/interfaces.hpp"
#include "kr3_executive/rule_interpreter.hpp"

namespace kr3::executive
{

/// What goes another way than the laws and the chances say, in one low-level action.
struct Disturbance
{
  /// Label of the outcome that happens, where it is possible.
  std::optional<std::string> outcome;
  /// The action has no effect; it is reported as `outcome`, else as "blocked".
  bool blocked = false;
  /// Fine values by ground fluent that hold once the action has had its effect, before it observes.
  FluentValues becomes;
  /// What is observed, one value for each observation law; empty: as the state is, with noise.
  std::vector<std::string> observation;
};

/// A simulated world at the low level, for missions without a robot: one true fine state of the
/// whole domain, changed by the low-level laws with the probabilities of the models, and observed
/// through their noise. It knows nothing of zooms, POMDPs or histories. An action that is
/// impossible changes nothing and tells nothing: what it senses comes at the false-positive rate.
/// Feedback on its own effects stays true.
///
/// Not thread-safe. The domain and the models must outlive it.
class AbstractWorld : public LowLevelExecutor
{
public:
  AbstractWorld(const refinement::LowLevelDomain& domain, const refinement::Models& models,
                std::uint64_t seed);

  /// Without noise the most probable outcome happens each time and observations are true.
  void setNoise(bool noise) { noise_ = noise; }

  /// Starts from a high-level state; each value becomes one of its components at random, and what
  /// is not given takes any value.
  /// @param fine  values of ground low-level fluents that are fixed; they go before `coarse`
  /// @throws InvalidArgument  no such state satisfies the constraints
  void reset(const FluentValues& coarse, const FluentValues& fine = {});

  /// Something outside changes the truth: a person moves an object, the robot drops it.
  /// @param values  fine values by ground fluent
  /// @throws InvalidArgument  they contradict the state constraints
  void impose(const FluentValues& values) { state_ = laws_.imposed(state_, values); }

  LowLevelResult execute(const LowLevelAction& action, const FluentLookup& believed,
                         const std::atomic<bool>& cancel) override;
  /// @throws InvalidArgument  the disturbance does not fit the action
  LowLevelResult execute(const LowLevelAction& action, const Disturbance& disturbance);

  /// Whether the action can be carried out in the present state.
  [[nodiscard]] bool possible(const LowLevelAction& action) const;
  /// Metres that the action would drive now; none where its cost does not depend on a distance, or
  /// the map does not know it.
  [[nodiscard]] std::optional<double> metres(const LowLevelAction& action) const;

  /// The truth, at the low and at the high level.
  [[nodiscard]] const FluentValues& fine() const { return state_; }
  [[nodiscard]] FluentValues coarse() const;
  /// Whether a ground literal of the low level is true.
  [[nodiscard]] bool holds(const reasoner::Literal& literal) const
  {
    return laws_.holds(state_, literal);
  }
  /// Whether a goal of the high level is true.
  [[nodiscard]] bool holds(const reasoner::Formula& goal) const;

  /// Simulated seconds since the start.
  [[nodiscard]] double now() const { return now_s_; }

private:
  [[nodiscard]] double durationOf(const LowLevelAction& action) const;
  /// Whether a causal law lets the action change the fluent, so that observing it is feedback.
  [[nodiscard]] bool affects(const LowLevelAction& action, const std::string& fluent) const;
  /// What an action that could not be carried out tells of a fluent that it does not change.
  [[nodiscard]] std::string senseNothing(const LowLevelAction& action, const std::string& fluent,
                                         const std::string& asked);
  [[nodiscard]] std::string observe(const LowLevelAction& action, const std::string& fluent,
                                    const std::string& asked);
  [[nodiscard]] std::size_t chooseOutcome(const LowLevelAction& action,
                                          const std::vector<std::string>& labels,
                                          const Disturbance& disturbance);
  [[nodiscard]] bool chance(double probability);
  [[nodiscard]] std::size_t anyOf(std::size_t count);

  const refinement::LowLevelDomain& domain_;
  const refinement::Models& models_;
  RuleInterpreter laws_;
  RuleInterpreter high_level_laws_;
  std::mt19937_64 random_;
  FluentValues state_;
  double now_s_ = 0.0;
  bool noise_ = true;
};

}  // namespace kr3::executive
