#pragma once

#include <cstddef>
#include <cstdint>

#include "packed_belief.hpp"

/// Blocks of numbers that are worked on at once, on any machine: the compiler takes as many
/// instructions as its vectors need.
namespace kr3::pomdp
{

using Lanes = double __attribute__((vector_size(64), aligned(8), may_alias));
using FloatLanes = float __attribute__((vector_size(64), aligned(4), may_alias));
using MaskLanes = std::int64_t __attribute__((vector_size(64), aligned(8), may_alias));
static_assert(sizeof(Lanes) == kLanes * sizeof(double));
static_assert(sizeof(FloatLanes) == sizeof(PartSums));

/// kLanes numbers from an address of any alignment.
inline const Lanes& lanesAt(const double* values)
{
  return *reinterpret_cast<const Lanes*>(values);
}
inline const FloatLanes& lanesAt(const PartSums& sums)
{
  return *reinterpret_cast<const FloatLanes*>(sums.data());
}

/// The sum, always in the same order.
inline double sum(const Lanes& lanes)
{
  return ((lanes[0] + lanes[4]) + (lanes[2] + lanes[6])) +
         ((lanes[1] + lanes[5]) + (lanes[3] + lanes[7]));
}

/// Whether some bit is set.
inline bool any(const MaskLanes& mask)
{
  const auto half = __builtin_shufflevector(mask, mask, 0, 1, 2, 3) |
                    __builtin_shufflevector(mask, mask, 4, 5, 6, 7);
  const auto quarter =
      __builtin_shufflevector(half, half, 0, 1) | __builtin_shufflevector(half, half, 2, 3);
  return (quarter[0] | quarter[1]) != 0;
}
inline bool anyLess(const Lanes& a, const Lanes& b)
{
  return any(a < b);
}
inline bool anyLess(const FloatLanes& a, const FloatLanes& b)
{
  const auto less = a < b;
  return any(reinterpret_cast<const MaskLanes&>(less));
}

/// sum_s belief(s) values[s]; inlined into loops over many arrays of values.
inline double dotLanes(const PackedBelief& belief, const double* values)
{
  Lanes sums{};
  for (std::size_t k = 0; k < belief.num_blocks; ++k)
  {
    sums += lanesAt(belief.values + k * kLanes) * lanesAt(values + belief.blocks[k] * kLanes);
  }
  return sum(sums);
}

}  // namespace kr3::pomdp
