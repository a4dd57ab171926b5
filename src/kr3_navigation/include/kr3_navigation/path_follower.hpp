#pragma once

#include <vector>

#include "kr3_navigation/path_planner.hpp"

namespace kr3::navigation
{

/// What the wheels shall do: m/s forward, rad/s counter-clockwise.
struct Velocity
{
  double linear = 0.0;
  double angular = 0.0;
};

struct MotionLimits
{
  double max_linear = 0.5;            ///< m/s
  double max_angular = 1.2;           ///< rad/s
  double linear_acceleration = 0.8;   ///< m/s^2
  double angular_acceleration = 3.0;  ///< rad/s^2
};

/// `wanted`, as near as the accelerations allow within `period_s`.
[[nodiscard]] Velocity limited(const Velocity& wanted, const Velocity& current, double period_s,
                               const MotionLimits& limits);

/// Pure pursuit along a path: aims at the farthest path point within the look-ahead that can be
/// reached straight. Source: Coulter, "Implementation of the Pure Pursuit Path Tracking Algorithm"
/// (1992); turning on the spot towards a target that lies aside is ours.
class PathFollower
{
public:
  PathFollower(std::vector<Point> path, const MotionLimits& limits);

  static constexpr double kLookAhead = 0.45;  ///< m

  /// The velocity towards the end of the path, not yet limited in acceleration.
  /// @param look_ahead_m  how far ahead it aims: less keeps nearer to the path
  [[nodiscard]] Velocity follow(const Pose& pose, const PathPlanner& planner,
                                double look_ahead_m = kLookAhead);

  /// Length of the path from the point aimed at to its end, plus the way to that point, m.
  [[nodiscard]] double remaining(const Pose& pose) const;
  /// Whether the rest of the path is still free.
  [[nodiscard]] bool isFree(const PathPlanner& planner) const;
  /// Whether the rest of the path keeps that distance to obstacles, m.
  [[nodiscard]] bool keepsClear(const PathPlanner& planner, double clearance_m) const;
  [[nodiscard]] const std::vector<Point>& path() const { return path_; }

private:
  std::vector<Point> path_;
  std::vector<double> to_end_;  // m, from each point along the path
  MotionLimits limits_;
  std::size_t next_ = 0;
};

/// How far the robot's disc can go along the arc of a velocity before it touches an obstacle, m of
/// path (for a turn on the spot: unlimited), at most `horizon_m`. Obstacles it already touches
/// count only when it gets nearer to them.
/// @param obstacles_base  hits of the latest scan in the robot's present frame
[[nodiscard]] double freeDistance(const Velocity& velocity,
                                  const std::vector<Point>& obstacles_base, double robot_radius_m,
                                  double horizon_m);

}  // namespace kr3::navigation
