#include "class_bounds.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "informed_bound.hpp"

namespace kr3::pomdp
{

namespace
{

constexpr std::uint32_t kNoClass = std::numeric_limits<std::uint32_t>::max();

}  // namespace

ClassBounds::ClassBounds(const Model& model, const Policy* policy)
  : observed_(model), class_of_(model.numStates(), kNoClass)
{
  const auto goOn = [] { return true; };
  const InformedVectors informed = informedBound(observed_, goOn);
  const InformedVectors blind = policy == nullptr ? blindBound(observed_, goOn) : InformedVectors();
  const std::vector<AlphaVector> alpha_vectors =
      policy == nullptr ? std::vector<AlphaVector>() : policy->alphaVectors();
  std::vector<std::uint32_t> actions(model.numActions());
  std::iota(actions.begin(), actions.end(), 0U);
  for (std::uint32_t c = 0; c < classes().size(); ++c)
  {
    const StateClass& state_class = classes()[c];
    upper_.push_back(byState(informed[c], actions, state_class.states.size()));
    lower_.push_back(policy == nullptr ? byState(blind[c], actions, state_class.states.size())
                                       : ofPolicy(alpha_vectors, state_class.states));
    for (const std::uint32_t s : state_class.states)
    {
      class_of_[s] = state_class.start_only ? class_of_[s] : c;
    }
  }
}

ClassBounds::Vectors ClassBounds::byState(const std::vector<std::vector<double>>& vectors,
                                          std::vector<std::uint32_t> actions,
                                          std::size_t num_states)
{
  Vectors result{std::move(actions), std::vector<double>(num_states * vectors.size())};
  for (std::size_t v = 0; v < vectors.size(); ++v)
  {
    for (std::size_t s = 0; s < num_states; ++s)
    {
      result.values[s * vectors.size() + v] = vectors[v][s];
    }
  }
  return result;
}

/// Those that cover the class, in its local indices.
ClassBounds::Vectors ClassBounds::ofPolicy(const std::vector<AlphaVector>& alpha_vectors,
                                           const std::vector<std::uint32_t>& states)
{
  std::vector<std::vector<double>> vectors;
  std::vector<std::uint32_t> actions;
  for (const AlphaVector& alpha : alpha_vectors)
  {
    std::vector<double> vector;
    if (alpha.states.empty())
    {
      for (const std::uint32_t s : states)
      {
        vector.push_back(alpha.values[s]);
      }
    }
    else if (std::includes(alpha.states.begin(), alpha.states.end(), states.begin(), states.end()))
    {
      auto at = alpha.states.begin();
      for (const std::uint32_t s : states)
      {
        at = std::lower_bound(at, alpha.states.end(), s);
        vector.push_back(alpha.values[static_cast<std::size_t>(at - alpha.states.begin())]);
      }
    }
    else
    {
      continue;
    }
    vectors.push_back(std::move(vector));
    actions.push_back(static_cast<std::uint32_t>(alpha.action));
  }
  return byState(vectors, std::move(actions), states.size());
}

ClassBounds::Lower ClassBounds::greatestAt(const Vectors& vectors, const ClassBelief& belief,
                                           std::vector<double>& sums)
{
  const std::size_t count = vectors.actions.size();
  sums.assign(count, 0.0);
  for (const SparseEntry& entry : belief.entries)
  {
    const double* row = vectors.values.data() + entry.index * count;
    for (std::size_t v = 0; v < count; ++v)
    {
      sums[v] += entry.probability * row[v];
    }
  }
  const auto greatest = std::max_element(sums.begin(), sums.end());
  return {vectors.actions[static_cast<std::size_t>(greatest - sums.begin())], *greatest};
}

ClassBounds::Lower ClassBounds::lowerAt(const ClassBelief& belief, std::vector<double>& sums) const
{
  return greatestAt(lower_[belief.state_class], belief, sums);
}

double ClassBounds::upperAt(const ClassBelief& belief, std::vector<double>& sums) const
{
  return greatestAt(upper_[belief.state_class], belief, sums).value;
}

std::optional<ClassBelief> ClassBounds::within(std::uint32_t c,
                                               const std::vector<SparseEntry>& belief) const
{
  const std::vector<std::uint32_t>& states = classes()[c].states;
  ClassBelief local{c, {}};
  auto at = states.begin();
  for (const SparseEntry& entry : belief)
  {
    at = std::lower_bound(at, states.end(), entry.index);
    if (at == states.end() || *at != entry.index)
    {
      return std::nullopt;
    }
    local.entries.push_back({static_cast<std::uint32_t>(at - states.begin()), entry.probability});
  }
  return local;
}

std::optional<ClassBelief> ClassBounds::located(const std::vector<SparseEntry>& belief) const
{
  const std::uint32_t usual = class_of_[belief.front().index];
  if (usual != kNoClass)
  {
    if (std::optional<ClassBelief> local = within(usual, belief))
    {
      return local;
    }
  }
  for (std::uint32_t c = 0; c < classes().size(); ++c)
  {
    if (classes()[c].start_only)
    {
      if (std::optional<ClassBelief> local = within(c, belief))
      {
        return local;
      }
    }
  }
  return std::nullopt;
}

}  // namespace kr3::pomdp
