#pragma once

#include <algorithm>
#include <cmath>

namespace kr3::navigation
{

/// A position in the plane, m. The frame is in the variable's name.
struct Point
{
  double x = 0.0;
  double y = 0.0;
};

/// A planar pose: position in m, heading in rad (counter-clockwise from the x axis). As a transform
/// `T_a_b` it maps coordinates in b to coordinates in a.
struct Pose
{
  double x = 0.0;
  double y = 0.0;
  double yaw = 0.0;

  [[nodiscard]] Point position() const { return {x, y}; }
};

/// An axis-aligned rectangle, m. Valid when x_min < x_max and y_min < y_max.
struct Rectangle
{
  double x_min = 0.0;
  double y_min = 0.0;
  double x_max = 0.0;
  double y_max = 0.0;

  [[nodiscard]] double width() const { return x_max - x_min; }
  [[nodiscard]] double height() const { return y_max - y_min; }
  [[nodiscard]] Point center() const { return {(x_min + x_max) / 2.0, (y_min + y_max) / 2.0}; }
  [[nodiscard]] bool contains(Point p) const
  {
    return p.x >= x_min && p.x <= x_max && p.y >= y_min && p.y <= y_max;
  }
  /// m, 0 inside.
  [[nodiscard]] double distanceTo(Point p) const
  {
    return std::hypot(std::max({x_min - p.x, 0.0, p.x - x_max}),
                      std::max({y_min - p.y, 0.0, p.y - y_max}));
  }
  /// The rectangle moved inwards by `margin_m` on every side; empty (invalid) when it is too small
  /// for that.
  [[nodiscard]] Rectangle shrunk(double margin_m) const
  {
    return {x_min + margin_m, y_min + margin_m, x_max - margin_m, y_max - margin_m};
  }
};

[[nodiscard]] inline double distance(Point a, Point b)
{
  return std::hypot(a.x - b.x, a.y - b.y);
}

/// The same angle in (-pi, pi].
[[nodiscard]] inline double wrapAngle(double angle_rad)
{
  return std::atan2(std::sin(angle_rad), std::cos(angle_rad));
}

/// T_a_c = T_a_b * T_b_c.
[[nodiscard]] inline Pose operator*(const Pose& T_a_b, const Pose& T_b_c)
{
  const double c = std::cos(T_a_b.yaw);
  const double s = std::sin(T_a_b.yaw);
  return {T_a_b.x + c * T_b_c.x - s * T_b_c.y, T_a_b.y + s * T_b_c.x + c * T_b_c.y,
          wrapAngle(T_a_b.yaw + T_b_c.yaw)};
}

/// p_a = T_a_b * p_b.
[[nodiscard]] inline Point operator*(const Pose& T_a_b, Point p_b)
{
  const double c = std::cos(T_a_b.yaw);
  const double s = std::sin(T_a_b.yaw);
  return {T_a_b.x + c * p_b.x - s * p_b.y, T_a_b.y + s * p_b.x + c * p_b.y};
}

[[nodiscard]] inline Pose inverse(const Pose& T_a_b)
{
  const double c = std::cos(T_a_b.yaw);
  const double s = std::sin(T_a_b.yaw);
  return {-c * T_a_b.x - s * T_a_b.y, s * T_a_b.x - c * T_a_b.y, wrapAngle(-T_a_b.yaw)};
}

}  // namespace kr3::navigation
