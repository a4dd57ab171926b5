#include "kr3_executive/skills_approach.hpp"

#include <algorithm>
#include <cmath>

#include <kr3_common/error.hpp>

namespace kr3::executive::skills
{
namespace
{

constexpr double kDistanceStep = 0.04;   // m
constexpr double kDistanceWeight = 4.0;  // metres of driving that a metre of discomfort is worth
constexpr double kTurnWeight = 0.3;      // m / rad

/// One in each direction at most, cheapest first.
std::vector<Pose> posesAt(const ApproachOptions& options, const Point& object_map,
                          const Pose& robot, const Grid& grid)
{
  struct Candidate
  {
    Pose pose;
    double cost = 0.0;
  };
  std::vector<Candidate> candidates;
  for (int i = 0; i < options.num_directions; ++i)
  {
    // Directions start where the robot is: when it is close already, it need not move.
    const double direction =
        bearing(object_map, robot.point()) + i * 2.0 * M_PI / options.num_directions;
    Candidate best;
    bool any = false;
    for (double d = options.min_distance_m; d <= options.max_distance_m + 1e-9; d += kDistanceStep)
    {
      const Point stand{object_map.x + d * std::cos(direction),
                        object_map.y + d * std::sin(direction)};
      if (!grid.isFree(stand, options.robot_radius_m + options.clearance_m))
        continue;
      const Pose pose{stand.x, stand.y, wrapped(direction + M_PI)};
      const double cost = distance(robot.point(), stand) +
                          kDistanceWeight * std::abs(d - options.best_distance_m) +
                          kTurnWeight * std::abs(wrapped(pose.yaw - robot.yaw));
      if (!any || cost < best.cost)
        best = {pose, cost};
      any = true;
    }
    if (any)
      candidates.push_back(best);
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.cost < b.cost; });
  std::vector<Pose> poses;
  for (const Candidate& candidate : candidates)
    poses.push_back(candidate.pose);
  return poses;
}

}  // namespace

std::vector<Pose> approachPoses(const Point& object_map, const Pose& robot, const Grid& grid,
                                const ApproachOptions& options)
{
  if (!(options.min_distance_m > 0.0 && options.min_distance_m <= options.best_distance_m &&
        options.best_distance_m <= options.max_distance_m) ||
      options.num_directions <= 0)
    throw InvalidArgument(
        "approach distances must satisfy 0 < min <= best <= max, with at least one direction");
  std::vector<Pose> poses = posesAt(options, object_map, robot, grid);
  ApproachOptions farther = options;
  farther.min_distance_m = farther.best_distance_m = options.max_distance_m;
  farther.max_distance_m = options.max_distance_m + options.creep_m;
  const std::vector<Pose> from_there = posesAt(farther, object_map, robot, grid);
  poses.insert(poses.end(), from_there.begin(), from_there.end());
  return poses;
}

}  // namespace kr3::executive::skills
