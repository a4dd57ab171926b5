#include "kr3_refinement/pomdp_task.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include <kr3_common/error.hpp>

#include "prior.hpp"
#include "state_view.hpp"

namespace kr3::refinement
{
namespace
{

double massOf(const pomdp::Belief& belief, const std::vector<bool>& states)
{
  if (belief.size() != states.size())
  {
    throw InvalidArgument("a belief over " + std::to_string(belief.size()) + " states, expected " +
                          std::to_string(states.size()));
  }
  double mass = 0.0;
  for (std::size_t i = 0; i < states.size(); ++i)
  {
    mass += states[i] ? belief[i] : 0.0;
  }
  return mass;
}

}  // namespace

PomdpTask::StateKind PomdpTask::kind(std::size_t state) const
{
  if (state >= model_.numStates())
  {
    throw InvalidArgument("state " + std::to_string(state) + " of " +
                          std::to_string(model_.numStates()));
  }
  return state < states_.size()
             ? StateKind::kPhysical
             : (state == boundaryState() ? StateKind::kBoundary : StateKind::kDone);
}

const reasoner::State& PomdpTask::physicalState(std::size_t state) const
{
  if (kind(state) != StateKind::kPhysical)
  {
    throw InvalidArgument("state '" + model_.stateName(state) + "' is no physical state");
  }
  return states_[state];
}

bool PomdpTask::isExecutable(std::size_t action, std::size_t state) const
{
  if (kind(state) != StateKind::kPhysical)
  {
    return action == finishAction() && kind(state) == StateKind::kBoundary;
  }
  return executable_.at(action)[state];
}

double PomdpTask::successProbability(const pomdp::Belief& belief) const
{
  return massOf(belief, success_);
}

double PomdpTask::hopelessProbability(const pomdp::Belief& belief) const
{
  return massOf(belief, hopeless_);
}

Distribution PomdpTask::marginal(const pomdp::Belief& belief,
                                 const std::vector<std::size_t>& fluents, bool coarse) const
{
  if (belief.size() != model_.numStates())
  {
    throw InvalidArgument("a belief over " + std::to_string(belief.size()) + " states, expected " +
                          std::to_string(model_.numStates()));
  }
  const double total = 1.0 - belief[doneState()];
  if (total <= 1e-9)
  {
    throw FailedPrecondition("the task has finished: its belief says nothing about fluents");
  }
  const bool boolean =
      fluents_[fluents.front()].values == std::vector<std::string>{"false", "true"};
  Distribution result;
  for (const std::size_t fluent : fluents)
  {
    for (const std::string& value : fluents_[fluent].values)
    {
      const auto whole = coarse_of_.find(value);
      result.emplace(coarse && whole != coarse_of_.end() ? whole->second : value, 0.0);
    }
  }
  for (std::size_t state = 0; state < states_.size(); ++state)
  {
    if (belief[state] <= 0.0)
    {
      continue;
    }
    std::vector<std::string> values;
    for (const std::size_t fluent : fluents)
    {
      const std::string& value =
          fluents_[fluent].values[static_cast<std::size_t>(states_[state][fluent])];
      const auto whole = coarse_of_.find(value);
      values.push_back(coarse && whole != coarse_of_.end() ? whole->second : value);
    }
    result[coarseValue(values, boolean)] += belief[state] / total;
  }
  if (belief[boundaryState()] > 0.0)
  {
    result[kOutside] = belief[boundaryState()] / total;
  }
  return result;
}

Distribution PomdpTask::fineMarginal(const pomdp::Belief& belief, const std::string& fluent) const
{
  const std::string name = normalised(fluent);
  const auto found =
      std::find_if(fluents_.begin(), fluents_.end(),
                   [&](const reasoner::GroundFluent& candidate) { return candidate.name == name; });
  if (found == fluents_.end())
  {
    throw NotFound("the zoom of " + zoom_.action + " has no low-level fluent '" + name + "'");
  }
  return marginal(belief, {static_cast<std::size_t>(found - fluents_.begin())}, false);
}

Distribution PomdpTask::coarseMarginal(const pomdp::Belief& belief, const std::string& fluent) const
{
  const auto found = coarse_fluents_.find(normalised(fluent));
  if (found == coarse_fluents_.end())
  {
    throw NotFound("the zoom of " + zoom_.action + " has no fluent '" + normalised(fluent) + "'");
  }
  return marginal(belief, found->second, true);
}

std::vector<std::string> PomdpTask::coarseFluents() const
{
  std::vector<std::string> result;
  for (const auto& [name, fluents] : coarse_fluents_)
  {
    result.push_back(name);
  }
  return result;
}

std::string PomdpTask::summary(const pomdp::Belief& belief) const
{
  std::string result;
  if (belief.size() == model_.numStates() && belief[doneState()] > 1.0 - 1e-9)
  {
    return "finished";
  }
  for (const reasoner::GroundFluent& fluent : fluents_)
  {
    using Entry = std::pair<std::string, double>;
    const Distribution distribution = fineMarginal(belief, fluent.name);
    std::vector<Entry> entries(distribution.begin(), distribution.end());
    std::stable_sort(entries.begin(), entries.end(),
                     [](const Entry& a, const Entry& b) { return a.second > b.second; });
    result += (result.empty() ? "" : "; ") + fluent.name;
    if (entries.front().second > 1.0 - 1e-6)
    {
      result += " = " + entries.front().first;
      continue;
    }
    const char* separator = ": ";
    for (const auto& [value, probability] : entries)
    {
      if (probability >= 0.005)
      {
        char number[16];
        std::snprintf(number, sizeof(number), " %.2f", probability);
        result += separator + value + number;
        separator = ", ";
      }
    }
  }
  return result;
}

}  // namespace kr3::refinement
