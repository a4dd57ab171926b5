#include "kr3_navigation/cells.hpp"

#include <cmath>
#include <deque>
#include <limits>

#include <kr3_common/error.hpp>
#include <kr3_common/nearest_name.hpp>

namespace kr3::navigation
{
namespace
{

constexpr double kTouch = 1e-6;  // m

/// Whether two rectangles share a piece of border longer than a point.
bool touchByEdge(const Rectangle& a, const Rectangle& b)
{
  const double x = std::min(a.x_max, b.x_max) - std::max(a.x_min, b.x_min);
  const double y = std::min(a.y_max, b.y_max) - std::max(a.y_min, b.y_min);
  return (std::abs(x) <= kTouch && y > kTouch) || (std::abs(y) <= kTouch && x > kTouch);
}

/// For every free node the cell it belongs to: the one whose rectangle holds it, else the one from
/// which it is reached first within `depth_m`; -1 for none. So a passage is divided between the
/// cells at its two ends.
std::vector<int> assignNodes(const std::vector<Cell>& cells, double depth_m,
                             const PathPlanner& planner)
{
  const GridGeometry& grid = planner.geometry();
  std::vector<int> owner(grid.size(), -1);
  std::vector<double> depth(grid.size(), 0.0);
  std::deque<int> queue;
  for (std::size_t cell = 0; cell < cells.size(); ++cell)
  {
    for (int node = 0; node < static_cast<int>(grid.size()); ++node)
    {
      if (owner[static_cast<std::size_t>(node)] >= 0 || !planner.isFree(node) ||
          !cells[cell].rectangle.contains(grid.center(node)))
        continue;
      owner[static_cast<std::size_t>(node)] = static_cast<int>(cell);
      queue.push_back(node);
    }
  }
  while (!queue.empty())
  {
    const int node = queue.front();
    queue.pop_front();
    const double next_depth = depth[static_cast<std::size_t>(node)] + grid.resolution_m;
    if (next_depth > depth_m + 1e-9)
      continue;
    for (const int step : {1, -1, grid.width, -grid.width})
    {
      const int next = node + step;
      if (next < 0 || next >= static_cast<int>(grid.size()) ||
          owner[static_cast<std::size_t>(next)] >= 0 || !planner.isFree(next) ||
          (std::abs(step) == 1 && next / grid.width != node / grid.width))
        continue;
      owner[static_cast<std::size_t>(next)] = owner[static_cast<std::size_t>(node)];
      depth[static_cast<std::size_t>(next)] = next_depth;
      queue.push_back(next);
    }
  }
  return owner;
}

bool knowsPartOf(const OccupancyGrid& grid, const Rectangle& area)
{
  for (std::size_t node = 0; node < grid.nodes.size(); ++node)
  {
    if (grid.nodes[node] != Occupancy::kUnknown &&
        area.contains(grid.geometry.center(static_cast<int>(node))))
      return true;
  }
  return false;
}

}  // namespace

std::vector<Rectangle> splitIntoCells(const Rectangle& place, int count)
{
  constexpr int kMaxCells = 1000;
  if (count < 1 || count > kMaxCells)
    throw InvalidArgument(std::to_string(count) + " cells per room, expected 1 to " +
                          std::to_string(kMaxCells));
  int best_columns = 1;
  double best_skew = std::numeric_limits<double>::infinity();
  for (int columns = 1; columns <= count; ++columns)
  {
    if (count % columns != 0)
      continue;
    const int rows = count / columns;
    const double skew = std::abs(std::log((place.width() / columns) / (place.height() / rows)));
    if (skew < best_skew - 1e-9)
    {
      best_skew = skew;
      best_columns = columns;
    }
  }
  const int rows = count / best_columns;
  std::vector<Rectangle> cells;
  for (int row = 0; row < rows; ++row)
  {
    for (int column = 0; column < best_columns; ++column)
    {
      const auto x = [&](int i) {
        return i == best_columns ? place.x_max : place.x_min + place.width() * i / best_columns;
      };
      const auto y = [&](int i) {
        return i == rows ? place.y_max : place.y_min + place.height() * i / rows;
      };
      cells.push_back({x(column), y(row), x(column + 1), y(row + 1)});
    }
  }
  return cells;
}

std::optional<Point> standIn(const Rectangle& cell, const CellOptions& options,
                             const PathPlanner& planner)
{
  const GridGeometry& grid = planner.geometry();
  const double border = grid.resolution_m / 2.0;
  // The comfortable demands first; each pass gives up one of them.
  struct Demand
  {
    double margin_m;
    double clearance_m;
  };
  for (const Demand& demand : {Demand{options.margin_m, options.stand_clearance_m},
                               Demand{options.margin_m, 0.0}, Demand{border, 0.0}})
  {
    const Rectangle inner = cell.shrunk(demand.margin_m);
    std::optional<Point> best;
    for (int row = grid.row(inner.y_min); row <= grid.row(inner.y_max); ++row)
    {
      for (int column = grid.column(inner.x_min); column <= grid.column(inner.x_max); ++column)
      {
        if (!grid.isInside(column, row))
          continue;
        const Point p = grid.center(row * grid.width + column);
        if (inner.contains(p) && planner.isInMainRegion(p) &&
            planner.clearance(p) >= demand.clearance_m &&
            (!best || distance(p, cell.center()) < distance(*best, cell.center()) - 1e-9))
          best = p;
      }
    }
    if (best)
      return best;
  }
  return std::nullopt;
}

Point presentStand(const Cell& cell, const CellOptions& options, const PathPlanner& planner)
{
  if (planner.isInMainRegion(cell.stand))
    return cell.stand;
  return standIn(cell.rectangle, options, planner).value_or(cell.stand);
}

CellMap::CellMap(const std::vector<Place>& places, const CellOptions& options,
                 const PathPlanner& planner)
{
  for (const Place& place : places)
  {
    int number = 0;
    for (const Rectangle& rectangle : splitIntoCells(place.rectangle, options.cells_per_room))
    {
      Cell cell;
      cell.name = place.name + "_c" + std::to_string(number++);
      cell.place = place.name;
      cell.rectangle = rectangle;
      const std::optional<Point> stand = standIn(rectangle, options, planner);
      cell.stand = stand.value_or(rectangle.center());
      cell.reachable = stand.has_value();
      if (find(cell.name))
        throw InvalidArgument("two cells are named " + cell.name);
      cells_.push_back(cell);
    }
  }
  const std::size_t n = cells_.size();
  travel_distance_m_.assign(n * n, std::numeric_limits<double>::infinity());
  for (std::size_t from = 0; from < n; ++from)
  {
    travel_distance_m_[from * n + from] = 0.0;
    if (!cells_[from].reachable)
      continue;
    const std::vector<double> lengths = planner.distancesFrom(cells_[from].stand);
    for (std::size_t to = 0; to < from; ++to)
    {
      if (!cells_[to].reachable)
        continue;
      const double length =
          lengths[static_cast<std::size_t>(planner.geometry().index(cells_[to].stand))];
      travel_distance_m_[from * n + to] = length;
      travel_distance_m_[to * n + from] = length;
    }
  }
  findNeighbors(options, planner);
}

void CellMap::findNeighbors(const CellOptions& options, const PathPlanner& planner)
{
  const std::size_t n = cells_.size();
  std::vector<char> joined(n * n, 0);
  for (std::size_t a = 0; a < n; ++a)
  {
    for (std::size_t b = 0; b < n; ++b)
    {
      if (cells_[a].place == cells_[b].place &&
          touchByEdge(cells_[a].rectangle, cells_[b].rectangle))
        joined[a * n + b] = 1;
    }
  }
  // Across places: where the robot's centre can cross from one cell's nodes to the other's.
  const GridGeometry& grid = planner.geometry();
  const std::vector<int> owner = assignNodes(cells_, options.passage_depth_m, planner);
  const auto join = [&](int first, int second) {
    const int owner_a = owner[static_cast<std::size_t>(first)];
    const int owner_b = owner[static_cast<std::size_t>(second)];
    if (owner_a < 0 || owner_b < 0)
      return;
    const auto a = static_cast<std::size_t>(owner_a);
    const auto b = static_cast<std::size_t>(owner_b);
    if (cells_[a].place != cells_[b].place)
      joined[a * n + b] = joined[b * n + a] = 1;
  };
  for (int node = 0; node < static_cast<int>(grid.size()); ++node)
  {
    if ((node + 1) % grid.width != 0)
      join(node, node + 1);
    if (node + grid.width < static_cast<int>(grid.size()))
      join(node, node + grid.width);
  }
  for (std::size_t a = 0; a < n; ++a)
  {
    for (std::size_t b = 0; b < n; ++b)
    {
      if (joined[a * n + b] != 0 && cells_[a].reachable && cells_[b].reachable)
        cells_[a].neighbors.push_back(b);
    }
  }
}

std::optional<std::size_t> CellMap::find(const std::string& name) const
{
  for (std::size_t cell = 0; cell < cells_.size(); ++cell)
  {
    if (cells_[cell].name == name)
      return cell;
  }
  return std::nullopt;
}

const std::string& CellMap::nearestName(const std::string& name) const
{
  std::vector<std::string> names;
  for (const Cell& cell : cells_)
  {
    names.push_back(cell.name);
  }
  const std::string* nearest = kr3::nearestName(name, names);
  return cells_.at(static_cast<std::size_t>(nearest - names.data())).name;
}

std::vector<std::string> describeUnreachable(const CellMap& map, const std::vector<Place>& places,
                                             const OccupancyGrid& grid)
{
  std::vector<std::string> lines;
  bool any_reachable = false;
  for (const Place& place : places)
  {
    std::vector<std::string> cells;
    bool reachable = false;
    for (const Cell& cell : map.cells())
    {
      if (cell.place != place.name)
        continue;
      reachable = reachable || cell.reachable;
      if (!cell.reachable)
        cells.push_back("the cell " + cell.name + " has no free point that the robot can reach");
    }
    any_reachable = any_reachable || reachable;
    if (reachable)
      lines.insert(lines.end(), cells.begin(), cells.end());
    else if (knowsPartOf(grid, place.rectangle))
      lines.push_back("the place " + place.name + " has no free point that the robot can reach");
    else
      lines.push_back("the place " + place.name + ", x " + std::to_string(place.rectangle.x_min) +
                      " to " + std::to_string(place.rectangle.x_max) + " m, y " +
                      std::to_string(place.rectangle.y_min) + " to " +
                      std::to_string(place.rectangle.y_max) + " m, is not in the map");
  }
  if (!any_reachable)
    lines.emplace_back("no cell of the building can be reached: does the map belong to it?");
  return lines;
}

std::size_t CellMap::cellAt(Point p) const
{
  const auto nearest =
      std::min_element(cells_.begin(), cells_.end(), [&](const Cell& a, const Cell& b) {
        return a.rectangle.distanceTo(p) < b.rectangle.distanceTo(p);
      });
  return static_cast<std::size_t>(nearest - cells_.begin());
}

}  // namespace kr3::navigation
