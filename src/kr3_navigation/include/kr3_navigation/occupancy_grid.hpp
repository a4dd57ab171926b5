#pragma once

#include <cstdint>
#include <vector>

#include "kr3_navigation/geometry.hpp"

namespace kr3::navigation
{

/// Where a grid lies: square nodes of `resolution_m`, row-major, row 0 at the lowest y, column 0 at
/// the lowest x.
struct GridGeometry
{
  double resolution_m = 0.1;
  Point origin;  ///< the lower left corner of node (0, 0), map frame
  int width = 0;
  int height = 0;

  [[nodiscard]] std::size_t size() const
  {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  [[nodiscard]] int column(double x) const
  {
    return static_cast<int>(std::floor((x - origin.x) / resolution_m));
  }
  [[nodiscard]] int row(double y) const
  {
    return static_cast<int>(std::floor((y - origin.y) / resolution_m));
  }
  [[nodiscard]] bool isInside(int column, int row) const
  {
    return column >= 0 && row >= 0 && column < width && row < height;
  }
  /// Of any point: also of one that is far away or not finite.
  [[nodiscard]] bool contains(Point p) const
  {
    const double u = (p.x - origin.x) / resolution_m;
    const double v = (p.y - origin.y) / resolution_m;
    return u >= 0.0 && v >= 0.0 && u < width && v < height;
  }
  /// Index of the node that holds p. Only for points with contains().
  [[nodiscard]] int index(Point p) const { return row(p.y) * width + column(p.x); }
  [[nodiscard]] Point center(int index) const
  {
    return {origin.x + (index % width + 0.5) * resolution_m,
            origin.y + (index / width + 0.5) * resolution_m};
  }
};

/// Calls visit(node) for every node whose centre is within `radius_m` of p.
template <typename Visit>
void forEachNear(const GridGeometry& geometry, Point p, double radius_m, Visit&& visit)
{
  const int last_column = geometry.column(p.x + radius_m);
  const int last_row = geometry.row(p.y + radius_m);
  for (int row = geometry.row(p.y - radius_m); row <= last_row; ++row)
  {
    for (int column = geometry.column(p.x - radius_m); column <= last_column; ++column)
    {
      const int node = row * geometry.width + column;
      if (geometry.isInside(column, row) && distance(geometry.center(node), p) <= radius_m)
        visit(node);
    }
  }
}

enum class Occupancy : std::uint8_t
{
  kUnknown,
  kFree,
  kOccupied,
};

/// A 2D map. Invariant: nodes.size() == geometry.size().
struct OccupancyGrid
{
  GridGeometry geometry;
  std::vector<Occupancy> nodes;
};

/// Distance to the nearest occupied node, m, between node centres; kFarDistance when nothing is
/// occupied.
struct DistanceField
{
  static constexpr float kFarDistance = 1.0e6F;

  GridGeometry geometry;
  std::vector<float> distance_m;  ///< shape [height, width], row-major

  /// Bilinear between node centres; `outside_m` for points off the grid.
  [[nodiscard]] double at(Point p, double outside_m) const
  {
    const double u = (p.x - geometry.origin.x) / geometry.resolution_m - 0.5;
    const double v = (p.y - geometry.origin.y) / geometry.resolution_m - 0.5;
    const double u_floor = std::floor(u);
    const double v_floor = std::floor(v);
    if (!(u_floor >= 0.0 && v_floor >= 0.0 && u_floor + 1.0 < geometry.width &&
          v_floor + 1.0 < geometry.height))
      return outside_m;
    const int column = static_cast<int>(u_floor);
    const int row = static_cast<int>(v_floor);
    const auto first = static_cast<std::size_t>(row * geometry.width + column);
    const auto above = first + static_cast<std::size_t>(geometry.width);
    const double a = u - u_floor;
    const double b = v - v_floor;
    const auto value = [this](std::size_t node) { return static_cast<double>(distance_m[node]); };
    return (1.0 - b) * ((1.0 - a) * value(first) + a * value(first + 1)) +
           b * ((1.0 - a) * value(above) + a * value(above + 1));
  }
};

[[nodiscard]] DistanceField distanceField(const OccupancyGrid& grid);

}  // namespace kr3::navigation
