#include "vector_set.hpp"

#include <algorithm>
#include <cstring>

#include "lanes.hpp"
#include "multiversion.hpp"

namespace kr3::pomdp
{

namespace
{

/// Dead rows that are worth moving the others, and the part of all rows.
constexpr std::size_t kFewDead = 16;
constexpr std::size_t kDeadPart = 8;

/// How two rows may lie to each other, as far as sums can tell.
struct Relation
{
  bool never_above;
  bool never_below;
};

PartSums partSums(const double* values, std::size_t size)
{
  PartSums sums{};
  std::array<double, kParts> exact{};
  for (std::size_t s = 0; s < size; ++s)
  {
    exact[s % kParts] += values[s];
  }
  std::copy(exact.begin(), exact.end(), sums.begin());
  return sums;
}

inline Relation relation(const PartSums& a, const PartSums& b)
{
  return {!anyLess(lanesAt(b), lanesAt(a)), !anyLess(lanesAt(a), lanesAt(b))};
}

/// Whether no entry of `upper` is below its entry of `lower`.
inline bool dominates(const double* upper, const double* lower, std::size_t size)
{
  for (std::size_t s = 0; s < size; s += kLanes)
  {
    if (anyLess(lanesAt(upper + s), lanesAt(lower + s)))
    {
      return false;
    }
  }
  return true;
}

/// The rows that a new one stands to.
struct Domination
{
  std::size_t dominating;              // a row nowhere below the new one; the end if none
  std::vector<std::size_t> dominated;  // rows nowhere above the new one
};

KR3_POMDP_MULTIVERSION void compareRows(const double* row, const PartSums& row_sums,
                                        const std::vector<double>& values,
                                        const std::vector<PartSums>& sums,
                                        const std::vector<std::uint8_t>& alive, std::size_t stride,
                                        Domination& result)
{
  result.dominating = alive.size();
  for (std::size_t i = 0; i < alive.size(); ++i)
  {
    const Relation likely = relation(row_sums, sums[i]);
    if (alive[i] == 0 || !(likely.never_above || likely.never_below))
    {
      continue;
    }
    const double* other = values.data() + i * stride;
    if (likely.never_above && dominates(other, row, stride))
    {
      result.dominating = i;
      return;
    }
    if (likely.never_below && dominates(row, other, stride))
    {
      result.dominated.push_back(i);
    }
  }
}

struct BestRow
{
  double value;
  std::size_t row;
};

KR3_POMDP_MULTIVERSION void findBest(const PackedBelief& belief, const double* rows,
                                     std::size_t stride, const std::uint8_t* alive,
                                     std::size_t first, std::size_t last, BestRow& best)
{
  for (std::size_t i = first; i < last; ++i)
  {
    if (alive[i] == 0)
    {
      continue;
    }
    const double value = dotLanes(belief, rows + i * stride);
    if (value > best.value)
    {
      best = {value, i};
    }
  }
}

}  // namespace

std::uint32_t VectorSet::add(std::uint32_t action, const std::vector<double>& values)
{
  std::vector<double> row(values);
  row.resize(stride_, 0.0);
  const PartSums sums = partSums(row.data(), stride_);
  Domination found;
  compareRows(row.data(), sums, values_, sums_, alive_, stride_, found);
  if (found.dominating < alive_.size())
  {
    return numbers_[found.dominating];
  }
  const std::uint32_t number = end();
  for (const std::size_t i : found.dominated)
  {
    alive_[i] = 0;
    replacement_[numbers_[i]] = number;
    --num_alive_;
  }
  const std::size_t num_dead = alive_.size() - num_alive_;
  if (num_dead > kFewDead && num_dead > alive_.size() / kDeadPart)
  {
    compact();
  }
  row_of_.push_back(static_cast<std::uint32_t>(alive_.size()));
  replacement_.push_back(number);
  values_.insert(values_.end(), row.begin(), row.end());
  sums_.push_back(sums);
  actions_.push_back(action);
  numbers_.push_back(number);
  alive_.push_back(1);
  ++num_alive_;
  return number;
}

void VectorSet::compact()
{
  std::size_t to = 0;
  for (std::size_t from = 0; from < alive_.size(); ++from)
  {
    if (alive_[from] == 0)
    {
      continue;
    }
    std::memmove(values_.data() + to * stride_, values_.data() + from * stride_,
                 stride_ * sizeof(double));
    sums_[to] = sums_[from];
    actions_[to] = actions_[from];
    numbers_[to] = numbers_[from];
    row_of_[numbers_[to]] = static_cast<std::uint32_t>(to);
    ++to;
  }
  values_.resize(to * stride_);
  sums_.resize(to);
  actions_.resize(to);
  numbers_.resize(to);
  alive_.assign(to, 1);
}

std::uint32_t VectorSet::living(std::uint32_t i) const
{
  while (replacement_[i] != i)
  {
    i = replacement_[i];
  }
  return i;
}

VectorSet::Best VectorSet::best(const PackedBelief& belief, std::uint32_t first, Best known) const
{
  const std::size_t none = alive_.size();
  const auto first_row = static_cast<std::size_t>(
      std::lower_bound(numbers_.begin(), numbers_.end(), first) - numbers_.begin());
  BestRow best{known.value, none};
  findBest(belief, values_.data(), stride_, alive_.data(), first_row, none, best);
  return best.row == none ? known : Best{best.value, numbers_[best.row]};
}

std::size_t VectorSet::sizeInBytes() const
{
  return sizeof(*this) + values_.capacity() * sizeof(double) + sums_.capacity() * sizeof(PartSums) +
         alive_.capacity() +
         (actions_.capacity() + numbers_.capacity() + row_of_.capacity() +
          replacement_.capacity()) *
             sizeof(std::uint32_t);
}

}  // namespace kr3::pomdp
