#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kr3_navigation/path_follower.hpp"

namespace kr3::navigation
{

struct DriverOptions
{
  MotionLimits limits;
  double robot_radius_m = 0.24;
  double stop_distance_m = 0.3;        ///< how far ahead of the robot's disc obstacles slow it down
  double stop_margin_m = 0.05;         ///< nearer than this ahead, it stands still
  double side_margin_m = 0.02;         ///< to what it passes: noise of the laser, and of the wheels
  double position_tolerance_m = 0.06;  ///< of the pose estimate; at most 0.12
  double yaw_tolerance_rad = 0.05;
  double blocked_wait_s = 1.0;   ///< before it looks for another way
  double stall_time_s = 8.0;     ///< without getting nearer before it looks for another way
  double contact_reach_m = 0.1;  ///< beyond the robot's disc, where it takes what it touched to be
  int max_replans = 8;           ///< without getting nearer before it gives up
};

struct DriveGoal
{
  Point position;                 ///< map frame
  std::optional<double> yaw_rad;  ///< heading at the end, if it matters
};

enum class DrivePhase
{
  kIdle,
  kPlanning,
  kDriving,
  kTurning,     ///< at the place, to the goal's heading
  kBlocked,     ///< waits for an obstacle to leave
  kBackingOff,  ///< from something that it touched without having seen it
  kArrived,
  kUnreachable,
};
[[nodiscard]] const char* toString(DrivePhase phase);

/// What the driver knows at one moment.
struct DriveInput
{
  double time_s;               ///< ascending
  Pose pose;                   ///< of the robot, map frame
  const PathPlanner& planner;  ///< on the present map
  const std::vector<Point>&
      obstacles_base;  ///< hits of the latest scan in the robot's present frame
  bool map_changed;    ///< since the last step
  /// The map that `planner` plans in, for a closer look at narrow gaps; nullptr: no closer look.
  const OccupancyGrid* grid = nullptr;
  bool slipped = false;  ///< the wheels turned and the robot did not move, since the last step
};

/// Takes the robot to a goal: plans, follows, stops for obstacles, plans again; where the map's
/// nodes are too coarse to tell whether it fits through, by what the laser sees there now. When the
/// wheels push and the robot does not move, it has touched what the laser does not see: it tells
/// the point, backs off and plans again. One goal
/// at a time; a new one replaces the old. Decisions depend on the inputs only, never on a clock.
/// Not thread-safe.
class Driver
{
public:
  explicit Driver(const DriverOptions& options) : options_(options) {}

  void start(const DriveGoal& goal);
  /// Changes the goal on the way, keeping speed and count of attempts. Only while active.
  void redirect(const DriveGoal& goal);
  /// Forgets the goal. The caller stops the wheels.
  void cancel();

  /// The velocity for the next moment. Zero once the goal is reached or given up.
  [[nodiscard]] Velocity step(const DriveInput& input);

  /// Whether, since the last call, no path was found from the start: obstacles remembered from
  /// earlier should be forgotten before it tries once more.
  [[nodiscard]] bool takeFreshMapRequest();

  /// Where the robot touched something since the last call, map frame: just ahead of its disc. The
  /// caller marks it in the map, so that the next plan leads round it.
  [[nodiscard]] std::optional<Point> takeContact();

  [[nodiscard]] DrivePhase phase() const { return phase_; }
  [[nodiscard]] bool isActive() const
  {
    return phase_ != DrivePhase::kIdle && phase_ != DrivePhase::kArrived &&
           phase_ != DrivePhase::kUnreachable;
  }
  [[nodiscard]] const DriveGoal& goal() const { return goal_; }
  /// Why the goal was given up; empty otherwise.
  [[nodiscard]] const std::string& reason() const { return reason_; }
  /// The path being followed; empty without one.
  [[nodiscard]] const std::vector<Point>& path() const;
  /// Changes whenever path() does.
  [[nodiscard]] int numPlans() const { return num_plans_; }
  /// Share of the way done, [0, 1].
  [[nodiscard]] double progress() const { return progress_; }

private:
  void plan(const DriveInput& input);
  [[nodiscard]] PlannedPath findPath(const DriveInput& input);
  void lookCloser(const DriveInput& input);
  void followMapChange(const DriveInput& input);
  void giveUp(const std::string& reason);
  [[nodiscard]] Velocity drive(const DriveInput& input);
  [[nodiscard]] Velocity turn(const DriveInput& input) const;
  [[nodiscard]] Velocity backOff(const DriveInput& input);
  /// Whether the robot hardly moved while its wheels were told to drive forward.
  [[nodiscard]] bool isStuck(const DriveInput& input, double period_s);
  void noteProgress(const DriveInput& input, double remaining_m);
  void arrive();

  DriverOptions options_;
  DrivePhase phase_ = DrivePhase::kIdle;
  DriveGoal goal_;
  std::string reason_;
  std::optional<PathFollower> follower_;
  std::optional<PathPlanner> close_planner_;  ///< while the path leads through a narrow gap
  Velocity current_;
  std::optional<double> last_time_s_;
  double blocked_since_s_ = 0.0;
  double nearest_remaining_m_ = 0.0;
  double nearest_time_s_ = 0.0;
  double first_remaining_m_ = 0.0;
  double progress_ = 0.0;
  int replans_ = 0;
  int num_plans_ = 0;
  bool wants_fresh_map_ = false;
  std::optional<Point> contact_;
  Point moved_from_;          ///< where the robot was when commanded_m_ was zero
  double commanded_m_ = 0.0;  ///< forward, since then
  Point touched_at_;          ///< where the robot was when it began to back off
  double touched_time_s_ = 0.0;
};

}  // namespace kr3::navigation
