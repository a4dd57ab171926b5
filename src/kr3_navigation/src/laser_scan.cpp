#include "kr3_navigation/laser_scan.hpp"

#include <string>

#include <kr3_common/error.hpp>

namespace kr3::navigation
{

void check(const LaserScan& scan)
{
  constexpr std::size_t kMaxBeams = 100000;
  constexpr double kRounding = 1.01;
  if (scan.ranges_m.empty() || scan.ranges_m.size() > kMaxBeams)
    throw InvalidArgument("a scan with " + std::to_string(scan.ranges_m.size()) +
                          " beams, expected 1 to " + std::to_string(kMaxBeams));
  if (!std::isfinite(scan.angle_min_rad) || !std::isfinite(scan.angle_increment_rad) ||
      scan.angle_increment_rad == 0.0)
    throw InvalidArgument("a scan from " + std::to_string(scan.angle_min_rad) +
                          " rad in steps of " + std::to_string(scan.angle_increment_rad) +
                          " rad, expected finite angles and a step other than 0");
  const double turn =
      std::abs(scan.angle_increment_rad) * static_cast<double>(scan.ranges_m.size() - 1);
  if (turn > 2.0 * M_PI * kRounding)
    throw InvalidArgument(std::to_string(scan.ranges_m.size()) + " beams in steps of " +
                          std::to_string(scan.angle_increment_rad) +
                          " rad are more than a full turn");
  if (!(scan.range_min_m >= 0.0 && scan.range_min_m < scan.range_max_m))
    throw InvalidArgument("ranges from " + std::to_string(scan.range_min_m) + " m to " +
                          std::to_string(scan.range_max_m) +
                          " m, expected 0 <= range_min < range_max");
}

std::vector<Point> hitPoints(const LaserScan& scan, const Pose& T_base_laser)
{
  std::vector<Point> points;
  points.reserve(scan.ranges_m.size());
  for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam)
  {
    if (scan.isHit(beam))
      points.push_back(T_base_laser * scan.endpoint(beam));
  }
  return points;
}

}  // namespace kr3::navigation
