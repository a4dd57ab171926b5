#pragma once

#include <cstddef>
#include <vector>

namespace kr3::pomdp
{

class Model;

/// A probability distribution over the states of a model.
///
/// Invariant: every entry is finite and not negative; they sum to 1 within 1e-9 (the constructor
/// normalises what is within 1e-6).
class Belief
{
public:
  /// @param probabilities  shape [num_states]
  /// @throws InvalidArgument  empty, an entry that is negative or not finite, or a sum off 1 by
  /// more
  ///                          than 1e-6
  explicit Belief(std::vector<double> probabilities);

  [[nodiscard]] const std::vector<double>& probabilities() const { return probabilities_; }
  [[nodiscard]] std::size_t size() const { return probabilities_.size(); }
  [[nodiscard]] double operator[](std::size_t state) const { return probabilities_[state]; }

private:
  std::vector<double> probabilities_;
};

/// What a belief becomes, and how likely that was.
struct BeliefUpdate
{
  Belief posterior;
  double probability;  ///< Pr(observation | belief, action), in (0, 1]
};

/// The exact Bayesian update b'(s') = O(o | a, s') sum_s T(s' | s, a) b(s) / Pr(o | b, a).
///
/// @throws InvalidArgument      belief of another size than the model, action or observation out of
///                              range
/// @throws FailedPrecondition   the observation is impossible after the action at this belief
/// Source: Kaelbling, Littman and Cassandra (1998), Sec. 3.3.
[[nodiscard]] BeliefUpdate updated(const Model& model, const Belief& belief, std::size_t action,
                                   std::size_t observation);

/// Pr(o | belief, action) for every observation, shape [num_observations]; sums to 1.
///
/// @throws InvalidArgument  belief of another size than the model, action out of range
[[nodiscard]] std::vector<double> observationProbabilities(const Model& model, const Belief& belief,
                                                           std::size_t action);

}  // namespace kr3::pomdp
