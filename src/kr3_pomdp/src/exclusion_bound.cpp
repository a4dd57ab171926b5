#include "exclusion_bound.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kr3::pomdp
{

namespace
{

constexpr int kMaxSweeps = 200;
constexpr std::uint32_t kSetsAtOnce = 64;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::size_t lowest(std::uint32_t set)
{
  return static_cast<std::size_t>(__builtin_ctz(set));
}

}  // namespace

void ExclusionBound::advance()
{
  for (std::uint32_t i = 0; i < kSetsAtOnce && next_set_ < num_sets_; ++i)
  {
    solveSet(next_set_++);
  }
}

std::size_t ExclusionBound::sizeInBytes() const
{
  return classes_.size() * num_sets_ * sizeof(double);
}

double ExclusionBound::immediate(const SearchAction& action, Set set, double prior) const
{
  if (!std::isnan(action.common))
  {
    return action.common * prior;
  }
  double sum = 0.0;
  for (; set != 0; set &= set - 1)
  {
    sum += action.rewards[lowest(set)];
  }
  return sum;
}

/// Optima of one set in all classes: what rules something out looks at smaller sets, which are
/// solved; the rest is iterated, from above.
void ExclusionBound::solveSet(Set set)
{
  openSet(set);
  for (int i = 0; i < kMaxSweeps && sweep(set) > tolerance_; ++i)
  {
  }
}

/// Prepares the sweeps over a set.
void ExclusionBound::openSet(Set set)
{
  at_set_.resize(futures_.size());
  for (std::size_t i = 0; i < futures_.size(); ++i)
  {
    Future& future = at_set_[i];
    future.known = 0.0;
    future.same_set.clear();
    for (const Outcome& outcome : futures_[i])
    {
      const Set kept = set & outcome.kept;
      if (kept == set)
      {
        future.same_set.emplace_back(outcome.target, outcome.weight);
      }
      else
      {
        future.known += outcome.weight * classes_[outcome.target].optima[kept];
      }
    }
    future.value = future.known;
  }
  double prior = 0.0;
  for (Set rest = set; rest != 0; rest &= rest - 1)
  {
    prior += prior_[lowest(rest)];
  }
  immediate_.clear();
  for (SearchClass& from : classes_)
  {
    double start = kInfinity;
    for (Set rest = set; rest != 0; rest &= rest - 1)
    {
      const std::size_t value = lowest(rest);
      start = std::min(start, from.corners[value] + from.optima[set ^ (Set{1} << value)]);
    }
    from.optima[set] = start;
    for (const SearchAction& action : from.actions)
    {
      immediate_.push_back(immediate(action, set, prior));
    }
  }
}

/// @return the greatest change
double ExclusionBound::sweep(Set set)
{
  for (Future& future : at_set_)
  {
    if (!future.same_set.empty())
    {
      future.value = future.known;
      for (const auto& [target, weight] : future.same_set)
      {
        future.value += weight * classes_[target].optima[set];
      }
    }
  }
  double change = 0.0;
  std::size_t i = 0;
  for (SearchClass& from : classes_)
  {
    double best = -kInfinity;
    for (const SearchAction& action : from.actions)
    {
      best = std::max(best, immediate_[i++] + at_set_[action.future].value);
    }
    double& optimum = from.optima[set];
    if ((set & ~from.possible) == 0 && best < optimum)
    {
      change = std::max(change, optimum - best);
      optimum = best;
    }
  }
  return change;
}

double ExclusionBound::upper(std::uint32_t state_class, const double* belief)
{
  const View& view = views_[state_class];
  double sum = 0.0;
  for (const Member& member : view.ended)
  {
    sum += belief[member.state] * member.corner;
  }
  layers_.clear();
  for (const Held& held : view.held)
  {
    double ratio = kInfinity;
    for (const Member& member : held.members)
    {
      ratio = std::min(ratio, belief[member.state] / member.prior);
    }
    for (const Member& member : held.members)
    {
      sum += (belief[member.state] - ratio * member.prior) * member.corner;
    }
    if (ratio > 0.0)
    {
      layers_.push_back({ratio, held.search_class, held.value});
    }
  }
  std::sort(layers_.begin(), layers_.end(), [](const Layer& a, const Layer& b) {
    return a.search_class != b.search_class ? a.search_class < b.search_class : a.ratio > b.ratio;
  });
  Set set = 0;
  for (std::size_t i = 0; i < layers_.size(); ++i)
  {
    const Layer& layer = layers_[i];
    set |= Set{1} << layer.value;
    const bool last = i + 1 == layers_.size() || layers_[i + 1].search_class != layer.search_class;
    const double next = last ? 0.0 : layers_[i + 1].ratio;
    sum += (layer.ratio - next) * classes_[layer.search_class].optima[set];
    set = last ? 0 : set;
  }
  return sum;
}

}  // namespace kr3::pomdp
