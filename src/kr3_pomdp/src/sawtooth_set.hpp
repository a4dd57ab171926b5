#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "packed_belief.hpp"

namespace kr3::pomdp
{

/// Beliefs with upper bounds of their values, over one class of states. Between them the bound is
/// the sawtooth interpolation: convexity of the value function, each point with the corners.
///
/// Source: Hauskrecht (2000), Sec. 4.5.
class SawtoothSet
{
public:
  /// @param corners  upper bounds at certain beliefs, shape [states]
  explicit SawtoothSet(std::vector<double> corners);

  /// @param belief  what its view points at outlives this object
  /// @return the number of the new point; at most 2^32 - 1 points
  std::uint32_t add(const UnpackedBelief& belief, const PackedBelief& stored, double value);
  /// Frees a point, for a better one at the same belief.
  void remove(std::uint32_t point);

  /// Points ever added; numbers run from 0 to here.
  [[nodiscard]] std::uint32_t end() const { return end_; }
  [[nodiscard]] std::size_t numPoints() const { return num_alive_; }
  /// The least of `known` and the bounds that points numbered from `first` give.
  [[nodiscard]] double value(const UnpackedBelief& belief, std::uint32_t first, double known) const;
  /// Memory held.
  [[nodiscard]] std::size_t sizeInBytes() const;

private:
  void compact();

  std::vector<double> corners_;  // padded
  // One entry a row; a removed point gains 0 and is kept for a while.
  std::vector<double> gains_;  // how far a point is below its corners, <= 0
  std::vector<std::uint64_t> supports_;
  std::vector<PartSums> sums_;
  std::vector<PackedBelief> beliefs_;
  std::vector<std::uint32_t> numbers_;  // ascending
  std::uint32_t end_ = 0;
  std::size_t num_alive_ = 0;
};

}  // namespace kr3::pomdp
