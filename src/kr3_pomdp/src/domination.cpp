#include "domination.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace kr3::pomdp
{

namespace
{

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// The game's entries lie in [1, 2].
constexpr double kTolerance = 1e-14;
constexpr double kLeastPivot = 1e-9;
constexpr double kSlip = 1e-14;  // how far below 0 a level may get, for the sake of a greater pivot
constexpr std::size_t kRefresh = 32;  // pivots after which the inverse is computed anew

double dot(const double* a, const double* b, std::size_t size)
{
  double sum = 0.0;
  for (std::size_t i = 0; i < size; ++i)
  {
    sum += a[i] * b[i];
  }
  return sum;
}

/// The game in which one side picks a belief b and the other a vector i, for the payoff
/// A_i . b with A_i = (vector - set_i - least) / range + 1, in [1, 2].
///
/// With y the weights of the vectors over the value: maximise sum_i y_i subject to
/// sum_i A_i(s) y_i <= 1 for each s, y >= 0. The multipliers of the constraints are the belief over
/// the value.
class Game
{
public:
  Game(const std::vector<double>& vector, const std::vector<const double*>& set)
    : vector_(&vector)
    , set_(&set)
    , size_(vector.size())
    , basis_(size_)
    , levels_(size_, 1.0)
    , inverse_(size_ * size_, 0.0)
    , prices_(size_)
    , column_(size_)
  {
    least_ = kInfinity;
    double greatest = -kInfinity;
    for (const double* other : set)
    {
      for (std::size_t s = 0; s < size_; ++s)
      {
        least_ = std::min(least_, vector[s] - other[s]);
        greatest = std::max(greatest, vector[s] - other[s]);
      }
    }
    range_ = std::max(greatest - least_, 1e-300);
    for (std::size_t s = 0; s < size_; ++s)
    {
      basis_[s] = set.size() + s;  // slack of state s
      inverse_[s * size_ + s] = 1.0;
    }
  }

  Margin solve(std::optional<double> threshold)
  {
    Margin best{-kInfinity, kInfinity, {}};
    const std::size_t patience = 20 * (size_ + 5);
    for (std::size_t pivot = 0; pivot < 50 * patience; ++pivot)
    {
      computePrices();
      improveLower(best);
      improveUpper(best);
      const bool decided = threshold ? best.lower > *threshold || best.upper <= *threshold
                                     : best.upper - best.lower <= kTolerance * range_;
      if (decided)
      {
        break;
      }
      const bool careful = pivot > patience;
      bool moved = enter(careful) && leave(careful);
      if (!moved && since_refresh_ > 0)
      {
        refresh();  // rounding may have hidden a way on
        computePrices();
        improveLower(best);
        improveUpper(best);
        moved = enter(careful) && leave(careful);
      }
      if (!moved)
      {
        break;
      }
      if (++since_refresh_ >= kRefresh)
      {
        refresh();
      }
    }
    return best;
  }

private:
  [[nodiscard]] double entry(std::size_t i, std::size_t s) const
  {
    return ((*vector_)[s] - (*set_)[i][s] - least_) / range_ + 1.0;
  }

  void computePrices()
  {
    std::fill(prices_.begin(), prices_.end(), 0.0);
    for (std::size_t r = 0; r < size_; ++r)
    {
      if (basis_[r] < set_->size())
      {
        for (std::size_t s = 0; s < size_; ++s)
        {
          prices_[s] += inverse_[r * size_ + s];
        }
      }
    }
  }

  /// The margin at the belief that the prices stand for.
  void improveLower(Margin& best)
  {
    double sum = 0.0;
    std::vector<double> belief(size_);
    for (std::size_t s = 0; s < size_; ++s)
    {
      belief[s] = std::max(0.0, prices_[s]);
      sum += belief[s];
    }
    if (sum <= 0.0)
    {
      return;
    }
    for (double& p : belief)
    {
      p /= sum;
    }
    double greatest = -kInfinity;
    for (const double* other : *set_)
    {
      greatest = std::max(greatest, dot(other, belief.data(), size_));
    }
    const double margin = dot(vector_->data(), belief.data(), size_) - greatest;
    if (margin > best.lower)
    {
      best.lower = margin;
      best.belief = std::move(belief);
    }
  }

  /// The greatest entry of the vector minus the combination of the set that the levels stand for.
  void improveUpper(Margin& best) const
  {
    double sum = 0.0;
    std::vector<double> combined(size_, 0.0);
    for (std::size_t r = 0; r < size_; ++r)
    {
      if (basis_[r] < set_->size() && levels_[r] > 0.0)
      {
        sum += levels_[r];
        for (std::size_t s = 0; s < size_; ++s)
        {
          combined[s] += levels_[r] * (*set_)[basis_[r]][s];
        }
      }
    }
    if (sum <= 0.0)
    {
      return;
    }
    double greatest = -kInfinity;
    for (std::size_t s = 0; s < size_; ++s)
    {
      greatest = std::max(greatest, (*vector_)[s] - combined[s] / sum);
    }
    best.upper = std::min(best.upper, greatest);
  }

  /// Picks the column that enters: the one of greatest gain or, against cycles, the first with any.
  bool enter(bool first)
  {
    double greatest = kTolerance;
    entering_ = set_->size() + size_;
    const double offset = [this] {
      double sum = 0.0;
      for (std::size_t s = 0; s < size_; ++s)
      {
        sum += prices_[s] * (((*vector_)[s] - least_) / range_ + 1.0);
      }
      return sum;
    }();
    for (std::size_t i = 0; i < set_->size() + size_ && !(first && greatest > kTolerance); ++i)
    {
      const double gain = i < set_->size()
                              ? 1.0 - offset + dot(prices_.data(), (*set_)[i], size_) / range_
                              : -prices_[i - set_->size()];
      if (gain > greatest)
      {
        greatest = gain;
        entering_ = i;
      }
    }
    return entering_ < set_->size() + size_;
  }

  /// Brings the column in for the one that reaches 0 first: of those that do so nearly together the
  /// one with the greatest pivot or, against cycles, the one of least number.
  bool leave(bool first)
  {
    for (std::size_t r = 0; r < size_; ++r)
    {
      column_[r] = 0.0;
      if (entering_ >= set_->size())
      {
        column_[r] = inverse_[r * size_ + entering_ - set_->size()];
        continue;
      }
      for (std::size_t s = 0; s < size_; ++s)
      {
        column_[r] += inverse_[r * size_ + s] * entry(entering_, s);
      }
    }
    double limit = kInfinity;
    for (std::size_t r = 0; r < size_; ++r)
    {
      if (column_[r] > kLeastPivot)
      {
        limit = std::min(limit, (std::max(0.0, levels_[r]) + (first ? 0.0 : kSlip)) / column_[r]);
      }
    }
    std::size_t leaving = size_;
    for (std::size_t r = 0; r < size_; ++r)
    {
      if (column_[r] > kLeastPivot && std::max(0.0, levels_[r]) / column_[r] <= limit &&
          (leaving == size_ ||
           (first ? basis_[r] < basis_[leaving] : column_[r] > column_[leaving])))
      {
        leaving = r;
      }
    }
    if (leaving == size_)
    {
      return false;
    }
    const double pivot = column_[leaving];
    double* pivot_row = inverse_.data() + leaving * size_;
    for (std::size_t s = 0; s < size_; ++s)
    {
      pivot_row[s] /= pivot;
    }
    levels_[leaving] /= pivot;
    for (std::size_t r = 0; r < size_; ++r)
    {
      if (r != leaving && column_[r] != 0.0)
      {
        for (std::size_t s = 0; s < size_; ++s)
        {
          inverse_[r * size_ + s] -= column_[r] * pivot_row[s];
        }
        levels_[r] -= column_[r] * levels_[leaving];
      }
    }
    basis_[leaving] = entering_;
    return true;
  }

  /// Computes inverse and levels from the basis, by elimination with row pivots.
  void refresh()
  {
    since_refresh_ = 0;
    std::vector<double> matrix(size_ * size_, 0.0);  // a basic column in each column
    for (std::size_t r = 0; r < size_; ++r)
    {
      for (std::size_t s = 0; s < size_; ++s)
      {
        matrix[s * size_ + r] = basis_[r] < set_->size()
                                    ? entry(basis_[r], s)
                                    : static_cast<double>(basis_[r] - set_->size() == s);
      }
    }
    std::fill(inverse_.begin(), inverse_.end(), 0.0);
    for (std::size_t s = 0; s < size_; ++s)
    {
      inverse_[s * size_ + s] = 1.0;
    }
    const auto at = [this](std::vector<double>& values, std::size_t row) {
      return values.begin() + static_cast<std::ptrdiff_t>(row * size_);
    };
    for (std::size_t c = 0; c < size_; ++c)
    {
      std::size_t pivot = c;
      for (std::size_t r = c + 1; r < size_; ++r)
      {
        pivot = std::abs(matrix[r * size_ + c]) > std::abs(matrix[pivot * size_ + c]) ? r : pivot;
      }
      if (pivot != c)
      {
        std::swap_ranges(at(matrix, c), at(matrix, c + 1), at(matrix, pivot));
        std::swap_ranges(at(inverse_, c), at(inverse_, c + 1), at(inverse_, pivot));
      }
      const double scale = 1.0 / matrix[c * size_ + c];
      for (std::size_t s = 0; s < size_; ++s)
      {
        matrix[c * size_ + s] *= scale;
        inverse_[c * size_ + s] *= scale;
      }
      for (std::size_t r = 0; r < size_; ++r)
      {
        const double factor = matrix[r * size_ + c];
        if (r != c && factor != 0.0)
        {
          for (std::size_t s = 0; s < size_; ++s)
          {
            matrix[r * size_ + s] -= factor * matrix[c * size_ + s];
            inverse_[r * size_ + s] -= factor * inverse_[c * size_ + s];
          }
        }
      }
    }
    for (std::size_t r = 0; r < size_; ++r)
    {
      levels_[r] = 0.0;
      for (std::size_t s = 0; s < size_; ++s)
      {
        levels_[r] += inverse_[r * size_ + s];
      }
    }
  }

  const std::vector<double>* vector_;
  const std::vector<const double*>* set_;
  std::size_t size_;                // states
  double least_ = 0.0;              // of vector - set
  double range_ = 1.0;              // of vector - set
  std::vector<std::size_t> basis_;  // numbers of vectors, then of slacks; shape [states]
  std::vector<double> levels_;      // of the basic columns
  std::vector<double> inverse_;     // of the basis, row-major
  std::vector<double> prices_;      // multipliers of the constraints, shape [states]
  std::vector<double> column_;      // the entering one in terms of the basis
  std::size_t entering_ = 0;
  std::size_t since_refresh_ = 0;  // pivots
};

}  // namespace

Margin marginOver(const std::vector<double>& vector, const std::vector<const double*>& set,
                  std::optional<double> threshold)
{
  if (set.empty())
  {
    std::vector<double> belief(vector.size(), 0.0);
    belief.front() = 1.0;
    return {kInfinity, kInfinity, std::move(belief)};
  }
  return Game(vector, set).solve(threshold);
}

}  // namespace kr3::pomdp
