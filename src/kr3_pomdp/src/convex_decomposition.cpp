#include "convex_decomposition.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lanes.hpp"
#include "multiversion.hpp"

namespace kr3::pomdp
{

namespace
{

constexpr std::size_t kMaxCandidates = 16;
constexpr std::size_t kMaxPivots = 400;
constexpr double kMostWork = 4e7;       // of the pivots of one program
constexpr std::size_t kMaxRows = 1200;  // more are left to the corners
constexpr double kLeastPivot = 1e-9;
constexpr double kLeastAmount = 1e-9;     // of a point; less is left to the corners
constexpr double kLeastRest = 1e-15;      // of a corner; less is rounding
constexpr double kSlackTolerance = 1e-3;  // weight of an action in the bound
constexpr double kFloatTolerance = 4e-6;  // relative to the values
constexpr float kOutside = -1e30F;        // dual of a state that the belief gives no probability

/// out = matrix vector
KR3_POMDP_MULTIVERSION void multiply(const double* matrix, const double* vector, double* out,
                                     std::size_t rows, std::size_t stride)
{
  for (std::size_t i = 0; i < rows; ++i)
  {
    const double* row = matrix + i * stride;
    Lanes sums{};
    for (std::size_t k = 0; k < stride; k += kLanes)
    {
      sums += lanesAt(row + k) * lanesAt(vector + k);
    }
    out[i] = sum(sums);
  }
}

/// Takes factors[i] times the pivot row from row i.
KR3_POMDP_MULTIVERSION void eliminate(double* matrix, const double* pivot_row,
                                      const double* factors, std::size_t rows, std::size_t stride)
{
  for (std::size_t i = 0; i < rows; ++i)
  {
    const double factor = factors[i];
    if (factor != 0.0)
    {
      double* row = matrix + i * stride;
      for (std::size_t k = 0; k < stride; ++k)
      {
        row[k] -= factor * pivot_row[k];
      }
    }
  }
}

}  // namespace

/// The corners make up the belief; t is what its best action gives, the other actions have slack.
void Decomposer::startAtCorners()
{
  const std::size_t num_actions = points_->numActions();
  const std::size_t m = support_.size();
  num_rows_ = m + num_actions;
  stride_ = padded(num_rows_);
  inverse_.assign(num_rows_ * stride_, 0.0);
  amounts_.assign(num_rows_, 0.0);
  basis_.assign(num_rows_, {});
  std::vector<Share> corners;
  for (const std::uint32_t s : support_)
  {
    corners.push_back({s, (*belief_)[s]});
  }
  const GridPoints::Best best = points_->best(corners);
  bound_row_ = m + best.action;
  for (std::size_t a = 0; a < num_actions; ++a)
  {
    double* row = inverse_.data() + (m + a) * stride_;
    double sum = 0.0;
    for (std::size_t i = 0; i < m; ++i)
    {
      const double* values = points_->values(support_[i]);
      row[i] = a == best.action ? values[a] : values[best.action] - values[a];
      sum += row[i] * corners[i].weight;
    }
    row[m + a] = 1.0;
    row[bound_row_] = -1.0;
    amounts_[m + a] = sum;
    basis_[m + a] = {Column::Kind::kSlack, static_cast<std::uint32_t>(a)};
  }
  basis_[bound_row_] = {Column::Kind::kBound, 0};
  for (std::size_t i = 0; i < m; ++i)
  {
    inverse_[i * stride_ + i] = 1.0;
    amounts_[i] = corners[i].weight;
    basis_[i] = {Column::Kind::kPoint, support_[i]};
  }
  work_ += num_rows_ * stride_ / 2;
  readDuals();
}

void Decomposer::readDuals()
{
  const double* row = inverse_.data() + bound_row_ * stride_;
  for (std::size_t i = 0; i < support_.size(); ++i)
  {
    duals_[support_[i]] = static_cast<float>(row[i]);
  }
  for (std::size_t a = 0; a < points_->numActions(); ++a)
  {
    duals_[points_->stride() + a] = static_cast<float>(-row[support_.size() + a]);
  }
}

/// By how much t grows with the amount of a point.
double Decomposer::cost(std::uint32_t point) const
{
  const float* of_actions = duals_.data() + points_->stride();
  const double* values = points_->values(point);
  double sum =
      points_->isCorner(point)
          ? -static_cast<double>(duals_[point])
          : -static_cast<double>(dot(duals_.data(), points_->rounded(point), points_->stride()));
  for (std::size_t a = 0; a < points_->numActions(); ++a)
  {
    sum += static_cast<double>(of_actions[a]) * values[a];
  }
  return sum;
}

/// Keeps the cheapest points as candidates.
void Decomposer::price(double tolerance)
{
  priced_.clear();
  for (std::uint32_t point = 0; point < points_->size(); ++point)
  {
    const double of_point = cost(point);
    if (of_point < -tolerance)
    {
      priced_.emplace_back(of_point, point);
    }
  }
  work_ += points_->size() * points_->stride() / 2;
  const std::size_t count = std::min(kMaxCandidates, priced_.size());
  std::partial_sort(priced_.begin(), priced_.begin() + static_cast<std::ptrdiff_t>(count),
                    priced_.end());
  candidates_.clear();
  for (std::size_t i = 0; i < count; ++i)
  {
    candidates_.push_back(priced_[i].second);
  }
}

bool Decomposer::bestColumn(double tolerance, Column& best) const
{
  double least = -tolerance;
  bool found = false;
  for (const std::uint32_t point : candidates_)
  {
    const double of_point = cost(point);
    if (of_point < least)
    {
      least = of_point;
      best = {Column::Kind::kPoint, point};
      found = true;
    }
  }
  for (std::uint32_t a = 0; a < points_->numActions(); ++a)
  {
    const auto of_slack = static_cast<double>(duals_[points_->stride() + a]);
    if (of_slack < std::min(least, -kSlackTolerance))
    {
      least = of_slack;
      best = {Column::Kind::kSlack, a};
      found = true;
    }
  }
  return found;
}

/// Makes a column basic; false if the numbers do not allow it.
bool Decomposer::enter(Column column)
{
  const std::size_t m = support_.size();
  column_.assign(stride_, 0.0);
  if (column.kind == Column::Kind::kSlack)
  {
    column_[m + column.index] = 1.0;
  }
  else
  {
    if (points_->isCorner(column.index))
    {
      column_[row_of_[column.index]] = 1.0;
    }
    else
    {
      for (const SparseEntry& entry : points_->belief(column.index))
      {
        column_[row_of_[entry.index]] = entry.probability;
      }
    }
    const double* values = points_->values(column.index);
    std::copy(values, values + points_->numActions(),
              column_.begin() + static_cast<std::ptrdiff_t>(m));
  }
  direction_.resize(num_rows_);
  multiply(inverse_.data(), column_.data(), direction_.data(), num_rows_, stride_);
  std::size_t leaving = num_rows_;
  double step = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < num_rows_; ++i)
  {
    if (i == bound_row_ || !(direction_[i] > kLeastPivot))
    {
      continue;
    }
    const double ratio = std::max(0.0, amounts_[i]) / direction_[i];
    if (ratio < step || (ratio == step && direction_[i] > direction_[leaving]))
    {
      step = ratio;
      leaving = i;
    }
  }
  if (leaving == num_rows_)
  {
    return false;
  }
  double* pivot_row = inverse_.data() + leaving * stride_;
  const double scale = 1.0 / direction_[leaving];
  for (std::size_t k = 0; k < stride_; ++k)
  {
    pivot_row[k] *= scale;
  }
  direction_[leaving] = 0.0;
  eliminate(inverse_.data(), pivot_row, direction_.data(), num_rows_, stride_);
  for (std::size_t i = 0; i < num_rows_; ++i)
  {
    amounts_[i] -= direction_[i] * step;
  }
  amounts_[leaving] = step;
  basis_[leaving] = column;
  work_ += 2 * num_rows_ * stride_;
  readDuals();
  return true;
}

/// The basic points, made a little smaller where they would exceed the belief; corners fill it up.
void Decomposer::collect(std::vector<Share>& shares)
{
  shares.clear();
  covered_.assign(points_->numStates(), 0.0);
  for (std::size_t i = 0; i < num_rows_; ++i)
  {
    if (basis_[i].kind != Column::Kind::kPoint || points_->isCorner(basis_[i].index) ||
        !(amounts_[i] > kLeastAmount))
    {
      continue;
    }
    shares.push_back({basis_[i].index, amounts_[i]});
    for (const SparseEntry& entry : points_->belief(basis_[i].index))
    {
      covered_[entry.index] += amounts_[i] * entry.probability;
    }
  }
  double factor = 1.0;
  for (std::size_t s = 0; s < covered_.size(); ++s)
  {
    if (!(covered_[s] * factor <= (*belief_)[s]))
    {
      factor = (*belief_)[s] / covered_[s];
    }
  }
  if (!(factor > 0.5))  // the numbers went astray
  {
    shares.clear();
    std::fill(covered_.begin(), covered_.end(), 0.0);
  }
  for (Share& share : shares)
  {
    share.weight *= factor;
  }
  for (const std::uint32_t s : support_)
  {
    const double rest = (*belief_)[s] - factor * covered_[s];
    if (rest > kLeastRest)
    {
      shares.push_back({s, rest});
    }
  }
}

void Decomposer::decompose(const GridPoints& points, const std::vector<double>& belief,
                           double tolerance, std::vector<Share>& shares, std::vector<float>& duals,
                           const std::function<bool()>& keep_going)
{
  points_ = &points;
  belief_ = &belief;
  support_.clear();
  row_of_.assign(points.numStates(), 0);
  duals_.assign(points.stride() + points.numActions(), kOutside);
  double scale = 0.0;
  for (std::uint32_t s = 0; s < points.numStates(); ++s)
  {
    if (belief[s] > 0.0)
    {
      row_of_[s] = static_cast<std::uint32_t>(support_.size());
      support_.push_back(s);
      scale = std::max(scale, std::abs(points.best(s).value));
    }
  }
  if (support_.size() + points.numActions() > kMaxRows)
  {
    basis_.clear();
    num_rows_ = 0;
    collect(shares);
    duals.assign(duals_.size(), 0.0F);  // no point promises anything
    return;
  }
  tolerance = std::max(tolerance, kFloatTolerance * scale);
  startAtCorners();
  const auto of_pivot = static_cast<double>(2 * num_rows_ * stride_);
  const auto most_pivots = std::min(kMaxPivots, 1 + static_cast<std::size_t>(kMostWork / of_pivot));
  candidates_.clear();
  for (const Share& share : shares)
  {
    if (!points.isCorner(share.point))
    {
      candidates_.push_back(share.point);
    }
  }
  Column best{};
  for (std::size_t i = 0; i < most_pivots && keep_going(); ++i)
  {
    if (!bestColumn(tolerance, best))
    {
      price(tolerance);
      if (!bestColumn(tolerance, best))
      {
        break;
      }
    }
    if (!enter(best))
    {
      break;
    }
  }
  collect(shares);
  duals = duals_;
}

}  // namespace kr3::pomdp
