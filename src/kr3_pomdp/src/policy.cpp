#include "kr3_pomdp/policy.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include <kr3_common/error.hpp>

#include "weighted_sums.hpp"

namespace kr3::pomdp
{

namespace
{

constexpr std::size_t kBlock = 8;  // rows of values that are filled together

void check(std::size_t num_states, const AlphaVector& vector, std::size_t number)
{
  const auto fail = [number](const std::string& what) {
    throw InvalidArgument("alpha vector " + std::to_string(number) + ": " + what);
  };
  const std::size_t expected = vector.states.empty() ? num_states : vector.states.size();
  if (vector.values.size() != expected)
  {
    fail(std::to_string(vector.values.size()) + " values, expected " + std::to_string(expected));
  }
  for (std::size_t i = 0; i < vector.states.size(); ++i)
  {
    if (vector.states[i] >= num_states || (i > 0 && vector.states[i] <= vector.states[i - 1]))
    {
      fail("state " + std::to_string(vector.states[i]) + " is out of order or range");
    }
  }
  if (!std::all_of(vector.values.begin(), vector.values.end(),
                   [](double v) { return std::isfinite(v); }))
  {
    fail("a value is not finite");
  }
}

}  // namespace

Policy::Policy(std::size_t num_states, const std::vector<AlphaVector>& alpha_vectors)
  : num_states_(num_states), num_alpha_vectors_(alpha_vectors.size())
{
  std::map<std::vector<std::uint32_t>, std::vector<const AlphaVector*>> by_states;
  for (std::size_t i = 0; i < alpha_vectors.size(); ++i)
  {
    check(num_states, alpha_vectors[i], i);
    by_states[alpha_vectors[i].states].push_back(&alpha_vectors[i]);
    max_action_ = std::max(max_action_, alpha_vectors[i].action);
  }
  if (by_states.empty() || !by_states.begin()->first.empty())
  {
    throw InvalidArgument("a policy needs a vector over all states");
  }
  for (const auto& [states, vectors] : by_states)
  {
    Group group;
    group.states = states;
    if (states.empty())
    {
      group.states.resize(num_states);
      std::iota(group.states.begin(), group.states.end(), 0U);
    }
    group.values.resize(group.states.size() * vectors.size());
    for (std::size_t v = 0; v < vectors.size(); ++v)
    {
      group.actions.push_back(static_cast<std::uint32_t>(vectors[v]->action));
    }
    for (std::size_t block = 0; block < group.states.size(); block += kBlock)  // stay in the cache
    {
      const std::size_t end = std::min(block + kBlock, group.states.size());
      for (std::size_t v = 0; v < vectors.size(); ++v)
      {
        for (std::size_t s = block; s < end; ++s)
        {
          group.values[s * vectors.size() + v] = vectors[v]->values[s];
        }
      }
    }
    groups_.push_back(std::move(group));
  }
  indexGroups();
}

void Policy::indexGroups()
{
  first_group_.assign(num_states_ + 1, 0);
  for (const Group& group : groups_)
  {
    for (const std::uint32_t state : group.states)
    {
      ++first_group_[state + 1];
    }
  }
  std::partial_sum(first_group_.begin(), first_group_.end(), first_group_.begin());
  groups_of_state_.resize(first_group_.back());
  std::vector<std::size_t> next(first_group_.begin(), first_group_.end() - 1);
  for (std::size_t g = 0; g < groups_.size(); ++g)
  {
    for (const std::uint32_t state : groups_[g].states)
    {
      groups_of_state_[next[state]++] = static_cast<std::uint32_t>(g);
    }
  }
}

std::vector<AlphaVector> Policy::alphaVectors() const
{
  std::vector<AlphaVector> vectors;
  vectors.reserve(num_alpha_vectors_);
  for (const Group& group : groups_)
  {
    for (std::size_t v = 0; v < group.actions.size(); ++v)
    {
      AlphaVector vector;
      vector.action = group.actions[v];
      if (group.states.size() != num_states_)
      {
        vector.states = group.states;
      }
      for (std::size_t s = 0; s < group.states.size(); ++s)
      {
        vector.values.push_back(group.values[s * group.actions.size() + v]);
      }
      vectors.push_back(std::move(vector));
    }
  }
  return vectors;
}

std::size_t Policy::sizeInBytes() const
{
  std::size_t bytes = sizeof(Policy) + first_group_.size() * sizeof(std::size_t) +
                      groups_of_state_.size() * sizeof(std::uint32_t);
  for (const Group& group : groups_)
  {
    bytes += sizeof(Group) + group.values.size() * sizeof(double) +
             (group.states.size() + group.actions.size()) * sizeof(std::uint32_t);
  }
  return bytes;
}

Policy::Choice Policy::bestAt(const Belief& belief) const
{
  if (belief.size() != num_states_)
  {
    throw InvalidArgument("belief over " + std::to_string(belief.size()) + " states, expected " +
                          std::to_string(num_states_));
  }
  std::vector<std::uint32_t> support;
  std::vector<double> weights;
  for (std::size_t s = 0; s < num_states_; ++s)
  {
    if (belief[s] > 0.0)
    {
      support.push_back(static_cast<std::uint32_t>(s));
      weights.push_back(belief[s]);
    }
  }
  Choice best{0, -std::numeric_limits<double>::infinity()};
  std::vector<double> sums;
  std::vector<std::size_t> places;
  const std::size_t last = first_group_[support.front() + 1];
  for (std::size_t i = first_group_[support.front()]; i < last; ++i)
  {
    const Group& group = groups_[groups_of_state_[i]];
    places.clear();
    if (group.states.size() == num_states_)
    {
      places.assign(support.begin(), support.end());
    }
    for (std::size_t j = places.size(); j < support.size(); ++j)
    {
      const std::uint32_t s = support[j];
      const auto found = std::lower_bound(group.states.begin(), group.states.end(), s);
      if (found == group.states.end() || *found != s)
      {
        break;
      }
      places.push_back(static_cast<std::size_t>(found - group.states.begin()));
    }
    if (places.size() != support.size())
    {
      continue;
    }
    sums.resize(group.actions.size());
    sumWeightedRows(group.values.data(), places, weights, sums);
    const auto top = std::max_element(sums.begin(), sums.end());
    if (*top > best.value)
    {
      best = {group.actions[static_cast<std::size_t>(top - sums.begin())], *top};
    }
  }
  return best;
}

}  // namespace kr3::pomdp
