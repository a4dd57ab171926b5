#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "observed_model.hpp"

namespace kr3::pomdp
{

/// A part of a belief: so much of a grid point.
struct Share
{
  std::uint32_t point;
  double weight;
};

/// Beliefs over one class of states, each with an upper bound of doing each action first and the
/// best from then on. The first points are the corners: point s is the certainty of state s.
class GridPoints
{
public:
  /// @param informed  upper bounds at the corners, shape [actions][states or more]
  GridPoints(std::size_t num_states, const std::vector<std::vector<double>>& informed);

  /// @param belief  shape [states]; @param values  shape [actions]
  /// @return the number of the new point
  std::uint32_t add(const std::vector<double>& belief, const std::vector<double>& values);

  [[nodiscard]] std::uint32_t size() const { return num_points_; }
  [[nodiscard]] std::size_t numStates() const { return num_states_; }
  [[nodiscard]] std::size_t numActions() const { return num_actions_; }
  /// Length of the arrays that rounded() gives and leastCost() takes: states, filled up with zeros.
  [[nodiscard]] std::size_t stride() const { return stride_; }
  [[nodiscard]] bool isCorner(std::uint32_t point) const { return point < num_states_; }

  /// The states that a point other than a corner gives a probability, ascending.
  [[nodiscard]] const std::vector<SparseEntry>& belief(std::uint32_t point) const
  {
    return beliefs_[point - num_states_];
  }
  /// The same in single precision, shape [stride].
  [[nodiscard]] const float* rounded(std::uint32_t point) const
  {
    return rounded_.data() + (point - num_states_) * stride_;
  }
  /// Upper bounds at a point, shape [actions].
  [[nodiscard]] const double* values(std::uint32_t point) const
  {
    return values_.data() + point * num_actions_;
  }
  /// Takes a lower upper bound.
  void tighten(std::uint32_t point, std::size_t action, double value);

  struct Best
  {
    std::size_t action;
    double value;
  };
  /// The best action at a point.
  [[nodiscard]] Best best(std::uint32_t point) const;
  /// Upper bound of the value of the belief that the shares make up: since the value of doing one
  /// action first is convex, it is that of the action that is best for all shares together.
  [[nodiscard]] Best best(const std::vector<Share>& shares) const;

  /// What the cheapest of the points numbered from `first`, which are no corners, costs less than
  /// the duals of a decomposition say it is worth; <= 0.
  /// @param duals  shape [stride + actions]: of states, then the weights of actions
  [[nodiscard]] double leastCost(const std::vector<float>& duals, std::uint32_t first) const;

  /// Memory held.
  [[nodiscard]] std::size_t sizeInBytes() const;

private:
  std::size_t num_states_;
  std::size_t num_actions_;
  std::size_t stride_;
  std::uint32_t num_points_;
  std::vector<std::vector<SparseEntry>> beliefs_;  // without the corners
  std::size_t num_entries_ = 0;                    // of beliefs_
  std::vector<float> rounded_;                     // row-major, shape [points - corners, stride]
  std::vector<double> values_;                     // row-major, shape [points, actions]
};

/// sum_i a[i] b[i]; `size` is a multiple of kFloatLanes.
inline constexpr std::size_t kFloatLanes = 16;
[[nodiscard]] float dot(const float* a, const float* b, std::size_t size);

}  // namespace kr3::pomdp
