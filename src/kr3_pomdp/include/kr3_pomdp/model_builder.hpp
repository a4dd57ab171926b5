#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "kr3_pomdp/model.hpp"

namespace kr3::pomdp
{

/// In a setter of ModelBuilder: every state, action or observation.
inline constexpr std::size_t kAny = std::numeric_limits<std::size_t>::max();

/// Collects a model piece by piece. What is set later replaces what was set before; what is never
/// set is 0 (so every row of T and O must be set), and the initial belief is uniform.
///
/// Every setter takes indices (or kAny) and throws InvalidArgument naming what is out of range or
/// not finite. Not thread-safe.
class ModelBuilder
{
public:
  /// @throws InvalidArgument  an empty list, a duplicate or empty name
  ModelBuilder(std::vector<std::string> states, std::vector<std::string> actions,
               std::vector<std::string> observations);

  [[nodiscard]] const NameTable& states() const { return states_; }
  [[nodiscard]] const NameTable& actions() const { return actions_; }
  [[nodiscard]] const NameTable& observations() const { return observations_; }

  /// @throws NotFound  no such name
  [[nodiscard]] std::size_t state(std::string_view name) const;
  [[nodiscard]] std::size_t action(std::string_view name) const;
  [[nodiscard]] std::size_t observation(std::string_view name) const;

  /// @param discount  in (0, 1]
  void setDiscount(double discount);
  /// @param probabilities  shape [num_states]; checked by build()
  void setInitialBelief(std::vector<double> probabilities);
  /// T(next_state | state, action) = probability.
  void setTransition(std::size_t action, std::size_t state, std::size_t next_state,
                     double probability);
  /// Adds to T(next_state | state, action): for generators whose outcomes may coincide.
  void addTransition(std::size_t action, std::size_t state, std::size_t next_state,
                     double probability);
  /// O(observation | action, next_state) = probability.
  void setObservation(std::size_t action, std::size_t next_state, std::size_t observation,
                      double probability);
  /// Adds to O(observation | action, next_state).
  void addObservation(std::size_t action, std::size_t next_state, std::size_t observation,
                      double probability);
  /// R(action, state) = value, whatever follows.
  void setReward(std::size_t action, std::size_t state, double value);
  /// R(action, state, next_state, observation) = value; the model keeps the expectation R(a, s).
  void setReward(std::size_t action, std::size_t state, std::size_t next_state,
                 std::size_t observation, double value);

  /// What a row of T or O sums to so far.
  /// @throws InvalidArgument  out of range
  [[nodiscard]] double transitionSum(std::size_t action, std::size_t state) const;
  [[nodiscard]] double observationSum(std::size_t action, std::size_t next_state) const;

  /// The finished model; rows are normalised exactly.
  ///
  /// @param sum_tolerance  how far from 1 a row of T or O may sum
  /// @throws InvalidArgument  a row of T or O off by more, an initial belief off by more than 1e-6,
  ///                          or an entry outside [0, 1]; the message names the row;
  ///                          ResourceExhausted  expected rewards of more than 2^31 terms
  [[nodiscard]] Model build(double sum_tolerance = 1e-6) const;

private:
  struct RewardRule
  {
    std::uint64_t order;  // the latest matching rule wins
    double value;
  };
  using Rows = std::vector<std::vector<SparseEntry>>;

  void setEntry(Rows& rows, const NameTable& columns, const char* what, std::size_t action,
                std::size_t state, std::size_t column, double probability, bool add);
  [[nodiscard]] std::vector<double> expectedRewards(const Rows& transitions,
                                                    const Rows& observations) const;

  NameTable states_;
  NameTable actions_;
  NameTable observations_;
  double discount_ = 1.0;
  std::vector<double> initial_belief_;
  Rows transitions_;
  Rows observation_rows_;
  // One table per combination of wildcards (bit 0: action, 1: state, 2: next state, 3:
  // observation).
  std::array<std::unordered_map<std::uint64_t, RewardRule>, 16> rewards_;
  std::uint64_t num_reward_rules_ = 0;
};

}  // namespace kr3::pomdp
