#include "sawtooth_set.hpp"

#include <algorithm>
#include <utility>

#include "lanes.hpp"
#include "multiversion.hpp"

namespace kr3::pomdp
{

namespace
{

/// Removed points that are worth moving the others, and the part of all rows.
constexpr std::size_t kFewRemoved = 64;
constexpr std::size_t kRemovedPart = 8;

/// What is looked at, point by point, from the cheapest to the dearest.
struct Points
{
  const double* gains;
  const std::uint64_t* supports;
  const PartSums* sums;
  const PackedBelief* beliefs;
  std::size_t first;
  std::size_t last;
};

/// Whether some part has less than `ratio` times what it has in the point: then so does a state.
inline bool lacksPart(const PartSums& belief, const PartSums& point, float ratio)
{
  return anyLess(lanesAt(belief), ratio * lanesAt(point));
}

/// min over the point's states of belief / point; or something below `least`, when it is below.
inline double ratioAbove(const double* belief, const PackedBelief& point, double least)
{
  for (std::size_t k = 0; k < point.num_blocks; ++k)
  {
    if (anyLess(lanesAt(belief + point.blocks[k] * kLanes),
                least * lanesAt(point.values + k * kLanes)))
    {
      return -1.0;
    }
  }
  double ratio = 1.0;
  for (std::size_t i = 0; i < point.num_blocks * kLanes; ++i)
  {
    if (point.values[i] > 0.0)
    {
      ratio =
          std::min(ratio, belief[point.blocks[i / kLanes] * kLanes + i % kLanes] / point.values[i]);
    }
  }
  return ratio;
}

/// The most, as a negative number, that a point takes off the corners' value; never above `known`.
/// Leaving a point out, as rounding in the first tests may, gives a looser bound, never a false
/// one.
KR3_POMDP_MULTIVERSION double greatestDrop(const Points& points, const double* belief,
                                           std::uint64_t support, const PartSums& sums,
                                           double known)
{
  double greatest = known;
  for (std::size_t i = points.first; i < points.last; ++i)
  {
    if (points.gains[i] >= greatest || (points.supports[i] & ~support) != 0)
    {
      continue;  // even its whole gain is less than what is known, or nothing of it applies
    }
    // Below this part of its gain the point tells nothing new; most fail in a few states.
    const double least = greatest / points.gains[i];
    if (lacksPart(sums, points.sums[i], static_cast<float>(least)))
    {
      continue;
    }
    const double ratio = ratioAbove(belief, points.beliefs[i], least);
    greatest = std::min(greatest, ratio * points.gains[i]);
  }
  return greatest;
}

}  // namespace

SawtoothSet::SawtoothSet(std::vector<double> corners) : corners_(std::move(corners))
{
  corners_.resize(padded(corners_.size()), 0.0);
}

std::uint32_t SawtoothSet::add(const UnpackedBelief& belief, const PackedBelief& stored,
                               double value)
{
  const std::size_t num_removed = gains_.size() - num_alive_;
  if (num_removed > kFewRemoved && num_removed > gains_.size() / kRemovedPart)
  {
    compact();
  }
  gains_.push_back(std::min(0.0, value - dot(stored, corners_.data())));
  supports_.push_back(belief.support());
  sums_.push_back(belief.sums());
  beliefs_.push_back(stored);
  numbers_.push_back(end_);
  num_alive_ += gains_.back() < 0.0 ? 1 : 0;
  return end_++;
}

void SawtoothSet::remove(std::uint32_t point)
{
  const auto found = std::lower_bound(numbers_.begin(), numbers_.end(), point);
  if (found == numbers_.end() || *found != point)
  {
    return;  // it told nothing and is gone
  }
  double& gain = gains_[static_cast<std::size_t>(found - numbers_.begin())];
  num_alive_ -= gain < 0.0 ? 1 : 0;
  gain = 0.0;
}

void SawtoothSet::compact()
{
  std::size_t to = 0;
  for (std::size_t from = 0; from < gains_.size(); ++from)
  {
    if (gains_[from] < 0.0)
    {
      gains_[to] = gains_[from];
      supports_[to] = supports_[from];
      sums_[to] = sums_[from];
      beliefs_[to] = beliefs_[from];
      numbers_[to] = numbers_[from];
      ++to;
    }
  }
  gains_.resize(to);
  supports_.resize(to);
  sums_.resize(to);
  beliefs_.resize(to);
  numbers_.resize(to);
  num_alive_ = to;
}

double SawtoothSet::value(const UnpackedBelief& belief, std::uint32_t first, double known) const
{
  const auto first_row = static_cast<std::size_t>(
      std::lower_bound(numbers_.begin(), numbers_.end(), first) - numbers_.begin());
  const double at_corners = dot(belief.packed(), corners_.data());
  const double drop = greatestDrop(
      {gains_.data(), supports_.data(), sums_.data(), beliefs_.data(), first_row, gains_.size()},
      belief.values(), belief.support(), belief.sums(), std::min(0.0, known - at_corners));
  return std::min(known, at_corners + drop);
}

std::size_t SawtoothSet::sizeInBytes() const
{
  return sizeof(*this) + (corners_.capacity() + gains_.capacity()) * sizeof(double) +
         supports_.capacity() * sizeof(std::uint64_t) + sums_.capacity() * sizeof(PartSums) +
         beliefs_.capacity() * sizeof(PackedBelief) + numbers_.capacity() * sizeof(std::uint32_t);
}

}  // namespace kr3::pomdp
