#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "arena.hpp"
#include "belief_index.hpp"
#include "informed_bound.hpp"
#include "observed_model.hpp"
#include "packed_belief.hpp"
#include "sawtooth_set.hpp"
#include "upper_bound_source.hpp"
#include "vector_set.hpp"

namespace kr3::pomdp
{

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
  double reward;       ///< expected immediate reward
  double upper;        ///< least known upper bound of doing it first; may be out of date
  const Edge* edges;   ///< null until they are asked for
  std::uint32_t size;  ///< of the edges
  bool useless;        ///< its upper bound fell below the node's lower bound: never optimal here
};

/// What a graph found, for another graph of the same model.
struct Findings
{
  struct Vector
  {
    std::uint32_t state_class;
    std::uint32_t action;
    std::vector<double> values;  ///< shape [states of the class]
  };
  struct Point
  {
    std::uint32_t state_class;
    std::vector<double> belief;  ///< shape [states of the class]
    double upper;
  };
  std::vector<Vector> vectors;
  std::vector<Point> points;
};

/// Beliefs that were met, each once, with their bounds; and the two value functions.
///
/// Bounds of a node are brought up to date when asked for: only vectors and points that came since
/// are looked at. An action's outcomes are found when its upper bound, which is known before, makes
/// them matter. The belief of a node whose own outcomes were never asked for is not stored but
/// found anew from the node that led there. Not thread-safe.
class BeliefGraph
{
public:
  /// @param informed  the vector of an action bounds the value of doing that action first
  /// @param blind     lower bounds of doing one action for ever
  /// @param source    more upper bounds, or null; it and the model outlive this object
  BeliefGraph(const ObservedModel& model, InformedVectors informed, const InformedVectors& blind,
              UpperBoundSource* source = nullptr);

  /// The nodes of the model's starts, in their order.
  [[nodiscard]] const std::vector<NodeId>& roots() const { return roots_; }
  [[nodiscard]] std::size_t numNodes() const { return nodes_.size(); }
  [[nodiscard]] std::size_t numVectors() const { return num_vectors_; }
  /// Entries of all vectors together.
  [[nodiscard]] std::size_t numEntries() const { return num_entries_; }
  [[nodiscard]] const std::vector<VectorSet>& vectors() const { return vectors_; }
  [[nodiscard]] const ObservedModel& model() const { return *model_; }
  [[nodiscard]] UpperBoundSource* source() const { return source_; }
  /// Upper bounds of doing each action first, at the corners: shape [classes][actions][states,
  /// padded].
  [[nodiscard]] const InformedVectors& informed() const { return informed_; }
  /// Memory held: nodes, outcomes, beliefs and their index, vectors, points.
  [[nodiscard]] std::size_t sizeInBytes() const;

  /// The node of a belief of shape [states of the class]; a new one if it was not met before.
  NodeId nodeOf(std::uint32_t state_class, const std::vector<double>& belief);
  [[nodiscard]] std::uint32_t stateClass(NodeId node) const { return nodes_[node].state_class; }
  /// Shape [states of the class].
  std::vector<double> belief(NodeId node);

  /// Value of the belief under the vectors; never falls.
  double lower(NodeId node);
  /// Least known upper bound of the belief's value; never rises.
  double upper(NodeId node);
  /// The upper bound as it was brought up to date last.
  [[nodiscard]] double knownUpper(NodeId node) const { return nodes_[node].upper; }
  /// Takes a true upper bound from elsewhere; a new point if it is lower than what is known.
  void tighten(NodeId node, double upper);

  /// Shape [num_actions]. The slice stays valid.
  Slice<const NodeAction> actions(NodeId node);
  /// Outcomes that are possible. The slice stays valid.
  Slice<const Edge> edges(NodeId node, std::size_t action);

  /// Bounds of doing `action` first.
  double lowerOf(NodeId node, std::size_t action);
  double upperOf(NodeId node, std::size_t action);

  struct Choice
  {
    std::size_t action;
    double value;
  };
  /// Which actions a lower bound is looked for with.
  enum class Width
  {
    kExpanded,  ///< those whose outcomes were asked for, and that of the best vector
    kAll,
  };
  /// The action with the greatest bound; useless ones are left out, ties go to the first.
  Choice bestLower(NodeId node, Width width);
  Choice bestUpper(NodeId node);

  /// One point-based backup: a new vector if it raises the lower bound here, a new point if it
  /// lowers the upper bound.
  void backUp(NodeId node, Width width);

  /// From now on, keeps account of what is found here, for takeFindings().
  void recordFindings() { recording_ = true; }
  /// What was found since the last time and still is the best known.
  Findings takeFindings();
  /// Takes over what another graph of the same model found.
  void take(const Findings& findings);
  /// Counted work so far: the same in every run, and about as long for the same count.
  [[nodiscard]] std::uint64_t work() const { return work_; }
  /// Counts work that was done elsewhere for this graph.
  void countWork(std::uint64_t work) { work_ += work; }

private:
  static constexpr std::uint32_t kNone = 0xffffffff;
  struct Node
  {
    double lower;
    double upper;
    std::uint64_t hash;
    std::uint32_t state_class;
    std::uint32_t vector = 0;  // best known vector
    std::uint32_t vectors_seen = 0;
    std::uint32_t points_seen = 0;
    std::uint32_t point = kNone;    // its own
    std::uint32_t belief = kNone;   // in `beliefs_`
    std::uint32_t actions = kNone;  // in `action_tables_`
    // How to find the belief when it is not stored.
    NodeId parent = kNone;
    std::uint32_t parent_action = 0;
    std::uint32_t parent_branch = 0;
    std::uint32_t source_version = 0;
  };
  struct Origin
  {
    NodeId parent;
    std::uint32_t action;
    std::uint32_t branch;
  };

  NodeId find(std::uint32_t state_class, const UnpackedBelief& belief, const Origin* origin);
  PackedBelief packed(NodeId node);
  const UnpackedBelief& unpacked(NodeId node);
  double follow(const PackedBelief& belief, const Branch& branch, UnpackedBelief& next) const;
  void store(NodeId node, const UnpackedBelief& belief);
  NodeAction* table(NodeId node);
  void expand(NodeId node, std::size_t action);
  void refreshLower(NodeId node);
  void setUpper(NodeId node, double value);
  void addVector(std::uint32_t state_class, std::uint32_t action,
                 const std::vector<double>& values);
  std::vector<double> backedUpVector(NodeId node, std::size_t action);
  NodeId fallback(std::uint32_t state_class, std::size_t action, std::size_t branch);

  const ObservedModel* model_;       // outlives this object
  InformedVectors informed_;         // padded
  UpperBoundSource* source_;         // null = none
  std::vector<VectorSet> vectors_;   // shape [classes]
  std::vector<SawtoothSet> points_;  // shape [classes]
  std::deque<Node> nodes_;
  std::vector<NodeId> roots_;
  std::vector<NodeAction*> action_tables_;
  std::vector<PackedBelief> beliefs_;
  Arena<NodeAction> actions_;
  Arena<Edge> edges_;
  Arena<double> belief_values_;
  Arena<std::uint32_t> belief_blocks_;
  BeliefIndex index_;
  // The belief that stands for an outcome that is impossible where a vector is
  // built: [class][action][branch].
  std::vector<std::vector<std::vector<NodeId>>> fallbacks_;
  std::size_t num_vectors_ = 0;
  std::size_t num_entries_ = 0;
  std::size_t set_bytes_ = 0;  // vectors and points
  std::size_t fixed_bytes_ = 0;
  std::uint64_t work_ = 0;
  bool recording_ = false;
  struct NewVector
  {
    std::uint32_t state_class;
    std::uint32_t number;
  };
  std::vector<NewVector> new_vectors_;
  std::vector<NodeId> new_points_;
  // Work space.
  UnpackedBelief unpacked_;
  NodeId unpacked_node_ = kNone;
  UnpackedBelief next_;
  UnpackedBelief other_;
  std::vector<bool> fresh_;
};

}  // namespace kr3::pomdp
