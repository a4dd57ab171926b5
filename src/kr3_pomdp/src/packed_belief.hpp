#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace kr3::pomdp
{

/// Beliefs and vectors are worked on in blocks of so many states; the last block is filled up with
/// zeros, which change nothing.
inline constexpr std::size_t kLanes = 8;
[[nodiscard]] constexpr std::size_t padded(std::size_t num_states)
{
  return (num_states + kLanes - 1) / kLanes * kLanes;
}

/// The blocks of a belief that are not all zero. A view: what it points at lives elsewhere.
struct PackedBelief
{
  const double* values;         ///< shape [num_blocks, kLanes]
  const std::uint32_t* blocks;  ///< their places, ascending
  std::uint32_t num_blocks;
};

/// sum_s belief(s) values[s], values padded.
[[nodiscard]] double dot(const PackedBelief& belief, const double* values);

/// Sums of beliefs or vectors over a fixed number of parts of the states: what is nowhere below
/// has no sum below.
inline constexpr std::size_t kParts = 16;
using PartSums = std::array<float, kParts>;

/// A belief under work, with all states in one array and its blocks listed. Reused to save
/// allocations.
class UnpackedBelief
{
public:
  /// An empty belief.
  /// @param num_states  of the class that it is over
  void reset(std::size_t num_states);
  /// What a view shows.
  void assign(std::size_t num_states, const PackedBelief& belief);
  /// Adds to the probability of a state; probability > 0.
  void add(std::size_t state, double probability)
  {
    const std::size_t block = state / kLanes;
    if (touched_[block] == 0)
    {
      touched_[block] = 1;
      blocks_.push_back(static_cast<std::uint32_t>(block));
    }
    values_[state] += probability;
  }
  /// Ends the adding: divides by `total` and prepares the summaries.
  void finish(double total);

  [[nodiscard]] std::size_t numStates() const { return num_states_; }
  /// All states, padded.
  [[nodiscard]] const double* values() const { return values_.data(); }
  [[nodiscard]] PackedBelief packed() const
  {
    return {packed_.data(), blocks_.data(), static_cast<std::uint32_t>(blocks_.size())};
  }
  /// A bit for every state with a probability (states share bits when there are more than 64).
  [[nodiscard]] std::uint64_t support() const { return support_; }
  [[nodiscard]] const PartSums& sums() const { return sums_; }

private:
  std::size_t num_states_ = 0;
  std::vector<double> values_;
  std::vector<std::uint8_t> touched_;  // shape [blocks]
  std::vector<std::uint32_t> blocks_;
  std::vector<double> packed_;
  std::uint64_t support_ = 0;
  PartSums sums_{};
};

}  // namespace kr3::pomdp
