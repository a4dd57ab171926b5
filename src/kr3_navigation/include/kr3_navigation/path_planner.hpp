#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kr3_navigation/occupancy_grid.hpp"

namespace kr3::navigation
{

struct PathPlannerOptions
{
  double inflation_radius_m = 0.28;  ///< nodes nearer than this to an obstacle are blocked
  double comfort_distance_m = 0.6;   ///< nearer than this costs extra
  double clearance_weight = 4.0;  ///< extra cost per metre of path and metre of missing clearance
  bool unknown_is_free =
      false;  ///< while a map is built, the robot drives into what it has not seen
};

/// A planned path, or the reason why there is none. "No path" is an outcome, not an error.
struct PlannedPath
{
  std::vector<Point> points;  ///< map frame, from start to goal; empty when there is none
  double length_m = 0.0;
  double cost = 0.0;   ///< length, weighted by missing clearance
  std::string reason;  ///< why there is no path; empty when there is one

  [[nodiscard]] bool found() const { return !points.empty(); }
};

/// Shortest paths on one state of the map: eight neighbours, no diagonal step past a blocked node.
/// Immutable, so threads may share it.
class PathPlanner
{
public:
  /// Cost: a distance transform of the grid, about 1 ms for 40 000 nodes.
  PathPlanner(const OccupancyGrid& grid, const PathPlannerOptions& options);

  /// For narrow gaps: nodes of half the size, and what a scan has just hit counts where it was hit
  /// instead of where the nodes around it lie.
  /// @param hits  map frame; nodes of obstacles within a node of one are taken for the same thing
  /// Cost: about 6 ms for 40 000 nodes and 360 hits.
  PathPlanner(const OccupancyGrid& grid, const PathPlannerOptions& options,
              const std::vector<Point>& hits);

  /// A path of least cost (A*). A start that is too near an obstacle is first led out of the
  /// inflation; a goal there is unreachable.
  [[nodiscard]] PlannedPath plan(Point start, Point goal) const;

  /// Lengths of the shortest paths from `start` to every node (Dijkstra, no extra cost for
  /// clearance), m; +inf where there is none. Shape [height, width], row-major.
  [[nodiscard]] std::vector<double> distancesFrom(Point start) const;

  [[nodiscard]] const PathPlannerOptions& options() const { return options_; }
  [[nodiscard]] const GridGeometry& geometry() const { return field_.geometry; }
  /// Distances to the nearest occupied node.
  [[nodiscard]] const DistanceField& field() const { return field_; }
  /// Whether the robot's centre may be in the node that holds p.
  [[nodiscard]] bool isFree(Point p) const;
  [[nodiscard]] bool isFree(int node) const { return free_[static_cast<std::size_t>(node)] != 0; }
  /// Whether the robot's centre may move from a to b along the straight line.
  [[nodiscard]] bool isSegmentFree(Point a, Point b) const;
  /// Distance to the nearest occupied node, m; 0 off the grid.
  [[nodiscard]] double clearance(Point p) const { return field_.at(p, 0.0); }
  /// Centre of the free node nearest to p within `radius_m`, in a straight line from p not through
  /// an obstacle.
  [[nodiscard]] std::optional<Point> nearestFree(Point p, double radius_m) const;
  /// Whether p lies in the largest connected free region, the one a robot can be expected in.
  [[nodiscard]] bool isInMainRegion(Point p) const;

private:
  [[nodiscard]] std::string whyBlocked(const char* what, Point p) const;
  void findMainRegion();

  PathPlannerOptions options_;
  DistanceField field_;
  std::vector<char> free_;
  std::vector<char> in_main_region_;
};

}  // namespace kr3::navigation
