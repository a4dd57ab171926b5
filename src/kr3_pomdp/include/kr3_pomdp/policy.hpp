#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include "kr3_pomdp/belief.hpp"

namespace kr3::pomdp
{

/// The value of one conditional plan in some states, and the plan's first action. It says nothing
/// of beliefs that give mass to other states.
struct AlphaVector
{
  std::size_t action;
  std::vector<std::uint32_t> states;  ///< ascending; empty = all states of the model
  std::vector<double> values;         ///< one for each of `states`
};

/// A policy: at a belief, the action of the alpha vector that is greatest there, among those whose
/// states hold all of the belief.
///
/// A policy from solve() earns at least valueAt(b) from b on, because each vector is supported by
/// other vectors of the same policy. Where part of the state is always known (a robot's cell, say),
/// its vectors are over the states of one value of that part; beliefs that mix such values, which
/// never come from the model's initial belief, are answered with a blind plan.
///
/// An immutable value; safe to use from several threads.
/// Invariant: all values are finite, and at least one vector is over all states.
class Policy
{
public:
  /// @throws InvalidArgument  a vector with states out of order or range or with another number of
  ///                          values, a value not finite, or no vector over all states
  Policy(std::size_t num_states, const std::vector<AlphaVector>& alpha_vectors);

  [[nodiscard]] std::size_t numStates() const { return num_states_; }
  [[nodiscard]] std::size_t numAlphaVectors() const { return num_alpha_vectors_; }
  /// The greatest action index of any vector.
  [[nodiscard]] std::size_t maxAction() const { return max_action_; }
  /// Memory held, roughly.
  [[nodiscard]] std::size_t sizeInBytes() const;
  /// All vectors, those with the same states together.
  [[nodiscard]] std::vector<AlphaVector> alphaVectors() const;

  /// @throws InvalidArgument  belief of another size
  [[nodiscard]] std::size_t actionAt(const Belief& belief) const { return bestAt(belief).action; }
  /// A lower bound of what the policy earns from `belief` on.
  /// @throws InvalidArgument  belief of another size
  [[nodiscard]] double valueAt(const Belief& belief) const { return bestAt(belief).value; }

  struct Choice
  {
    std::size_t action;
    double value;
  };
  /// Both at once.
  /// @throws InvalidArgument  belief of another size
  [[nodiscard]] Choice bestAt(const Belief& belief) const;

  /// Text of one vector per line; reading it back gives exactly the same policy. The layout is in
  /// docs/pomdp_formats.md; policy_format.hpp has the other formats.
  void write(std::ostream& out) const;
  /// @param name  of the input, for messages
  /// @throws InvalidArgument  malformed; the message says `name:line:column`; Unavailable  the
  ///                          stream fails
  [[nodiscard]] static Policy read(std::istream& in, const std::string& name);

private:
  void indexGroups();

  /// Vectors over the same states.
  struct Group
  {
    std::vector<std::uint32_t> states;   // ascending, never empty
    std::vector<std::uint32_t> actions;  // shape [vectors]
    std::vector<double> values;          // state-major, shape [states, vectors]
  };

  std::size_t num_states_;
  std::size_t num_alpha_vectors_;
  std::size_t max_action_ = 0;
  std::vector<Group> groups_;
  // The groups that hold state s: groups_of_state_[first_group_[s]] up to first_group_[s + 1].
  std::vector<std::size_t> first_group_;  // shape [num_states + 1]
  std::vector<std::uint32_t> groups_of_state_;
};

}  // namespace kr3::pomdp
