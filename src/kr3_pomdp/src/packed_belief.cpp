#include "packed_belief.hpp"

#include <algorithm>

#include "lanes.hpp"
#include "multiversion.hpp"

namespace kr3::pomdp
{

KR3_POMDP_MULTIVERSION double dot(const PackedBelief& belief, const double* values)
{
  return dotLanes(belief, values);
}

void UnpackedBelief::reset(std::size_t num_states)
{
  for (const std::uint32_t block : blocks_)
  {
    std::fill_n(values_.begin() + static_cast<std::ptrdiff_t>(block * kLanes), kLanes, 0.0);
    touched_[block] = 0;
  }
  blocks_.clear();
  num_states_ = num_states;
  if (values_.size() < padded(num_states))
  {
    values_.resize(padded(num_states), 0.0);
    touched_.resize(values_.size() / kLanes, 0);
  }
}

void UnpackedBelief::assign(std::size_t num_states, const PackedBelief& belief)
{
  reset(num_states);
  for (std::size_t i = 0; i < belief.num_blocks * kLanes; ++i)
  {
    if (belief.values[i] > 0.0)
    {
      add(belief.blocks[i / kLanes] * kLanes + i % kLanes, belief.values[i]);
    }
  }
  finish(1.0);
}

void UnpackedBelief::finish(double total)
{
  std::sort(blocks_.begin(), blocks_.end());
  packed_.resize(blocks_.size() * kLanes);
  support_ = 0;
  sums_.fill(0.0F);
  for (std::size_t k = 0; k < blocks_.size(); ++k)
  {
    double* block = values_.data() + blocks_[k] * kLanes;
    for (std::size_t lane = 0; lane < kLanes; ++lane)
    {
      block[lane] /= total;
      packed_[k * kLanes + lane] = block[lane];
      const std::size_t state = blocks_[k] * kLanes + lane;
      support_ |= block[lane] > 0.0 ? std::uint64_t{1} << (state % 64) : 0;
      sums_[state % kParts] += static_cast<float>(block[lane]);
    }
  }
}

}  // namespace kr3::pomdp
