#pragma once

#include <vector>

#include "kr3_navigation/geometry.hpp"

namespace kr3::navigation
{

/// One sweep of a horizontal 2D laser. Beam k points at angle_min_rad + k * angle_increment_rad in
/// the laser's frame.
struct LaserScan
{
  double angle_min_rad = 0.0;
  double angle_increment_rad = 0.0;
  double range_min_m = 0.0;
  double range_max_m = 0.0;
  std::vector<float> ranges_m;  ///< no return: +inf; invalid: NaN

  [[nodiscard]] double angle(std::size_t beam) const
  {
    return angle_min_rad + static_cast<double>(beam) * angle_increment_rad;
  }
  /// Whether the beam hit something within the laser's range.
  [[nodiscard]] bool isHit(std::size_t beam) const
  {
    const auto range = static_cast<double>(ranges_m[beam]);
    return std::isfinite(range) && range >= range_min_m && range < range_max_m;
  }
  /// The point hit, in the laser's frame. Only for beams with isHit().
  [[nodiscard]] Point endpoint(std::size_t beam) const
  {
    const auto range = static_cast<double>(ranges_m[beam]);
    return {range * std::cos(angle(beam)), range * std::sin(angle(beam))};
  }
};

/// @throws InvalidArgument  angles or limits of range are not finite, no beam or more than 100 000,
/// an angle step of 0, or beams over more than a full turn. Single ranges may be anything: what is
/// no hit is ignored.
void check(const LaserScan& scan);

/// Where the laser sits on the robot.
struct LaserMount
{
  Pose T_base_laser;
  double height_m = 0.0;  ///< of the scan plane above the floor
};

/// The points hit, in the robot's frame.
[[nodiscard]] std::vector<Point> hitPoints(const LaserScan& scan, const Pose& T_base_laser);

}  // namespace kr3::navigation
