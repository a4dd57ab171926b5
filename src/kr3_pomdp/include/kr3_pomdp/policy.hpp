#pragma once

#include <cstddef>
#include <iosfwd>
#include <string>
#include <vector>

#include "kr3_pomdp/belief.hpp"

namespace kr3::pomdp
{

/// The value of one conditional plan in every state, and the plan's first action.
struct AlphaVector
{
  std::size_t action;
  std::vector<double> values;  ///< shape [num_states]
};

/// A policy: at a belief, the action of the alpha vector that is greatest there.
///
/// A policy from solve() earns at least valueAt(b) from b on, because each vector is supported by
/// other vectors of the same policy. An immutable value; safe to use from several threads.
/// Invariant: at least one vector; all have num_states finite values.
class Policy
{
public:
  /// @throws InvalidArgument  no vector, vectors of different or zero length, a value not finite
  explicit Policy(const std::vector<AlphaVector>& alpha_vectors);

  [[nodiscard]] std::size_t numStates() const { return num_states_; }
  [[nodiscard]] std::size_t numAlphaVectors() const { return actions_.size(); }
  [[nodiscard]] AlphaVector alphaVector(std::size_t i) const;

  /// @throws InvalidArgument  belief of another size
  [[nodiscard]] std::size_t actionAt(const Belief& belief) const;
  /// A lower bound of what the policy earns from `belief` on.
  /// @throws InvalidArgument  belief of another size
  [[nodiscard]] double valueAt(const Belief& belief) const;

  /// Text of one vector per line; reading it back gives exactly the same policy.
  void write(std::ostream& out) const;
  /// @param name  of the input, for messages
  /// @throws InvalidArgument  malformed; the message says `name:line`
  [[nodiscard]] static Policy read(std::istream& in, const std::string& name);

private:
  struct Best
  {
    std::size_t index;
    double value;
  };
  [[nodiscard]] Best best(const Belief& belief) const;

  std::size_t num_states_;
  std::vector<std::size_t> actions_;  // shape [num_alpha_vectors]
  std::vector<double> values_;        // state-major, shape [num_states, num_alpha_vectors]
};

}  // namespace kr3::pomdp
