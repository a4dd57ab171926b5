#include "vector_set.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace kr3::pomdp
{

namespace
{

/// Stands for 1/0 in a product with a probability that is never below kTiny.
constexpr double kHuge = 1e300;
constexpr double kTiny = 1e-200;

/// Whether no entry of `upper` is below its entry of `lower`.
bool dominates(const double* upper, const double* lower, std::size_t size)
{
  for (std::size_t s = 0; s < size; s += kLanes)
  {
    bool below = false;
    for (std::size_t lane = 0; lane < kLanes; ++lane)
    {
      below |= upper[s + lane] < lower[s + lane];
    }
    if (below)
    {
      return false;
    }
  }
  return true;
}

/// Separate sums, because the compiler may not reorder one.
double dot(const double* a, const double* b, std::size_t size)
{
  std::array<double, kLanes> sums{};
  for (std::size_t s = 0; s < size; s += kLanes)
  {
    for (std::size_t lane = 0; lane < kLanes; ++lane)
    {
      sums[lane] += a[s + lane] * b[s + lane];
    }
  }
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

}  // namespace

std::uint32_t VectorSet::add(std::uint32_t action, const std::vector<double>& values)
{
  const std::uint32_t number = end();
  std::vector<double> row(values);
  row.resize(stride_, 0.0);
  for (std::uint32_t i = number; i-- > 0;)  // recent ones are the likeliest to dominate
  {
    if (isAlive(i) && dominates(this->values(i), row.data(), stride_))
    {
      return i;
    }
  }
  for (std::uint32_t i = 0; i < number; ++i)
  {
    if (isAlive(i) && dominates(row.data(), this->values(i), stride_))
    {
      replacement_[i] = number;
      --num_alive_;
    }
  }
  values_.insert(values_.end(), row.begin(), row.end());
  actions_.push_back(action);
  replacement_.push_back(number);
  ++num_alive_;
  return number;
}

std::uint32_t VectorSet::living(std::uint32_t i) const
{
  while (replacement_[i] != i)
  {
    i = replacement_[i];
  }
  return i;
}

VectorSet::Best VectorSet::best(const double* belief, std::uint32_t first, Best known) const
{
  for (std::uint32_t i = first; i < end(); ++i)
  {
    if (isAlive(i))
    {
      const double value = dot(belief, values(i), stride_);
      if (value > known.value)
      {
        known = {value, i};
      }
    }
  }
  return known;
}

std::size_t VectorSet::sizeInBytes() const
{
  return sizeof(*this) + values_.capacity() * sizeof(double) +
         (actions_.capacity() + replacement_.capacity()) * sizeof(std::uint32_t);
}

SawtoothSet::SawtoothSet(std::vector<double> corners) : corners_(std::move(corners))
{
  corners_.resize(padded(corners_.size()), 0.0);
  floored_.resize(corners_.size());
}

std::uint32_t SawtoothSet::add(const double* belief, double value)
{
  for (std::size_t s = 0; s < corners_.size(); ++s)
  {
    inverse_.push_back(belief[s] > 0.0 ? 1.0 / belief[s] : kHuge);
  }
  gains_.push_back(std::min(0.0, value - dot(belief, corners_.data(), corners_.size())));
  return end() - 1;
}

double SawtoothSet::value(const double* belief, std::uint32_t first) const
{
  const std::size_t stride = corners_.size();
  for (std::size_t s = 0; s < stride; ++s)
  {
    floored_[s] = std::max(belief[s], kTiny);
  }
  double greatest_drop = 0.0;
  const double* inverse = inverse_.data() + first * stride;
  for (std::uint32_t i = first; i < end(); ++i, inverse += stride)
  {
    if (gains_[i] >= greatest_drop)
    {
      continue;  // even the whole gain is less than what is known
    }
    // Below this part of the gain the point tells nothing new; most points fail
    // in a few states.
    const double least_ratio = greatest_drop / gains_[i];
    double ratio = 1.0;
    for (std::size_t s = 0; s < stride && ratio > least_ratio; s += kLanes)
    {
      const double first_two = std::min(floored_[s] * inverse[s], floored_[s + 1] * inverse[s + 1]);
      const double last_two =
          std::min(floored_[s + 2] * inverse[s + 2], floored_[s + 3] * inverse[s + 3]);
      ratio = std::min(ratio, std::min(first_two, last_two));
    }
    greatest_drop = std::min(greatest_drop, ratio * gains_[i]);
  }
  return dot(belief, corners_.data(), stride) + greatest_drop;
}

std::size_t SawtoothSet::sizeInBytes() const
{
  return sizeof(*this) +
         (corners_.capacity() + floored_.capacity() + inverse_.capacity() + gains_.capacity()) *
             sizeof(double);
}

}  // namespace kr3::pomdp
