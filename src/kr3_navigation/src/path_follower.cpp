#include "kr3_navigation/path_follower.hpp"

#include <cassert>

namespace kr3::navigation
{
namespace
{

constexpr double kTurnOnSpot = 0.9;      // rad: a target farther aside is turned to first
constexpr double kApproachGain = 0.8;    // 1/s: speed per metre left
constexpr double kApproachSpeed = 0.06;  // m/s at the end of the path

double approach(double wanted, double current, double step)
{
  return current + std::clamp(wanted - current, -step, step);
}

}  // namespace

Velocity limited(const Velocity& wanted, const Velocity& current, double period_s,
                 const MotionLimits& limits)
{
  const double linear = std::clamp(wanted.linear, -limits.max_linear, limits.max_linear);
  const double angular = std::clamp(wanted.angular, -limits.max_angular, limits.max_angular);
  return {approach(linear, current.linear, limits.linear_acceleration * period_s),
          approach(angular, current.angular, limits.angular_acceleration * period_s)};
}

PathFollower::PathFollower(std::vector<Point> path, const MotionLimits& limits)
  : path_(std::move(path)), to_end_(path_.size(), 0.0), limits_(limits)
{
  assert(!path_.empty());
  for (std::size_t i = path_.size() - 1; i > 0; --i)
    to_end_[i - 1] = to_end_[i] + distance(path_[i - 1], path_[i]);
}

Velocity PathFollower::follow(const Pose& pose, const PathPlanner& planner, double look_ahead_m)
{
  const Point here = pose.position();
  while (next_ + 1 < path_.size() && distance(here, path_[next_]) < look_ahead_m &&
         (distance(here, path_[next_]) < planner.geometry().resolution_m || !planner.isFree(here) ||
          planner.isSegmentFree(here, path_[next_ + 1])))
    ++next_;

  const Point target = inverse(pose) * path_[next_];
  const double away = std::hypot(target.x, target.y);
  const double bearing = std::atan2(target.y, target.x);
  if (std::abs(bearing) > kTurnOnSpot)
    return {0.0, bearing > 0.0 ? limits_.max_angular : -limits_.max_angular};

  double linear = std::min(limits_.max_linear, kApproachSpeed + kApproachGain * remaining(pose));
  double angular = 2.0 * linear * std::sin(bearing) / std::max(away, 0.15);
  if (std::abs(angular) > limits_.max_angular)
  {
    linear *= limits_.max_angular / std::abs(angular);
    angular = std::clamp(angular, -limits_.max_angular, limits_.max_angular);
  }
  return {linear, angular};
}

double PathFollower::remaining(const Pose& pose) const
{
  return distance(pose.position(), path_[next_]) + to_end_[next_];
}

bool PathFollower::isFree(const PathPlanner& planner) const
{
  for (std::size_t i = next_; i < path_.size(); ++i)
  {
    if (!planner.isFree(path_[i]))
      return false;
  }
  return true;
}

bool PathFollower::keepsClear(const PathPlanner& planner, double clearance_m) const
{
  for (std::size_t i = next_; i < path_.size(); ++i)
  {
    if (planner.clearance(path_[i]) < clearance_m)
      return false;
  }
  return true;
}

double freeDistance(const Velocity& velocity, const std::vector<Point>& obstacles_base,
                    double robot_radius_m, double horizon_m)
{
  if (std::abs(velocity.linear) < 1e-3)
    return horizon_m;             // a disc may turn on the spot
  constexpr double kStep = 0.04;  // m
  const double curvature = velocity.angular / velocity.linear;
  const double direction = velocity.linear > 0.0 ? 1.0 : -1.0;
  for (double driven = kStep; driven <= horizon_m + 1e-9; driven += kStep)
  {
    const double angle = curvature * driven * direction;
    const Point center = std::abs(curvature) < 1e-6 ? Point{driven * direction, 0.0}
                                                    : Point{std::sin(angle) / curvature,
                                                            (1.0 - std::cos(angle)) / curvature};
    for (const Point& obstacle : obstacles_base)
    {
      const double away = distance(obstacle, center);
      if (away < robot_radius_m && away < std::hypot(obstacle.x, obstacle.y) - 1e-3)
        return driven - kStep;
    }
  }
  return horizon_m;
}

}  // namespace kr3::navigation
