#include "grid_points.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include "lanes.hpp"
#include "multiversion.hpp"

namespace kr3::pomdp
{

KR3_POMDP_MULTIVERSION float dot(const float* a, const float* b, std::size_t size)
{
  FloatLanes sums{};
  for (std::size_t i = 0; i < size; i += kFloatLanes)
  {
    sums +=
        *reinterpret_cast<const FloatLanes*>(a + i) * *reinterpret_cast<const FloatLanes*>(b + i);
  }
  std::array<float, kFloatLanes> parts{};
  std::memcpy(parts.data(), &sums, sizeof(sums));
  for (std::size_t half = kFloatLanes / 2; half > 0; half /= 2)
  {
    for (std::size_t lane = 0; lane < half; ++lane)
    {
      parts[lane] += parts[lane + half];
    }
  }
  return parts[0];
}

GridPoints::GridPoints(std::size_t num_states, const std::vector<std::vector<double>>& informed)
  : num_states_(num_states)
  , num_actions_(informed.size())
  , stride_((num_states_ + kFloatLanes - 1) / kFloatLanes * kFloatLanes)
  , num_points_(static_cast<std::uint32_t>(num_states_))
{
  values_.reserve(num_states_ * num_actions_);
  for (std::size_t s = 0; s < num_states_; ++s)
  {
    for (const std::vector<double>& of_action : informed)
    {
      values_.push_back(of_action[s]);
    }
  }
}

std::uint32_t GridPoints::add(const std::vector<double>& belief, const std::vector<double>& values)
{
  std::vector<SparseEntry> entries;
  for (std::uint32_t s = 0; s < num_states_; ++s)
  {
    rounded_.push_back(static_cast<float>(belief[s]));
    if (belief[s] > 0.0)
    {
      entries.push_back({s, belief[s]});
    }
  }
  entries.shrink_to_fit();
  num_entries_ += entries.size();
  beliefs_.push_back(std::move(entries));
  rounded_.resize(beliefs_.size() * stride_, 0.0F);
  values_.insert(values_.end(), values.begin(), values.end());
  return num_points_++;
}

void GridPoints::tighten(std::uint32_t point, std::size_t action, double value)
{
  double& known = values_[point * num_actions_ + action];
  known = std::min(known, value);
}

GridPoints::Best GridPoints::best(std::uint32_t point) const
{
  const double* first = values(point);
  const double* greatest = std::max_element(first, first + num_actions_);
  return {static_cast<std::size_t>(greatest - first), *greatest};
}

GridPoints::Best GridPoints::best(const std::vector<Share>& shares) const
{
  Best best{0, -std::numeric_limits<double>::infinity()};
  for (std::size_t a = 0; a < num_actions_; ++a)
  {
    double sum = 0.0;
    for (const Share& share : shares)
    {
      sum += share.weight * values_[share.point * num_actions_ + a];
    }
    if (sum > best.value)
    {
      best = {a, sum};
    }
  }
  return best;
}

double GridPoints::leastCost(const std::vector<float>& duals, std::uint32_t first) const
{
  double least = 0.0;
  for (std::uint32_t i = std::max(first, static_cast<std::uint32_t>(num_states_)); i < num_points_;
       ++i)
  {
    double cost = -static_cast<double>(dot(duals.data(), rounded(i), stride_));
    for (std::size_t a = 0; a < num_actions_; ++a)
    {
      cost += static_cast<double>(duals[stride_ + a]) * values(i)[a];
    }
    least = std::min(least, cost);
  }
  return least;
}

std::size_t GridPoints::sizeInBytes() const
{
  return beliefs_.capacity() * sizeof(beliefs_[0]) + num_entries_ * sizeof(SparseEntry) +
         rounded_.capacity() * sizeof(float) + values_.capacity() * sizeof(double);
}

}  // namespace kr3::pomdp
