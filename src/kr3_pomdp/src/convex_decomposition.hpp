#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "grid_points.hpp"

namespace kr3::pomdp
{

/// Finds how a belief is best made up of grid points, so that the upper bound which follows at the
/// belief is least: the linear program
///
///     minimise t over t and w >= 0
///     so that  sum_j w_j b_j = b   and   sum_j w_j Q_j(a) <= t for every action a
///
/// by the revised simplex method from the corners, with an explicit inverse, since the program has
/// few rows (states that b gives a probability, actions) and many columns (points), most of them
/// priced in single precision only. Whatever the numbers do, the result makes up the belief.
///
/// Sources: Hauskrecht (2000), Sec. 4.5 (linear program); Poupart, Kim and Kim (2011) and Krale et
/// al. (2025) (bounds of actions at points, not values).
class Decomposer
{
public:
  /// @param belief     shape [states], sums to 1
  /// @param tolerance  the bound may stay so far above the least one, > 0
  /// @param shares     in: a decomposition to begin near, or empty; out: what was found
  /// @param duals      out: for GridPoints::leastCost; shape [stride + actions]
  /// @param keep_going  asked between pivots; if it says no, what was found so far is given
  void decompose(const GridPoints& points, const std::vector<double>& belief, double tolerance,
                 std::vector<Share>& shares, std::vector<float>& duals,
                 const std::function<bool()>& keep_going);

  /// Multiply-add operations done so far.
  [[nodiscard]] std::uint64_t work() const { return work_; }

private:
  /// What may become basic: a point, or the slack of an action.
  struct Column
  {
    enum class Kind : std::uint8_t
    {
      kPoint,
      kSlack,
      kBound,  // t
    };
    Kind kind;
    std::uint32_t index;
  };

  void startAtCorners();
  void readDuals();
  double cost(std::uint32_t point) const;
  bool bestColumn(double tolerance, Column& best) const;
  void price(double tolerance);
  bool enter(Column column);
  void collect(std::vector<Share>& shares);

  const GridPoints* points_ = nullptr;
  const std::vector<double>* belief_ = nullptr;
  std::vector<std::uint32_t> support_;  // states with a probability: the first rows
  std::vector<std::uint32_t> row_of_;   // shape [states]
  std::size_t num_rows_ = 0;            // support, then actions
  std::size_t stride_ = 0;              // of the inverse
  std::size_t bound_row_ = 0;           // where t is basic
  std::vector<double> inverse_;         // row-major, shape [rows, stride]
  std::vector<double> amounts_;         // of the basic columns
  std::vector<Column> basis_;
  std::vector<float> duals_;    // shape [stride of the points + actions]
  std::vector<double> column_;  // work space, as the next ones
  std::vector<double> direction_;
  std::vector<double> covered_;  // shape [states]
  std::vector<std::uint32_t> candidates_;
  std::vector<std::pair<double, std::uint32_t>> priced_;
  std::uint64_t work_ = 0;
};

}  // namespace kr3::pomdp
