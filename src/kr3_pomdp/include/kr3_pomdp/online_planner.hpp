#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "kr3_pomdp/model.hpp"
#include "kr3_pomdp/policy.hpp"

namespace kr3::pomdp
{

/// What an action leads to in a generative model.
struct GenerativeStep
{
  std::uint64_t state;
  std::uint64_t observation;
  double reward;
  bool terminal;  ///< nothing is earned any more
};

/// A plan whose value is known.
struct KnownPlan
{
  std::size_t action;  ///< its first
  double value;        ///< what it earns, summed over the states that were asked about
};

/// A POMDP from which one can only sample; states and observations are numbers of any meaning.
/// Planning calls it from one thread at a time.
class GenerativeModel
{
public:
  GenerativeModel() = default;
  GenerativeModel(const GenerativeModel&) = delete;
  GenerativeModel& operator=(const GenerativeModel&) = delete;
  virtual ~GenerativeModel() = default;

  [[nodiscard]] virtual std::size_t numActions() const = 0;
  /// In (0, 1).
  [[nodiscard]] virtual double discount() const = 0;

  /// @param random  in [0, 1); the same number gives the same step
  [[nodiscard]] virtual GenerativeStep step(std::uint64_t state, std::size_t action,
                                            double random) const = 0;

  /// No less than what can be earned from a state on.
  [[nodiscard]] virtual double upperBound(std::uint64_t state) const = 0;

  /// The action of a simple policy in one of these states (one entry a sample, never empty), the
  /// robot not knowing which; what it earns is the planner's first lower bound.
  [[nodiscard]] virtual std::size_t defaultAction(
      const std::vector<std::uint64_t>& states) const = 0;

  /// No less than what can be earned in these states, summed, the robot not knowing which it is in;
  /// by default the sum of their bounds.
  [[nodiscard]] virtual double upperBoundOf(const std::vector<std::uint64_t>& states) const;

  /// A plan whose value in these states is known, which then is the planner's first lower bound; by
  /// default nothing, and the default policy is simulated.
  [[nodiscard]] virtual std::optional<KnownPlan> knownPlan(
      const std::vector<std::uint64_t>& states) const;

  /// O(observation | action, next_state), for a ParticleBelief, at all states or at none; by
  /// default nothing.
  [[nodiscard]] virtual std::optional<double> observationProbability(
      std::size_t action, std::uint64_t next_state, std::uint64_t observation) const;

  /// A state near by, for a ParticleBelief that an observation contradicts; by default nothing.
  /// @param random  in [0, 1)
  [[nodiscard]] virtual std::optional<std::uint64_t> perturbed(std::uint64_t state,
                                                               double random) const;
};

class ClassBounds;

/// A flat model to sample from: upper bounds are the fast informed bound; the default is a policy,
/// whose vectors give its value, or without one the action that is best when the state is known,
/// averaged, which is simulated.
class SampledModel : public GenerativeModel
{
public:
  /// @param model   must outlive this object; its discount is below 1
  /// @param policy  for the same model, or null; must outlive this object
  /// @throws InvalidArgument  a discount of 1, or a policy that does not fit
  explicit SampledModel(const Model& model, const Policy* policy = nullptr);
  ~SampledModel() override;

  [[nodiscard]] std::size_t numActions() const override { return model_.numActions(); }
  [[nodiscard]] double discount() const override { return model_.discount(); }
  [[nodiscard]] GenerativeStep step(std::uint64_t state, std::size_t action,
                                    double random) const override;
  [[nodiscard]] double upperBound(std::uint64_t state) const override { return values_[state]; }
  [[nodiscard]] std::size_t defaultAction(const std::vector<std::uint64_t>& states) const override;
  [[nodiscard]] double upperBoundOf(const std::vector<std::uint64_t>& states) const override;
  [[nodiscard]] std::optional<KnownPlan> knownPlan(
      const std::vector<std::uint64_t>& states) const override;

private:
  [[nodiscard]] double backedUp(std::size_t state, std::size_t action) const;

  const Model& model_;
  const Policy* policy_;
  std::vector<double> values_;         // of the fully observed model, shape [num_states]
  std::vector<double> action_values_;  // row-major, shape [num_states, num_actions]
  std::vector<bool> finished_;         // states from which nothing is earned any more
  std::unique_ptr<const ClassBounds> bounds_;
};

struct OnlineOptions
{
  std::size_t num_scenarios = 500;
  std::size_t max_depth = 90;
  double regularisation = 0.01;      ///< price of one more node in a plan's tree, >= 0
  double target = 0.95;              ///< of the gap at the root that a trial leaves, in (0, 1)
  double time_s = 0.1;               ///< wall time for a decision; 0 = no limit
  std::uint64_t max_expansions = 0;  ///< counted work, repeats exactly; 0 = no limit
};

struct OnlineDecision
{
  std::size_t action;
  double lower;  ///< of the value over the scenarios, regularised
  double upper;
  std::uint64_t expansions;
  std::size_t num_nodes;
};

/// Plans one action from samples of a belief by searching a sparse tree over scenarios, each a
/// sampled state with fixed random numbers.
///
/// Source: Ye, Somani, Hsu and Lee (2017), DESPOT: Online POMDP planning with regularization.
class OnlinePlanner
{
public:
  /// @param model  must outlive the planner
  /// @throws InvalidArgument  an option out of range, or no limit at all
  OnlinePlanner(const GenerativeModel& model, const OnlineOptions& options);

  /// @param sample  gives a state sampled from the belief for a number in [0, 1)
  /// @param seed    of all random numbers
  [[nodiscard]] OnlineDecision plan(const std::function<std::uint64_t(double)>& sample,
                                    std::uint64_t seed) const;

private:
  const GenerativeModel& model_;
  OnlineOptions options_;
};

/// Inverse of the distribution function: the state at a number in [0, 1).
[[nodiscard]] std::function<std::uint64_t(double)> sampler(const Belief& belief);

}  // namespace kr3::pomdp
