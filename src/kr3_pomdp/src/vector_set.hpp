#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "packed_belief.hpp"

namespace kr3::pomdp
{

/// Alpha vectors over one class of states, for lower bounds. A vector that another one dominates
/// everywhere is freed and refers to that one; numbers stay valid for ever.
class VectorSet
{
public:
  explicit VectorSet(std::size_t num_states) : stride_(padded(num_states)) {}

  /// Adds a vector of shape [num_states], unless one here is nowhere below it.
  /// @return the number under which it, or what dominates it, is found
  std::uint32_t add(std::uint32_t action, const std::vector<double>& values);

  /// Vectors ever added; numbers run from 0 to here.
  [[nodiscard]] std::uint32_t end() const { return static_cast<std::uint32_t>(row_of_.size()); }
  [[nodiscard]] std::size_t numAlive() const { return num_alive_; }
  [[nodiscard]] bool isAlive(std::uint32_t i) const { return replacement_[i] == i; }
  /// The living vector that stands for vector `i`.
  [[nodiscard]] std::uint32_t living(std::uint32_t i) const;
  /// Of a living vector, padded; valid until the next add().
  [[nodiscard]] const double* values(std::uint32_t i) const
  {
    return values_.data() + row_of_[i] * stride_;
  }
  /// Of a living vector.
  [[nodiscard]] std::uint32_t action(std::uint32_t i) const { return actions_[row_of_[i]]; }
  /// Memory held.
  [[nodiscard]] std::size_t sizeInBytes() const;

  struct Best
  {
    double value;
    std::uint32_t vector;
  };
  /// The best of `known` and the living vectors numbered from `first`.
  [[nodiscard]] Best best(const PackedBelief& belief, std::uint32_t first, Best known) const;

private:
  void compact();

  std::size_t stride_;
  // One entry a row; rows of dead vectors are kept for a while.
  std::vector<double> values_;  // row-major, shape [rows, stride]
  std::vector<PartSums> sums_;
  std::vector<std::uint32_t> actions_;
  std::vector<std::uint32_t> numbers_;  // ascending
  std::vector<std::uint8_t> alive_;
  // One entry a number.
  std::vector<std::uint32_t> row_of_;
  std::vector<std::uint32_t> replacement_;
  std::size_t num_alive_ = 0;
};

}  // namespace kr3::pomdp
