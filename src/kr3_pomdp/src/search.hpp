#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "belief_graph.hpp"
#include "solver_parts.hpp"
#include "supervisor.hpp"

namespace kr3::pomdp
{

/// Brings the bounds at the start of a belief graph together: walks from there, then backs up along
/// the way in reverse.
///
/// Two kinds of walks alternate. One follows the upper bound to where the gap comes from; one
/// samples what happens under the policy found so far, which improves the lower bound where it is
/// used, also where upper bounds stay far off. Not thread-safe.
class Search
{
public:
  /// The graph and the supervisor outlive this object.
  /// @param precision  gap at the start that is small enough
  Search(BeliefGraph& graph, double precision, const SolverParts& parts, Supervisor& supervisor);

  /// Until the supervisor says stop.
  void run();

  /// Bounds of the value before anything is seen.
  double lower();
  double upper();

private:
  bool mayGoOn();
  bool isSourceDue() const;
  template <typename ValueOf>
  double expected(const ValueOf& value_of);
  NodeId widestRoot();
  NodeId sampledRoot();
  void upperTrial();
  void sampledTrial();
  std::size_t anyUseful(NodeId node);
  NodeId sampledChild(NodeId node, std::size_t action);
  void backUpPath(BeliefGraph::Width width);
  double uniform();

  BeliefGraph* graph_;
  double precision_;
  double sampled_share_;  // of the trials
  Supervisor* supervisor_;
  std::vector<NodeId> path_;
  std::uint64_t source_work_ = 0;  // pieces
  std::mt19937_64 random_{1};      // fixed, so that a run repeats
};

}  // namespace kr3::pomdp
