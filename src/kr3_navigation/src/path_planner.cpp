#include "kr3_navigation/path_planner.hpp"

#include <array>
#include <cstdio>
#include <limits>
#include <queue>

namespace kr3::navigation
{
namespace
{

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kEscapeRadius = 0.5;  // m: how far a start inside the inflation is led out

struct Step
{
  int column;
  int row;
  double length;  // in nodes
};
constexpr double kDiagonal = 1.4142135623730951;
constexpr std::array<Step, 8> kSteps{{{1, 0, 1.0},
                                      {0, 1, 1.0},
                                      {-1, 0, 1.0},
                                      {0, -1, 1.0},
                                      {1, 1, kDiagonal},
                                      {-1, 1, kDiagonal},
                                      {-1, -1, kDiagonal},
                                      {1, -1, kDiagonal}}};

struct QueueEntry
{
  double priority;
  double cost;
  int node;
  bool operator>(const QueueEntry& other) const { return priority > other.priority; }
};
using OpenQueue = std::priority_queue<QueueEntry, std::vector<QueueEntry>, std::greater<>>;

/// Calls visit(next_node, step_length_in_nodes) for every node that one step from `node` reaches.
template <typename Visit>
void forEachStep(const GridGeometry& geometry, const std::vector<char>& free, int node,
                 Visit&& visit)
{
  const int column = node % geometry.width;
  const int row = node / geometry.width;
  const auto is_free = [&](int c, int r) {
    return geometry.isInside(c, r) && free[static_cast<std::size_t>(r * geometry.width + c)] != 0;
  };
  for (const Step& step : kSteps)
  {
    const int c = column + step.column;
    const int r = row + step.row;
    if (!is_free(c, r))
      continue;
    const bool diagonal = step.column != 0 && step.row != 0;
    if (diagonal && !(is_free(c, row) && is_free(column, r)))
      continue;
    visit(r * geometry.width + c, step.length);
  }
}

std::string textOf(Point p)
{
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "(%.2f, %.2f)", p.x, p.y);
  return text.data();
}

/// The grid without the obstacles that hits explain, in nodes of half the size.
OccupancyGrid halved(OccupancyGrid grid, const std::vector<Point>& hits)
{
  for (const Point& hit : hits)
  {
    forEachNear(grid.geometry, hit, grid.geometry.resolution_m, [&](int node) {
      Occupancy& value = grid.nodes[static_cast<std::size_t>(node)];
      if (value == Occupancy::kOccupied)
        value = Occupancy::kFree;
    });
  }
  OccupancyGrid fine;
  fine.geometry = {grid.geometry.resolution_m / 2.0, grid.geometry.origin, 2 * grid.geometry.width,
                   2 * grid.geometry.height};
  fine.nodes.resize(fine.geometry.size());
  for (std::size_t node = 0; node < fine.nodes.size(); ++node)
  {
    const int column = static_cast<int>(node) % fine.geometry.width / 2;
    const int row = static_cast<int>(node) / fine.geometry.width / 2;
    fine.nodes[node] = grid.nodes[static_cast<std::size_t>(row * grid.geometry.width + column)];
  }
  return fine;
}

}  // namespace

PathPlanner::PathPlanner(const OccupancyGrid& grid, const PathPlannerOptions& options,
                         const std::vector<Point>& hits)
  : PathPlanner(halved(grid, hits), options)
{
  for (const Point& hit : hits)
  {
    forEachNear(geometry(), hit, options_.comfort_distance_m, [&](int node) {
      const double away = distance(geometry().center(node), hit);
      float& known = field_.distance_m[static_cast<std::size_t>(node)];
      known = std::min(known, static_cast<float>(away));
      if (away < options_.inflation_radius_m)
        free_[static_cast<std::size_t>(node)] = 0;
    });
  }
  findMainRegion();
}

PathPlanner::PathPlanner(const OccupancyGrid& grid, const PathPlannerOptions& options)
  : options_(options), field_(distanceField(grid)), free_(grid.nodes.size(), 0)
{
  for (std::size_t node = 0; node < free_.size(); ++node)
  {
    const bool known = grid.nodes[node] == Occupancy::kFree ||
                       (options_.unknown_is_free && grid.nodes[node] == Occupancy::kUnknown);
    free_[node] =
        known && static_cast<double>(field_.distance_m[node]) >= options_.inflation_radius_m ? 1
                                                                                             : 0;
  }
  findMainRegion();
}

void PathPlanner::findMainRegion()
{
  std::vector<int> region(free_.size(), -1);
  std::vector<std::size_t> sizes;
  std::vector<int> stack;
  for (std::size_t seed = 0; seed < free_.size(); ++seed)
  {
    if (free_[seed] == 0 || region[seed] >= 0)
      continue;
    const int label = static_cast<int>(sizes.size());
    sizes.push_back(0);
    region[seed] = label;
    stack.push_back(static_cast<int>(seed));
    while (!stack.empty())
    {
      const int node = stack.back();
      stack.pop_back();
      ++sizes.back();
      forEachStep(field_.geometry, free_, node, [&](int next, double) {
        int& next_label = region[static_cast<std::size_t>(next)];
        if (next_label < 0)
        {
          next_label = label;
          stack.push_back(next);
        }
      });
    }
  }
  in_main_region_.assign(free_.size(), 0);
  if (sizes.empty())
    return;
  const int largest =
      static_cast<int>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
  for (std::size_t node = 0; node < free_.size(); ++node)
    in_main_region_[node] = region[node] == largest ? 1 : 0;
}

bool PathPlanner::isFree(Point p) const
{
  return geometry().contains(p) && isFree(geometry().index(p));
}

bool PathPlanner::isInMainRegion(Point p) const
{
  return geometry().contains(p) &&
         in_main_region_[static_cast<std::size_t>(geometry().index(p))] != 0;
}

bool PathPlanner::isSegmentFree(Point a, Point b) const
{
  const double step = geometry().resolution_m / 4.0;
  const int count = std::max(1, static_cast<int>(std::ceil(distance(a, b) / step)));
  for (int i = 0; i <= count; ++i)
  {
    const double t = static_cast<double>(i) / count;
    if (!isFree({a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)}))
      return false;
  }
  return true;
}

std::optional<Point> PathPlanner::nearestFree(Point p, double radius_m) const
{
  const int reach = static_cast<int>(std::ceil(radius_m / geometry().resolution_m));
  const int column = geometry().column(p.x);
  const int row = geometry().row(p.y);
  // On the way out the clearance may be small but must not fall to that of an obstacle's own node.
  const auto passes = [&](Point target) {
    constexpr int kSamples = 10;
    for (int i = 1; i <= kSamples; ++i)
    {
      const double t = static_cast<double>(i) / kSamples;
      if (clearance({p.x + t * (target.x - p.x), p.y + t * (target.y - p.y)}) <
          std::min(clearance(p), geometry().resolution_m) - 1e-9)
        return false;
    }
    return true;
  };
  std::optional<Point> best;
  for (int r = row - reach; r <= row + reach; ++r)
  {
    for (int c = column - reach; c <= column + reach; ++c)
    {
      if (!geometry().isInside(c, r) || !isFree(r * geometry().width + c))
        continue;
      const Point candidate = geometry().center(r * geometry().width + c);
      const double away = distance(p, candidate);
      if (away <= radius_m && (!best || away < distance(p, *best)) && passes(candidate))
        best = candidate;
    }
  }
  return best;
}

std::string PathPlanner::whyBlocked(const char* what, Point p) const
{
  const std::string place = std::string(what) + " " + textOf(p);
  if (!geometry().contains(p))
    return place + " is outside the map";
  const std::size_t node = static_cast<std::size_t>(geometry().index(p));
  if (static_cast<double>(field_.distance_m[node]) < options_.inflation_radius_m)
    return place + " is " + std::to_string(field_.distance_m[node]).substr(0, 4) +
           " m from an obstacle, the robot needs " +
           std::to_string(options_.inflation_radius_m).substr(0, 4) + " m";
  return place + " is unknown in the map";
}

PlannedPath PathPlanner::plan(Point start, Point goal) const
{
  PlannedPath path;
  if (!isFree(goal))
  {
    path.reason = whyBlocked("the goal", goal);
    return path;
  }
  Point entry = start;
  if (!isFree(start))
  {
    const std::optional<Point> way_out = nearestFree(start, kEscapeRadius);
    if (!way_out)
    {
      path.reason = whyBlocked("the start", start);
      return path;
    }
    entry = *way_out;
  }

  const GridGeometry& grid = geometry();
  const int first = grid.index(entry);
  const int last = grid.index(goal);
  const Point last_center = grid.center(last);
  const auto penalty = [this](int node) {
    const double missing = options_.comfort_distance_m -
                           static_cast<double>(field_.distance_m[static_cast<std::size_t>(node)]);
    return 1.0 + options_.clearance_weight * std::max(0.0, missing);
  };
  std::vector<double> cost(grid.size(), kInfinity);
  std::vector<int> parent(grid.size(), -1);
  OpenQueue open;
  cost[static_cast<std::size_t>(first)] = 0.0;
  open.push({distance(grid.center(first), last_center), 0.0, first});
  while (!open.empty())
  {
    const QueueEntry entry_best = open.top();
    open.pop();
    if (entry_best.node == last)
      break;
    if (entry_best.cost > cost[static_cast<std::size_t>(entry_best.node)])
      continue;
    forEachStep(grid, free_, entry_best.node, [&](int next, double length) {
      const double step =
          length * grid.resolution_m * (penalty(entry_best.node) + penalty(next)) / 2.0;
      double& known = cost[static_cast<std::size_t>(next)];
      if (entry_best.cost + step < known)
      {
        known = entry_best.cost + step;
        parent[static_cast<std::size_t>(next)] = entry_best.node;
        open.push({known + distance(grid.center(next), last_center), known, next});
      }
    });
  }
  path.cost = cost[static_cast<std::size_t>(last)];
  if (path.cost == kInfinity)
  {
    path.cost = 0.0;
    path.reason = "no free path from " + textOf(start) + " to " + textOf(goal);
    return path;
  }
  // Start and goal replace the centres of their own nodes.
  path.points.push_back(goal);
  for (int node = parent[static_cast<std::size_t>(last)]; node >= 0 && node != first;
       node = parent[static_cast<std::size_t>(node)])
    path.points.push_back(grid.center(node));
  if (distance(entry, start) > 0.0)
    path.points.push_back(entry);
  path.points.push_back(start);
  std::reverse(path.points.begin(), path.points.end());
  for (std::size_t i = 1; i < path.points.size(); ++i)
    path.length_m += distance(path.points[i - 1], path.points[i]);
  return path;
}

std::vector<double> PathPlanner::distancesFrom(Point start) const
{
  std::vector<double> lengths(geometry().size(), kInfinity);
  if (!isFree(start))
    return lengths;
  OpenQueue open;
  const int first = geometry().index(start);
  lengths[static_cast<std::size_t>(first)] = 0.0;
  open.push({0.0, 0.0, first});
  while (!open.empty())
  {
    const QueueEntry best = open.top();
    open.pop();
    if (best.cost > lengths[static_cast<std::size_t>(best.node)])
      continue;
    forEachStep(geometry(), free_, best.node, [&](int next, double length) {
      double& known = lengths[static_cast<std::size_t>(next)];
      const double candidate = best.cost + length * geometry().resolution_m;
      if (candidate < known)
      {
        known = candidate;
        open.push({candidate, candidate, next});
      }
    });
  }
  return lengths;
}

}  // namespace kr3::navigation
