#include "coupling_graph.hpp"

#include <algorithm>
#include <optional>

#include <kr3_common/error.hpp>

#include "state_view.hpp"

namespace kr3::refinement
{
namespace
{

/// The fine fluents of coarse ones.
std::set<std::string> fineNames(const LowLevelDomain& domain,
                                const std::set<std::string>& constants,
                                const std::set<std::string>& coarse)
{
  std::set<std::string> result;
  if (coarse.empty())
  {
    return result;
  }
  const Semantics semantics(domain.description(), &constants);
  for (const auto& [name, fluents] : coarseFluents(domain, semantics))
  {
    for (const std::size_t fluent : fluents)
    {
      if (coarse.count(name) > 0)
      {
        result.insert(semantics.fluents()[fluent].name);
      }
    }
  }
  return result;
}

}  // namespace

CouplingGraph::CouplingGraph(const LowLevelDomain& domain, const std::set<std::string>& constants,
                             const std::set<std::string>& hidden, std::size_t max_states)
  : constants_(constants)
  , semantics_(domain.description(), &constants_, fineNames(domain, constants, hidden), kElsewhere)
  , states_(semantics_.states(max_states))
{
  CoarseFluents fluents;
  for (const auto& [name, fine] : refinement::coarseFluents(domain, semantics_))
  {
    const std::string& symbol =
        semantics_.signature().symbols()[semantics_.fluents()[fine.front()].symbol].name;
    if (domain.highLevel().findFluent(symbol) != nullptr)  // not one of the low level's own
    {
      names_.push_back(name);
      fluents.emplace(name, fine);
    }
  }
  for (std::uint32_t i = 0; i < states_.size(); ++i)
  {
    views_.push_back(coarse(domain, fluents, states_[i]));
    by_view_[views_.back()].push_back(i);
  }
  addTransitions();
}

CoarseState CouplingGraph::coarse(const LowLevelDomain& domain, const CoarseFluents& fluents,
                                  const Values& state) const
{
  CoarseState result;
  for (const auto& [name, fine] : fluents)
  {
    std::vector<std::string> values;
    for (const std::size_t fluent : fine)
    {
      values.push_back(domain.coarse(semantics_.vocabulary().name(state[fluent])));
    }
    const Symbol& symbol =
        semantics_.signature().symbols()[semantics_.fluents()[fine.front()].symbol];
    result[name] = coarseValue(values, symbol.boolean);
  }
  return result;
}

void CouplingGraph::addTransitions()
{
  std::map<Values, std::uint32_t> index;
  for (std::uint32_t i = 0; i < states_.size(); ++i)
  {
    index.emplace(states_[i], i);
  }
  successors_.resize(states_.size());
  predecessors_.resize(states_.size());
  for (const GroundAction& action : semantics_.actions())
  {
    std::set<std::string>& changed = changes_[action.symbol];
    for (std::uint32_t i = 0; i < states_.size(); ++i)
    {
      if (semantics_.forbidden(states_[i], action))
      {
        continue;
      }
      for (const Result& result : semantics_.results(states_[i], action))
      {
        if (result.outside)
        {
          continue;
        }
        const auto next = index.find(result.values);
        if (next == index.end())
        {
          throw InternalError("a successor is no state of the zoomed description");
        }
        successors_[i].push_back(next->second);
        predecessors_[next->second].push_back(i);
        for (std::size_t f = 0; f < semantics_.signature().numInertial(); ++f)
        {
          if (states_[i][f] != result.values[f])
          {
            changed.insert(semantics_.signature().symbols()[semantics_.fluents()[f].symbol].name);
          }
        }
      }
    }
  }
}

CouplingGraph::Paths CouplingGraph::paths(const CoarseState& start, const CoarseState& goal,
                                          bool direct) const
{
  std::vector<bool> leads(states_.size(), false);
  std::vector<std::uint32_t> open;
  if (const auto goals = by_view_.find(goal); goals != by_view_.end())
  {
    open = goals->second;
  }
  for (const std::uint32_t state : open)
  {
    leads[state] = true;
  }
  while (!open.empty())
  {
    const std::uint32_t state = open.back();
    open.pop_back();
    for (const std::uint32_t before : predecessors_[state])
    {
      const bool allowed = !direct || views_[before] == start || views_[before] == goal;
      if (allowed && !leads[before])
      {
        leads[before] = true;
        open.push_back(before);
      }
    }
  }
  Paths result;
  if (const auto starts = by_view_.find(start); starts != by_view_.end())
  {
    result.num_compatible = starts->second.size();
    std::copy_if(starts->second.begin(), starts->second.end(), std::back_inserter(result.failing),
                 [&](std::uint32_t state) { return !leads[state]; });
  }
  return result;
}

std::vector<CoarseState> CouplingGraph::reachable(std::uint32_t state) const
{
  std::vector<CoarseState> result;
  std::vector<bool> seen(states_.size(), false);
  std::vector<std::uint32_t> open{state};
  seen[state] = true;
  for (std::size_t i = 0; i < open.size(); ++i)
  {
    if (std::find(result.begin(), result.end(), views_[open[i]]) == result.end())
    {
      result.push_back(views_[open[i]]);
    }
    for (const std::uint32_t next : successors_[open[i]])
    {
      if (!seen[next])
      {
        seen[next] = true;
        open.push_back(next);
      }
    }
  }
  return result;
}

std::vector<std::string> CouplingGraph::literals(std::uint32_t state) const
{
  std::vector<std::string> result;
  for (std::size_t f = 0; f < semantics_.signature().numInertial(); ++f)
  {
    result.push_back(reasoner::toString(literalOf(semantics_, f, states_[state][f])));
  }
  return result;
}

}  // namespace kr3::refinement
