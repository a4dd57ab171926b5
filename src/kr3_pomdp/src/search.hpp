#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "belief_graph.hpp"
#include "belief_grid.hpp"
#include "supervisor.hpp"
#include "work_split.hpp"

namespace kr3::pomdp
{

/// How one search differs from another one of the same model.
struct SearchStyle
{
  std::uint64_t seed = 1;
  double sampled_share = 0.5;  ///< of the trials, in [0, 1]
  double drawn_share = 0.5;    ///< of the trials along the upper bound that draw outcomes by what
                               ///< they add to the gap, instead of taking the greatest; in [0, 1]
};

/// Brings the bounds at the start of a belief graph together: walks from there, then backs up along
/// the way in reverse.
///
/// Two kinds of walks alternate. One follows the upper bound to where the gap comes from; one
/// samples what happens under the policy found so far, which improves the lower bound where it is
/// used, also where upper bounds stay far off. Not thread-safe.
class Search
{
public:
  /// The graph, the grid and the supervisor outlive this object. The supervisor is asked for the
  /// time only: a walk ends where it is up.
  /// @param grid       over the graph, or null; its rounds come between walks as often as they pay
  /// @param precision  gap at the start that is small enough
  Search(BeliefGraph& graph, BeliefGrid* grid, double precision, const SearchStyle& style,
         const Supervisor& supervisor);

  /// One backup, or a piece of work on the grid or the graph's source of bounds. May do nothing
  /// when the gap is closed or a sampled walk ends at once.
  void step();

  [[nodiscard]] std::uint64_t backups() const { return backups_; }
  /// Bounds of the value before anything is seen.
  double lower();
  double upper();

private:
  bool isSourceDue() const;
  template <typename ValueOf>
  double expected(const ValueOf& value_of);
  NodeId widestRoot();
  NodeId sampledRoot();
  NodeId widestChild(NodeId node, std::size_t action, double allowed, bool draw);
  void trialStep();
  void gridStep();
  void upperTrial();
  void sampledTrial();
  std::size_t anyUseful(NodeId node);
  NodeId sampledChild(NodeId node, std::size_t action);
  double uniform();

  BeliefGraph* graph_;
  BeliefGrid* grid_;
  double precision_;
  SearchStyle style_;
  const Supervisor* supervisor_;
  std::vector<NodeId> path_;  // still to be backed up, the last first
  BeliefGraph::Width width_ = BeliefGraph::Width::kExpanded;
  std::uint64_t backups_ = 0;
  double sampled_due_ = 0.0;       // trials
  std::uint64_t source_work_ = 0;  // pieces
  WorkSplit split_;
  double gap_before_ = 0.0;       // the round of the grid under way
  std::uint64_t round_work_ = 0;  // of the round so far
  std::mt19937_64 random_;
};

}  // namespace kr3::pomdp
