#pragma once

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "kr3_navigation/laser_scan.hpp"
#include "kr3_navigation/occupancy_grid.hpp"

namespace kr3::navigation
{

/// Solid boxes and an exact laser, for tests.
struct SyntheticWorld
{
  std::vector<Rectangle> boxes;

  /// Two rooms of 4 m x 4 m side by side, a door of 1 m at (4, 2), a table in the left one. Walls
  /// are 0.1 m thick.
  static SyntheticWorld twoRooms()
  {
    return {{{-0.1, -0.1, 8.1, 0.0},
             {-0.1, 4.0, 8.1, 4.1},
             {-0.1, -0.1, 0.0, 4.1},
             {8.0, -0.1, 8.1, 4.1},
             {3.95, 0.0, 4.05, 1.5},
             {3.95, 2.5, 4.05, 4.0},
             {0.6, 0.5, 1.8, 1.1}}};
  }

  [[nodiscard]] double cast(Point from, double angle_rad) const
  {
    const double dx = std::cos(angle_rad);
    const double dy = std::sin(angle_rad);
    double nearest = std::numeric_limits<double>::infinity();
    for (const Rectangle& box : boxes)
    {
      double enter = 0.0;
      double leave = nearest;
      const auto clip = [&](double origin, double direction, double low, double high) {
        if (std::abs(direction) < 1e-12)
        {
          if (origin < low || origin > high)
            leave = -1.0;
          return;
        }
        const double a = (low - origin) / direction;
        const double b = (high - origin) / direction;
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
      };
      clip(from.x, dx, box.x_min, box.x_max);
      clip(from.y, dy, box.y_min, box.y_max);
      if (enter <= leave)
        nearest = std::min(nearest, enter);
    }
    return nearest;
  }

  [[nodiscard]] LaserScan scan(const Pose& pose, std::mt19937_64& random,
                               double noise_m = 0.01) const
  {
    constexpr std::size_t kBeams = 360;
    LaserScan scan{0.0, 2.0 * M_PI / kBeams, 0.1, 12.0, {}};
    std::normal_distribution<double> noise(0.0, noise_m);
    for (std::size_t beam = 0; beam < kBeams; ++beam)
    {
      const double range = cast(pose.position(), pose.yaw + scan.angle(beam)) + noise(random);
      scan.ranges_m.push_back(
          static_cast<float>(range < 12.0 ? range : std::numeric_limits<double>::infinity()));
    }
    return scan;
  }

  /// The exact map over `area`: a node is occupied when its centre is inside a box.
  [[nodiscard]] OccupancyGrid grid(const Rectangle& area, double resolution_m = 0.1) const
  {
    OccupancyGrid grid;
    grid.geometry = {resolution_m,
                     {area.x_min, area.y_min},
                     static_cast<int>(std::lround(area.width() / resolution_m)),
                     static_cast<int>(std::lround(area.height() / resolution_m))};
    grid.nodes.assign(grid.geometry.size(), Occupancy::kFree);
    for (std::size_t node = 0; node < grid.nodes.size(); ++node)
    {
      for (const Rectangle& box : boxes)
      {
        if (box.contains(grid.geometry.center(static_cast<int>(node))))
          grid.nodes[node] = Occupancy::kOccupied;
      }
    }
    return grid;
  }
};

constexpr Rectangle kTwoRoomsArea{-0.2, -0.2, 8.2, 4.2};

}  // namespace kr3::navigation
