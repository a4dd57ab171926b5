#include "vector_set.hpp"

#include <algorithm>

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
  for (std::size_t s = 0; s < size; ++s)
  {
    if (upper[s] < lower[s])
    {
      return false;
    }
  }
  return true;
}

/// Four running sums: the compiler may not reorder one.
double dot(const double* a, const double* b, std::size_t size)
{
  double sums[4] = {0.0, 0.0, 0.0, 0.0};
  std::size_t s = 0;
  for (; s + 4 <= size; s += 4)
  {
    sums[0] += a[s] * b[s];
    sums[1] += a[s + 1] * b[s + 1];
    sums[2] += a[s + 2] * b[s + 2];
    sums[3] += a[s + 3] * b[s + 3];
  }
  double sum = (sums[0] + sums[1]) + (sums[2] + sums[3]);
  for (; s < size; ++s)
  {
    sum += a[s] * b[s];
  }
  return sum;
}

}  // namespace

std::uint32_t VectorSet::add(std::uint32_t action, const std::vector<double>& values)
{
  const std::uint32_t number = end();
  for (std::uint32_t i = number; i-- > 0;)  // recent ones are the likeliest to dominate
  {
    if (isAlive(i) && dominates(this->values(i), values.data(), num_states_))
    {
      return i;
    }
  }
  for (std::uint32_t i = 0; i < number; ++i)
  {
    if (isAlive(i) && dominates(values.data(), this->values(i), num_states_))
    {
      replacement_[i] = number;
      --num_alive_;
    }
  }
  values_.insert(values_.end(), values.begin(), values.end());
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
      const double value = dot(belief, values(i), num_states_);
      if (value > known.value)
      {
        known = {value, i};
      }
    }
  }
  return known;
}

void SawtoothSet::add(const double* belief, double value)
{
  for (std::size_t s = 0; s < corners_.size(); ++s)
  {
    inverse_.push_back(belief[s] > 0.0 ? 1.0 / belief[s] : kHuge);
  }
  gains_.push_back(std::min(0.0, value - cornerValue(belief)));
  ++num_points_;
}

double SawtoothSet::cornerValue(const double* belief) const
{
  return dot(belief, corners_.data(), corners_.size());
}

double SawtoothSet::value(const double* belief, std::uint32_t first) const
{
  double greatest_drop = 0.0;
  const std::size_t size = corners_.size();
  for (std::uint32_t i = first; i < num_points_; ++i)
  {
    const double* inverse = inverse_.data() + i * size;
    const double gain = gains_[i];
    double ratio = 1.0;
    for (std::size_t s = 0; s < size; ++s)
    {
      ratio = std::min(ratio, std::max(belief[s], kTiny) * inverse[s]);
    }
    greatest_drop = std::min(greatest_drop, ratio * gain);
  }
  return cornerValue(belief) + greatest_drop;
}

}  // namespace kr3::pomdp
