#include "kr3_pomdp/policy_graph.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <queue>
#include <string>
#include <utility>

#include <kr3_common/error.hpp>

#include "kr3_pomdp/belief.hpp"
#include "kr3_pomdp/policy_format.hpp"
#include "kr3_pomdp/simulation.hpp"

namespace kr3::pomdp
{

namespace
{

std::vector<SparseEntry> sparse(const Belief& belief)
{
  std::vector<SparseEntry> entries;
  for (std::size_t s = 0; s < belief.size(); ++s)
  {
    if (belief[s] > 0.0)
    {
      entries.push_back({static_cast<std::uint32_t>(s), belief[s]});
    }
  }
  return entries;
}

/// The value of a vector at a belief; none where it says nothing of it.
double valueOf(const AlphaVector& vector, const std::vector<SparseEntry>& belief)
{
  double value = 0.0;
  for (const SparseEntry& entry : belief)
  {
    std::size_t place = entry.index;
    if (!vector.states.empty())
    {
      const auto found = std::lower_bound(vector.states.begin(), vector.states.end(), entry.index);
      if (found == vector.states.end() || *found != entry.index)
      {
        return -std::numeric_limits<double>::infinity();
      }
      place = static_cast<std::size_t>(found - vector.states.begin());
    }
    value += entry.probability * vector.values[place];
  }
  return value;
}

/// Builds a PolicyGraph, the likeliest nodes first. Used once.
class Exploration
{
public:
  Exploration(const Model& model, const Policy& policy, const PolicyGraphLimits& limits,
              PolicyGraphNodes kind)
    : model_(model), policy_(policy), limits_(limits), finished_(finishedStates(model))
  {
    if (kind == PolicyGraphNodes::kVectors)
    {
      vectors_ = policy.alphaVectors();
    }
  }

  PolicyGraph run()
  {
    for (const InitialOutcome& outcome : model_.initialOutcomes())
    {
      if (const std::size_t node = nodeOf(outcome.belief, outcome.probability, 0); node != kNoNode)
      {
        graph_.starts.push_back({node, outcome.probability});
      }
    }
    while (!open_.empty())
    {
      const Open next = open_.top();
      open_.pop();
      expand(next.node);
    }
    std::stable_sort(
        graph_.edges.begin(), graph_.edges.end(),
        [](const PolicyGraph::Edge& a, const PolicyGraph::Edge& b) { return a.from < b.from; });
    return std::move(graph_);
  }

private:
  static constexpr std::size_t kNoNode = std::numeric_limits<std::size_t>::max();

  struct Open
  {
    double probability;
    std::size_t node;
    bool operator<(const Open& other) const  // the first node among equally likely ones
    {
      return probability != other.probability ? probability < other.probability : node > other.node;
    }
  };

  /// The node of a belief, a new one if need be; kNoNode when there are too many.
  std::size_t nodeOf(const Belief& belief, double probability, std::size_t depth)
  {
    PolicyGraph::Node node{0, 0.0, probability, depth, sparse(belief), PolicyGraph::End::kNone};
    const std::vector<std::int64_t> key = keyOf(node.belief);
    if (const auto known = numbers_.find(key); known != numbers_.end())
    {
      return known->second;
    }
    const std::size_t number = graph_.nodes.size();
    if (number == limits_.max_nodes)
    {
      return kNoNode;
    }
    const Policy::Choice choice = policy_.bestAt(belief);
    node.action = choice.action;
    node.value = choice.value;
    graph_.nodes.push_back(std::move(node));
    numbers_.emplace(key, number);
    open_.push({probability, number});
    return number;
  }

  [[nodiscard]] std::vector<std::int64_t> keyOf(const std::vector<SparseEntry>& belief) const
  {
    std::vector<std::int64_t> key;
    if (vectors_.empty())
    {
      for (const SparseEntry& entry : belief)
      {
        key.push_back(entry.index);
        key.push_back(std::llround(entry.probability * 1e9));
      }
      return key;
    }
    std::size_t best = 0;
    double best_value = -std::numeric_limits<double>::infinity();
    for (std::size_t v = 0; v < vectors_.size(); ++v)
    {
      const double value = valueOf(vectors_[v], belief);
      if (value > best_value)
      {
        best = v;
        best_value = value;
      }
    }
    return {static_cast<std::int64_t>(best)};
  }

  void expand(std::size_t number)
  {
    const PolicyGraph::Node node = graph_.nodes[number];  // a copy: the list grows
    if (std::all_of(node.belief.begin(), node.belief.end(),
                    [this](const SparseEntry& entry) { return finished_[entry.index]; }))
    {
      graph_.nodes[number].end = PolicyGraph::End::kFinished;
      return;
    }
    if (node.depth == limits_.max_depth)
    {
      graph_.nodes[number].end = PolicyGraph::End::kLimit;
      return;
    }
    std::vector<double> probabilities(model_.numStates(), 0.0);
    for (const SparseEntry& entry : node.belief)
    {
      probabilities[entry.index] = entry.probability;
    }
    const Belief belief(std::move(probabilities));
    const std::vector<double> seen = observationProbabilities(model_, belief, node.action);
    bool followed = false;
    for (std::size_t o = 0; o < seen.size(); ++o)
    {
      const double reached = node.probability * seen[o];
      if (seen[o] > 0.0 && reached >= limits_.min_probability)
      {
        const Belief next = updated(model_, belief, node.action, o).posterior;
        const std::size_t to = nodeOf(next, reached, node.depth + 1);
        if (to != kNoNode)
        {
          graph_.edges.push_back({number, to, o, seen[o]});
          followed = true;
        }
      }
    }
    if (!followed)
    {
      graph_.nodes[number].end = PolicyGraph::End::kLimit;
    }
  }

  const Model& model_;
  const Policy& policy_;
  PolicyGraphLimits limits_;
  std::vector<bool> finished_;
  std::vector<AlphaVector> vectors_;  // empty: nodes are beliefs
  std::map<std::vector<std::int64_t>, std::size_t> numbers_;
  std::priority_queue<Open> open_;
  PolicyGraph graph_;
};

}  // namespace

PolicyGraph policyGraph(const Model& model, const Policy& policy, const PolicyGraphLimits& limits,
                        PolicyGraphNodes nodes)
{
  checkFits(policy, model);
  if (limits.max_nodes == 0 || !(limits.min_probability >= 0.0 && limits.min_probability <= 1.0))
  {
    throw InvalidArgument("a graph of up to " + std::to_string(limits.max_nodes) +
                          " nodes with probabilities of at least " +
                          std::to_string(limits.min_probability) +
                          ", expected a node and a probability in [0, 1]");
  }
  return Exploration(model, policy, limits, nodes).run();
}

}  // namespace kr3::pomdp
