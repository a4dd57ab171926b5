#include "kr3_navigation/laser_scan.hpp"

namespace kr3::navigation
{

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
