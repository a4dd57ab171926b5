#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace kr3::pomdp
{

/// Beliefs and vectors are stored with this many entries at least and a
/// multiple of it, so that the loops over them need no rest; what is added is 0
/// and changes nothing.
inline constexpr std::size_t kLanes = 4;
[[nodiscard]] constexpr std::size_t padded(std::size_t num_states)
{
  return (num_states + kLanes - 1) / kLanes * kLanes;
}

/// Alpha vectors over one class of states, for lower bounds. A vector that
/// another one dominates everywhere is dropped and refers to that one; numbers
/// stay valid for ever.
class VectorSet
{
public:
  explicit VectorSet(std::size_t num_states) : stride_(padded(num_states)) {}

  /// Adds a vector of shape [num_states], unless one here is nowhere below it.
  /// @return the number under which it, or what dominates it, is found
  std::uint32_t add(std::uint32_t action, const std::vector<double>& values);

  /// Vectors ever added; numbers run from 0 to here.
  [[nodiscard]] std::uint32_t end() const { return static_cast<std::uint32_t>(actions_.size()); }
  [[nodiscard]] std::size_t numAlive() const { return num_alive_; }
  [[nodiscard]] bool isAlive(std::uint32_t i) const { return replacement_[i] == i; }
  /// The living vector that stands for vector `i`.
  [[nodiscard]] std::uint32_t living(std::uint32_t i) const;
  [[nodiscard]] const double* values(std::uint32_t i) const { return values_.data() + i * stride_; }
  [[nodiscard]] std::uint32_t action(std::uint32_t i) const { return actions_[i]; }
  /// Memory held.
  [[nodiscard]] std::size_t sizeInBytes() const;

  struct Best
  {
    double value;
    std::uint32_t vector;
  };
  /// The best of `known` and the living vectors numbered from `first`, at a
  /// padded belief.
  [[nodiscard]] Best best(const double* belief, std::uint32_t first, Best known) const;

private:
  std::size_t stride_;
  std::vector<double> values_;  // row-major, shape [vectors, stride]
  std::vector<std::uint32_t> actions_;
  std::vector<std::uint32_t> replacement_;
  std::size_t num_alive_ = 0;
};

/// Beliefs with upper bounds of their values, over one class of states. Between
/// them the bound is the sawtooth interpolation: convexity of the value
/// function, each point with the corners.
///
/// Source: Hauskrecht (2000), Sec. 4.5.
class SawtoothSet
{
public:
  /// @param corners  upper bounds at certain beliefs, shape [states]
  explicit SawtoothSet(std::vector<double> corners);

  /// @param belief  padded
  /// @return the number of the new point
  std::uint32_t add(const double* belief, double value);
  /// Forgets a point, for a better one at the same belief.
  void remove(std::uint32_t point) { gains_[point] = 0.0; }

  [[nodiscard]] std::uint32_t end() const { return static_cast<std::uint32_t>(gains_.size()); }
  /// The least bound at a padded belief that points numbered from `first` give.
  [[nodiscard]] double value(const double* belief, std::uint32_t first) const;
  /// Memory held.
  [[nodiscard]] std::size_t sizeInBytes() const;

private:
  std::vector<double> corners_;  // padded
  std::vector<double> inverse_;  // row-major, shape [points, stride]; huge where a point has 0
  std::vector<double> gains_;    // how far a point is below its corners, <= 0
  mutable std::vector<double> floored_;  // scratch of value()
};

}  // namespace kr3::pomdp
