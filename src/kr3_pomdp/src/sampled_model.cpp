#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <kr3_common/error.hpp>

#include "class_bounds.hpp"
#include "kr3_pomdp/online_planner.hpp"
#include "kr3_pomdp/simulation.hpp"

namespace kr3::pomdp
{

namespace
{

constexpr int kMaxSweeps = 10000;
constexpr double kTolerance = 1e-6;  // relative to the largest reward

/// The entry at a number in [0, 1), and how far into it the number is: a new one in [0, 1).
struct Place
{
  std::size_t index;
  double rest;
};

Place placeIn(const SparseRow& row, double random)
{
  double before = 0.0;
  const SparseEntry* last = row.begin();
  for (const SparseEntry& entry : row)
  {
    last = &entry;
    if (random < before + entry.probability)
    {
      break;
    }
    before += entry.probability;
  }
  const double rest = (random - before) / last->probability;
  return {last->index, std::clamp(rest, 0.0, 1.0 - 0x1.0p-53)};
}

/// Samples as a belief: how many there are of each state, ascending.
std::vector<SparseEntry> counted(std::vector<std::uint64_t> states)
{
  std::sort(states.begin(), states.end());
  std::vector<SparseEntry> counts;
  for (const std::uint64_t state : states)
  {
    if (counts.empty() || counts.back().index != state)
    {
      counts.push_back({static_cast<std::uint32_t>(state), 0.0});
    }
    counts.back().probability += 1.0;
  }
  return counts;
}

}  // namespace

SampledModel::SampledModel(const Model& model, const Policy* policy)
  : model_(model), policy_(policy), finished_(finishedStates(model))
{
  if (model.discount() >= 1.0)
  {
    throw InvalidArgument("discount 1, expected it below 1");
  }
  if (policy != nullptr && policy->numStates() != model.numStates())
  {
    throw InvalidArgument("a policy over " + std::to_string(policy->numStates()) +
                          " states, expected " + std::to_string(model.numStates()));
  }
  double greatest = -std::numeric_limits<double>::infinity();
  double scale = 1e-12;
  for (std::size_t a = 0; a < model.numActions(); ++a)
  {
    for (std::size_t s = 0; s < model.numStates(); ++s)
    {
      greatest = std::max(greatest, model.reward(a, s));
      scale = std::max(scale, std::abs(model.reward(a, s)));
    }
  }
  // From above, so that every sweep leaves an upper bound.
  values_.assign(model.numStates(), greatest / (1.0 - model.discount()));
  double change = std::numeric_limits<double>::infinity();
  for (int sweep = 0; sweep < kMaxSweeps && change > kTolerance * scale; ++sweep)
  {
    change = 0.0;
    for (std::size_t s = 0; s < values_.size(); ++s)
    {
      double best = finished_[s] ? 0.0 : -std::numeric_limits<double>::infinity();
      for (std::size_t a = 0; a < model.numActions(); ++a)
      {
        best = std::max(best, backedUp(s, a));
      }
      best = std::min(best, values_[s]);
      change = std::max(change, values_[s] - best);
      values_[s] = best;
    }
  }
  for (std::size_t s = 0; s < values_.size(); ++s)
  {
    for (std::size_t a = 0; a < model.numActions(); ++a)
    {
      action_values_.push_back(backedUp(s, a));
    }
  }
  bounds_ = std::make_unique<ClassBounds>(model, policy);
}

SampledModel::~SampledModel() = default;

double SampledModel::backedUp(std::size_t state, std::size_t action) const
{
  double sum = 0.0;
  for (const SparseEntry& next : model_.transitions(action, state))
  {
    sum += next.probability * values_[next.index];
  }
  return model_.reward(action, state) + model_.discount() * sum;
}

GenerativeStep SampledModel::step(std::uint64_t state, std::size_t action, double random) const
{
  const Place next = placeIn(model_.transitions(action, state), random);
  const Place seen = placeIn(model_.observations(action, next.index), next.rest);
  return {next.index, seen.index, model_.reward(action, state), finished_[next.index]};
}

double SampledModel::upperBoundOf(const std::vector<std::uint64_t>& states) const
{
  const double separate = GenerativeModel::upperBoundOf(states);
  const std::optional<ClassBelief> belief = bounds_->located(counted(states));
  std::vector<double> sums;
  return belief ? std::min(separate, bounds_->upperAt(*belief, sums)) : separate;
}

std::optional<KnownPlan> SampledModel::knownPlan(const std::vector<std::uint64_t>& states) const
{
  const std::optional<ClassBelief> belief =
      policy_ != nullptr ? bounds_->located(counted(states)) : std::nullopt;
  if (!belief)
  {
    return std::nullopt;
  }
  std::vector<double> sums;
  const ClassBounds::Lower lower = bounds_->lowerAt(*belief, sums);
  return KnownPlan{lower.action, lower.value};
}

std::size_t SampledModel::defaultAction(const std::vector<std::uint64_t>& states) const
{
  if (policy_ != nullptr)
  {
    std::vector<double> belief(model_.numStates(), 0.0);
    for (const std::uint64_t state : states)
    {
      belief[state] += 1.0 / static_cast<double>(states.size());
    }
    return policy_->actionAt(Belief(std::move(belief)));
  }
  std::vector<double> sums(model_.numActions(), 0.0);
  for (const std::uint64_t state : states)
  {
    for (std::size_t a = 0; a < sums.size(); ++a)
    {
      sums[a] += action_values_[state * sums.size() + a];
    }
  }
  return static_cast<std::size_t>(std::max_element(sums.begin(), sums.end()) - sums.begin());
}

}  // namespace kr3::pomdp
