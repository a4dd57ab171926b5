#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <vector>

#include "kr3_pomdp/model.hpp"
#include "kr3_pomdp/policy.hpp"

namespace kr3::pomdp
{

/// What is one node of a policy graph.
enum class PolicyGraphNodes : std::uint8_t
{
  kBeliefs,  ///< a belief; equal ones (to 1e-9 in each state) are one node. Exact
  kVectors,  ///< an alpha vector: all beliefs where it is the greatest. Smaller; what follows is
             ///< shown as it follows at the belief that was met first
};

struct PolicyGraphLimits
{
  std::size_t max_nodes = 200;    ///< at least 1; the likeliest come first
  std::size_t max_depth = 50;     ///< actions from the start
  double min_probability = 1e-3;  ///< of coming to a branch from the start, in [0, 1]
};

/// What a policy does, from the model's initial outcomes on: nodes with an action, an edge for each
/// observation that may follow.
struct PolicyGraph
{
  enum class End : std::uint8_t
  {
    kNone,      ///< edges follow, though some may have been too unlikely
    kFinished,  ///< nothing more can be earned or changed
    kLimit,     ///< a limit kept what follows out
  };

  struct Node
  {
    std::size_t action;
    double value;                     ///< Policy::valueAt
    double probability;               ///< of coming here from the start the way found first
    std::size_t depth;                ///< actions from the start, by that way
    std::vector<SparseEntry> belief;  ///< of that way
    End end = End::kNone;
  };
  struct Edge
  {
    std::size_t from;
    std::size_t to;
    std::size_t observation;
    double probability;  ///< of the observation, given the first belief of `from`
  };
  struct Start
  {
    std::size_t node;
    double probability;
  };

  std::vector<Node> nodes;
  std::vector<Edge> edges;    ///< by `from`, then by observation
  std::vector<Start> starts;  ///< by Model::initialOutcomes
};

/// Follows a policy through all observations.
///
/// @throws InvalidArgument  a policy for another model, a limit out of range
[[nodiscard]] PolicyGraph policyGraph(const Model& model, const Policy& policy,
                                      const PolicyGraphLimits& limits,
                                      PolicyGraphNodes nodes = PolicyGraphNodes::kBeliefs);

/// Writes a graph in the DOT language of Graphviz. A node says its action, its value and its
/// likeliest states; edges between the same nodes are one, with all their observations. A double
/// line is a finished node, a dashed one stands where a limit ended the graph.
void writeDot(std::ostream& out, const PolicyGraph& graph, const Model& model);

}  // namespace kr3::pomdp
