#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <unordered_map>
#include <vector>

#include "belief_graph.hpp"
#include "convex_decomposition.hpp"
#include "grid_points.hpp"

namespace kr3::pomdp
{

/// An upper bound by value iteration over a grid of beliefs that grows where it matters.
///
/// A grid point knows an upper bound of doing each action first. An outcome of an action is a
/// belief that is seldom a grid point: it is made up of grid points by a linear program, and its
/// bound follows from theirs. With these decompositions kept, the grid is a finite model that is
/// swept cheaply, all points together, where a trial improves only those on its way. Each round
/// finds how often points are used on the way from the start, under the actions that look best
/// (through outcomes and decompositions alike); outcomes that are used often and have a wide gap
/// become points, corners that are used often get outcomes of their own, and outcomes for which a
/// new point promises most are made up anew.
///
/// Every value is a true upper bound at any time and never rises. Not thread-safe.
/// Sources: Hauskrecht (2000), Sec. 4.5; Poupart, Kim and Kim (2011), the fast informed bound over
/// a set of beliefs; Krale, Koops, Junges, Simao and Jansen (2025), one-step beliefs and
/// bounds of actions. Growth by use instead of depth is ours.
class BeliefGrid
{
public:
  /// Little is done, and no memory used, before the first step.
  /// @param graph  gives beliefs, outcomes, lower bounds and upper bounds of each action at the
  ///               corners, and is given upper bounds; outlives this object
  /// @param keep_going  asked about once a millisecond while a step lasts; if it says no,
  ///                    the step ends early
  BeliefGrid(BeliefGraph& graph, std::function<bool()> keep_going);

  /// Operations in the graph's unit of work.
  static constexpr std::uint64_t kOperationsPerWork = 4;

  /// A piece of a round, mostly of a few milliseconds.
  void step();
  /// Whether a round has begun that step() has not ended.
  [[nodiscard]] bool isInRound() const { return phase_ != Phase::kUse; }
  /// Whether the last round changed nothing.
  [[nodiscard]] bool isExhausted() const { return exhausted_; }
  /// Backups done so far.
  [[nodiscard]] std::uint64_t backups() const { return backups_; }

  /// With the corners; none before the first step.
  [[nodiscard]] std::size_t numPoints() const { return points_.size(); }
  /// Multiply-add operations done so far, roughly.
  [[nodiscard]] std::uint64_t work() const { return work_ + decomposer_.work(); }
  /// Memory held after the last step, roughly.
  [[nodiscard]] std::size_t sizeInBytes() const { return bytes_; }

private:
  static constexpr std::uint32_t kNone = 0xffffffff;
  static constexpr double kTolerance = 0.02;  // of decompositions; of the gap at the start
  static constexpr double kLeastUse = 1e-6;   // of a point that is worth a look
  static constexpr std::uint64_t kWorkPerStep = 2000000;  // of a sweep
  static constexpr std::uint64_t kWorkPerQuestion = 50000;

  /// A belief that is a point or an outcome of one.
  struct Entry
  {
    NodeId node = 0;
    std::uint32_t state_class = 0;
    std::uint32_t point = kNone;
    std::uint32_t points_seen = 0;  // of the class, when it was made up last
    double use = 0.0;
    std::vector<Share> shares;  // of points of the class; empty: not made up yet
    std::vector<float> duals;
  };
  struct Outcome
  {
    double probability;  // discounted
    std::uint32_t entry;
  };
  struct Point
  {
    std::uint32_t state_class;
    std::uint32_t number;         // in the class
    std::uint32_t entry = kNone;  // none: a corner without outcomes of its own
    double use = 0.0;
    std::vector<double> rewards;                 // shape [actions]
    std::vector<std::vector<Outcome>> outcomes;  // shape [actions]; empty: not asked for
  };
  struct Ranked
  {
    double rank;
    std::uint32_t index;
  };

  /// Of a round, in their order.
  enum class Phase
  {
    kUse,       // how often points are used; what to do in the round
    kCorners,   // outcomes for corners
    kOutcomes,  // outcomes become points
    kPromise,   // which decompositions to improve
    kAgain,     // outcomes are made up anew
    kSweeps,
    kPublish,
  };

  bool goOn();
  void addCorners();
  void start();
  void countBytes();
  std::uint32_t entryOf(NodeId node);
  std::uint32_t pointOf(std::uint32_t state_class, std::uint32_t number) const;
  GridPoints::Best best(const Entry& entry);
  double gap(const Entry& entry);
  double rootGap();
  void spreadUse();
  void addFlow(std::uint32_t entry, double probability);
  std::vector<Ranked> outcomesByUse();
  std::vector<Ranked> cornersByUse();
  std::vector<Ranked> outcomesByPromise();
  void makeUp(Entry& entry);
  std::uint32_t addPoint(std::uint32_t entry);
  void open(Point& point, std::uint32_t entry);
  void backUp(Point& point);
  double sweep(Point& point, bool all_actions);
  double backedUp(const Point& point, std::size_t action);
  void plan();
  void openCorner();
  void addOutcome();
  void sweepSome();
  void publish();
  void enter(Phase phase);

  BeliefGraph* graph_;
  std::function<bool()> keep_going_;
  std::uint64_t asked_at_ = 0;                           // work
  bool stopped_ = false;                                 // in this step
  std::vector<GridPoints> grids_;                        // shape [classes]
  std::vector<std::uint32_t> first_corner_;              // shape [classes]
  std::vector<std::vector<std::uint32_t>> more_points_;  // shape [classes][points - corners]
  std::vector<Point> points_;                            // corners of all classes first
  std::vector<std::uint32_t> opened_;                    // points with outcomes, in their order
  std::vector<Entry> entries_;
  std::unordered_map<NodeId, std::uint32_t> entry_of_;
  std::vector<std::uint32_t> roots_;  // points
  Decomposer decomposer_;
  // The round under way.
  Phase phase_ = Phase::kUse;
  std::size_t next_ = 0;        // in what the phase goes through
  std::size_t num_sweeps_ = 0;  // done
  std::vector<Ranked> ranked_corners_;
  std::vector<Ranked> ranked_outcomes_;
  std::vector<Ranked> ranked_again_;
  std::size_t most_new_ = 0;  // of each kind
  double settled_ = 0.0;      // change of a sweep that is small
  double sweep_change_ = 0.0;
  bool changed_ = false;
  bool exhausted_ = false;

  double tolerance_ = 0.0;
  std::uint64_t backups_ = 0;
  std::uint64_t work_ = 0;
  std::size_t extra_bytes_ = 0;
  std::size_t bytes_ = 0;
  // Work space of spreadUse.
  std::vector<double> flow_;
  std::vector<std::uint32_t> flow_to_;
};

}  // namespace kr3::pomdp
