#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <unordered_map>
#include <vector>

#include "informed_bound.hpp"
#include "observed_model.hpp"
#include "upper_bound_source.hpp"
#include "vector_set.hpp"

namespace kr3::pomdp
{

using NodeId = std::uint32_t;

/// A possible outcome of an action at a belief.
struct Edge
{
  double probability;
  NodeId child;
  std::uint32_t branch;
};

/// What is known of an action at a belief.
struct NodeAction
{
  double reward;             ///< expected immediate reward
  bool useless;              ///< its upper bound fell below the node's lower bound: never
                             ///< optimal here
  std::uint32_t first_edge;  ///< in the node's edges
  std::uint32_t last_edge;   ///< one past
};

/// Beliefs that were met, each once, with their bounds; and the two value
/// functions.
///
/// Bounds of a node are brought up to date when asked for: only vectors and
/// points that came since are looked at. Not thread-safe.
class BeliefGraph
{
public:
  /// @param source  more upper bounds, or null; it and all others outlive this object
  BeliefGraph(const ObservedModel& model, const InformedVectors& informed,
              const InformedVectors& blind, UpperBoundSource* source = nullptr);

  /// The nodes of the model's starts, in their order.
  [[nodiscard]] const std::vector<NodeId>& roots() const { return roots_; }
  [[nodiscard]] std::size_t numNodes() const { return nodes_.size(); }
  [[nodiscard]] std::size_t numVectors() const;
  [[nodiscard]] const std::vector<VectorSet>& vectors() const { return vectors_; }
  [[nodiscard]] const ObservedModel& model() const { return *model_; }
  [[nodiscard]] UpperBoundSource* source() const { return source_; }
  /// Memory held: nodes, outcomes, beliefs and their index, vectors, points.
  [[nodiscard]] std::size_t sizeInBytes() const;

  /// Value of the belief under the vectors; never falls.
  double lower(NodeId node);
  /// Least known upper bound of the belief's value; never rises.
  double upper(NodeId node);

  /// Actions and outcomes of a node; computed the first time. The references
  /// stay valid.
  const std::vector<NodeAction>& actions(NodeId node);
  const std::vector<Edge>& edges(NodeId node);

  /// Bounds of doing `action` first.
  double lowerOf(NodeId node, std::size_t action);
  double upperOf(NodeId node, std::size_t action);

  struct Choice
  {
    std::size_t action;
    double value;
  };
  /// The action with the greatest bound; useless ones are left out, ties go to
  /// the first.
  Choice bestLower(NodeId node);
  Choice bestUpper(NodeId node);

  /// One point-based backup: a new vector if it raises the lower bound here, a
  /// new point if it lowers the upper bound.
  void backUp(NodeId node);

private:
  struct Expansion
  {
    std::vector<NodeAction> actions;
    std::vector<Edge> edges;
  };
  struct Node
  {
    std::uint32_t state_class;
    std::uint32_t vector = 0;  // best known vector
    std::uint32_t vectors_seen = 0;
    std::uint32_t points_seen = 0;
    std::uint32_t point = 0;      // index + 1 of its own point; 0 = none
    std::uint32_t expansion = 0;  // index + 1; 0 = not expanded
    std::uint32_t source_version = 0;
    double lower;
    double upper;
    const double* belief;  // padded, in `storage_`
  };

  NodeId nodeOf(std::uint32_t state_class, std::vector<double>& belief);
  Expansion& expansion(NodeId node);
  void expand(NodeId node);
  void refreshLower(Node& node);
  std::vector<double> backedUpVector(NodeId node, std::size_t action);
  NodeId fallback(std::uint32_t state_class, std::size_t action, std::size_t branch);

  const ObservedModel* model_;       // outlives this object
  const InformedVectors* informed_;  // outlives this object
  UpperBoundSource* source_;         // null = none
  std::vector<VectorSet> vectors_;   // shape [classes]
  std::vector<SawtoothSet> points_;  // shape [classes]
  std::deque<Node> nodes_;
  std::vector<NodeId> roots_;
  std::deque<Expansion> expansions_;
  std::deque<std::vector<double>> storage_;
  std::size_t expansion_bytes_ = 0;
  std::size_t storage_bytes_ = 0;
  std::unordered_multimap<std::uint64_t, NodeId> index_;
  // The belief that stands for an outcome that is impossible where a vector is
  // built: [class][action][branch].
  std::vector<std::vector<std::vector<NodeId>>> fallbacks_;
};

}  // namespace kr3::pomdp
