#include "kr3_executive/skills_geometry.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <kr3_common/error.hpp>

namespace kr3::executive::skills
{

double distance(const Point& a, const Point& b)
{
  return std::hypot(b.x - a.x, b.y - a.y);
}

double bearing(const Point& a, const Point& b)
{
  return std::atan2(b.y - a.y, b.x - a.x);
}

double wrapped(double angle_rad)
{
  const double angle = std::remainder(angle_rad, 2.0 * M_PI);
  return angle <= -M_PI ? M_PI : angle;
}

std::vector<double> lookHeadings(double start_rad, double view_rad, double overlap_rad)
{
  if (!(view_rad > 0.0) || !(overlap_rad >= 0.0 && overlap_rad < view_rad))
    throw InvalidArgument("angle of view " + std::to_string(view_rad) + " rad with overlap " +
                          std::to_string(overlap_rad) + " rad, expected 0 <= overlap < view");
  const int count = std::max(1, static_cast<int>(std::ceil(2.0 * M_PI / (view_rad - overlap_rad))));
  std::vector<double> headings;
  for (int i = 0; i < count; ++i)
    headings.push_back(wrapped(start_rad + i * 2.0 * M_PI / count));
  return headings;
}

double boundedRange(double by_size_m, double by_laser_m, double max_depth_m)
{
  if (!std::isfinite(by_laser_m) || by_laser_m <= 0.0)
    return by_size_m;
  return std::clamp(by_size_m, by_laser_m, by_laser_m + max_depth_m);
}

double freeDistance(const std::vector<Point>& points_base, double robot_radius_m, bool forward)
{
  double nearest = std::numeric_limits<double>::infinity();
  for (const Point& point : points_base)
  {
    const double ahead = forward ? point.x : -point.x;
    if (std::abs(point.y) >= robot_radius_m || ahead <= 0.0)
      continue;
    const double body = std::sqrt(robot_radius_m * robot_radius_m -
                                  point.y * point.y);  // of the robot on that line
    nearest = std::min(nearest, std::max(0.0, ahead - body));
  }
  return nearest;
}

Grid::Grid(Point origin, double resolution_m, int width, int height,
           std::vector<std::int8_t> values)
  : origin_(origin)
  , resolution_m_(resolution_m)
  , width_(width)
  , height_(height)
  , values_(std::move(values))
{
  if (!(resolution_m > 0.0) || width < 0 || height < 0 ||
      values_.size() != static_cast<std::size_t>(width) * static_cast<std::size_t>(height))
    throw InvalidArgument("grid of " + std::to_string(width) + " x " + std::to_string(height) +
                          " cells of " + std::to_string(resolution_m) + " m with " +
                          std::to_string(values_.size()) + " values");
}

bool Grid::isFree(const Point& centre, double radius_m) const
{
  constexpr int kOccupied = 50;
  const auto index = [&](double value, double origin) {
    return static_cast<int>(std::floor((value - origin) / resolution_m_));
  };
  for (int row = index(centre.y - radius_m, origin_.y);
       row <= index(centre.y + radius_m, origin_.y); ++row)
    for (int column = index(centre.x - radius_m, origin_.x);
         column <= index(centre.x + radius_m, origin_.x); ++column)
    {
      // Nearest point of the grid cell to the centre of the disc.
      const double x = origin_.x + column * resolution_m_;
      const double y = origin_.y + row * resolution_m_;
      const Point nearest{std::clamp(centre.x, x, x + resolution_m_),
                          std::clamp(centre.y, y, y + resolution_m_)};
      if (distance(nearest, centre) > radius_m)
        continue;
      if (column < 0 || row < 0 || column >= width_ || row >= height_)
        return false;
      const std::int8_t value =
          values_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
                  static_cast<std::size_t>(column)];
      if (value < 0 || value >= kOccupied)
        return false;
    }
  return true;
}

}  // namespace kr3::executive::skills
