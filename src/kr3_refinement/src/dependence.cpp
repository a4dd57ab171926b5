#include "dependence.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>

namespace kr3::refinement
{
namespace
{

constexpr double kResolution = 1e12;

}  // namespace

void Dependence::add(const Context& context, const Outcome& outcome)
{
  std::vector<double> rounded;
  rounded.reserve(outcome.size());
  for (const double entry : outcome)
  {
    rounded.push_back(std::nearbyint(entry * kResolution));
  }
  const auto [entry, is_new] = outcome_numbers_.try_emplace(
      std::move(rounded), static_cast<std::uint32_t>(outcomes_.size()));
  if (is_new)
  {
    outcomes_.push_back(outcome);
  }
  contexts_.insert(contexts_.end(), context.begin(), context.end());
  outcome_of_.push_back(entry->second);
}

std::vector<std::uint32_t> Dependence::grouped(const std::vector<std::size_t>& rows,
                                               const std::vector<std::size_t>& columns) const
{
  std::vector<std::uint32_t> group(rows.size(), 0);
  std::unordered_map<std::uint64_t, std::uint32_t> numbers;
  for (const std::size_t column : columns)
  {
    numbers.clear();
    for (std::size_t i = 0; i < rows.size(); ++i)
    {
      const std::uint64_t key =
          std::uint64_t{group[i]} << 32U | contexts_[rows[i] * width_ + column];
      group[i] = numbers.try_emplace(key, static_cast<std::uint32_t>(numbers.size())).first->second;
    }
  }
  return group;
}

bool Dependence::determined(const std::vector<std::size_t>& rows,
                            const std::vector<std::size_t>& columns) const
{
  const std::vector<std::uint32_t> group = grouped(rows, columns);
  std::vector<std::int64_t> outcome(rows.size(), -1);  // of each group
  for (std::size_t i = 0; i < rows.size(); ++i)
  {
    std::int64_t& known = outcome[group[i]];
    if (known >= 0 && known != outcome_of_[rows[i]])
    {
      return false;
    }
    known = outcome_of_[rows[i]];
  }
  return true;
}

std::vector<std::size_t> Dependence::firstOfEach(const std::vector<std::size_t>& rows,
                                                 const std::vector<std::size_t>& columns) const
{
  const std::vector<std::uint32_t> group = grouped(rows, columns);
  std::vector<bool> seen(rows.size(), false);
  std::vector<std::size_t> first;
  for (std::size_t i = 0; i < rows.size(); ++i)
  {
    if (!seen[group[i]])
    {
      seen[group[i]] = true;
      first.push_back(rows[i]);
    }
  }
  return first;
}

std::vector<std::size_t> Dependence::representatives(const std::vector<std::size_t>& columns) const
{
  std::vector<std::size_t> rows(outcome_of_.size());
  std::iota(rows.begin(), rows.end(), 0U);
  return firstOfEach(rows, columns);
}

std::vector<std::size_t> Dependence::columns(const std::vector<std::size_t>& order) const
{
  std::vector<std::size_t> kept(width_);
  std::iota(kept.begin(), kept.end(), 0U);
  std::vector<std::size_t> rows = representatives(kept);
  for (const std::size_t column : order)
  {
    std::vector<std::size_t> fewer = kept;
    fewer.erase(std::remove(fewer.begin(), fewer.end(), column), fewer.end());
    if (determined(rows, fewer))
    {
      kept = std::move(fewer);
      rows = firstOfEach(rows, kept);
    }
  }
  return kept;
}

}  // namespace kr3::refinement
