#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace kr3::executive::skills
{

/// m, in the plane of the floor.
struct Point
{
  double x = 0.0;
  double y = 0.0;
};

/// m and rad, in the plane of the floor.
struct Pose
{
  double x = 0.0;
  double y = 0.0;
  double yaw = 0.0;

  [[nodiscard]] Point point() const { return {x, y}; }
};

[[nodiscard]] double distance(const Point& a, const Point& b);

/// Direction from `a` to `b`, rad.
[[nodiscard]] double bearing(const Point& a, const Point& b);

/// The same angle in (-pi, pi].
[[nodiscard]] double wrapped(double angle_rad);

/// Headings that together see all round: the first is `start_rad`, the rest go on in one direction.
///
/// @param view_rad     horizontal angle of view of the camera, > 0
/// @param overlap_rad  by which neighbouring views overlap, so that nothing is cut in two; in [0,
/// view_rad)
/// @throws InvalidArgument  out of these ranges
[[nodiscard]] std::vector<double> lookHeadings(double start_rad, double view_rad,
                                               double overlap_rad);

/// Distance from the robot to something seen, bounded by what carries it: an object whose centre is
/// above the laser's plane stands on a piece of furniture that the laser sees in the same
/// direction, so it is not nearer than the furniture's front, nor farther than its depth behind.
///
/// @param by_size_m    range from the apparent size
/// @param by_laser_m   range of the laser's beam in the same direction; infinite or 0 when there is
/// none
/// @param max_depth_m  depth of furniture
[[nodiscard]] double boundedRange(double by_size_m, double by_laser_m, double max_depth_m);

/// How far a round robot can drive straight on before it touches a point.
///
/// @param points_base  m, obstacles in the robot's frame (x forward)
/// @param forward      false: backwards
/// @return m, >= 0, infinite when nothing is in the way
[[nodiscard]] double freeDistance(const std::vector<Point>& points_base, double robot_radius_m,
                                  bool forward);

/// An occupancy grid, axis-aligned in the map frame.
class Grid
{
public:
  /// @param values  row-major from the origin, x fastest, shape [height, width]: -1 unknown, 0 free
  /// ... 100 occupied
  /// @throws InvalidArgument  shapes that do not fit, or a resolution that is not positive
  Grid(Point origin, double resolution_m, int width, int height, std::vector<std::int8_t> values);

  /// Whether a disc is free: every cell it touches is known and free. Outside the grid nothing is
  /// known.
  [[nodiscard]] bool isFree(const Point& centre, double radius_m) const;

private:
  Point origin_;
  double resolution_m_;
  int width_;
  int height_;
  std::vector<std::int8_t> values_;
};

}  // namespace kr3::executive::skills
