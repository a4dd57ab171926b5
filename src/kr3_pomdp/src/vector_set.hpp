#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace kr3::pomdp
{

/// Alpha vectors over one class of states, for lower bounds. A vector that another one dominates
/// everywhere is dropped and refers to that one; numbers stay valid for ever.
class VectorSet
{
public:
  explicit VectorSet(std::size_t num_states) : num_states_(num_states) {}

  /// Adds a vector, unless one here is nowhere below it.
  /// @return the number under which it, or what dominates it, is found
  std::uint32_t add(std::uint32_t action, const std::vector<double>& values);

  /// Vectors ever added; numbers run from 0 to here.
  [[nodiscard]] std::uint32_t end() const { return static_cast<std::uint32_t>(actions_.size()); }
  [[nodiscard]] std::size_t numAlive() const { return num_alive_; }
  [[nodiscard]] bool isAlive(std::uint32_t i) const { return replacement_[i] == i; }
  /// The living vector that stands for vector `i`.
  [[nodiscard]] std::uint32_t living(std::uint32_t i) const;
  [[nodiscard]] const double* values(std::uint32_t i) const
  {
    return values_.data() + i * num_states_;
  }
  [[nodiscard]] std::uint32_t action(std::uint32_t i) const { return actions_[i]; }

  struct Best
  {
    double value;
    std::uint32_t vector;
  };
  /// The best of `known` and the living vectors numbered from `first`, at a belief.
  [[nodiscard]] Best best(const double* belief, std::uint32_t first, Best known) const;

private:
  std::size_t num_states_;
  std::vector<double> values_;  // row-major, shape [vectors, states]
  std::vector<std::uint32_t> actions_;
  std::vector<std::uint32_t> replacement_;
  std::size_t num_alive_ = 0;
};

/// Beliefs with upper bounds of their values, over one class of states. Between them the bound is
/// the sawtooth interpolation: convexity of the value function, each point with the corners.
///
/// Source: Hauskrecht (2000), Sec. 4.5.
class SawtoothSet
{
public:
  /// @param corners  upper bounds at certain beliefs, shape [states]
  explicit SawtoothSet(std::vector<double> corners) : corners_(std::move(corners)) {}

  void add(const double* belief, double value);

  [[nodiscard]] std::uint32_t end() const { return num_points_; }
  [[nodiscard]] double cornerValue(const double* belief) const;
  /// The least bound that points numbered from `first` give.
  [[nodiscard]] double value(const double* belief, std::uint32_t first) const;

private:
  std::vector<double> corners_;
  std::uint32_t num_points_ = 0;
  std::vector<double> inverse_;  // row-major, shape [points, states]; huge where a point has 0
  std::vector<double> gains_;    // how far a point is below its corners, <= 0, shape [points]
};

}  // namespace kr3::pomdp
