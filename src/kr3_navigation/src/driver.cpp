#include "kr3_navigation/driver.hpp"

#include <cmath>
#include <limits>
#include <utility>

namespace kr3::navigation
{
namespace
{

constexpr double kStill = 0.02;          // m/s
constexpr double kStillTurning = 0.05;   // rad/s
constexpr double kProgress = 0.05;       // m: what counts as getting nearer
constexpr double kReaction = 0.15;       // s: age of a scan and of the last command
constexpr double kCloseRange = 8.0;      // m: how far hits count for a closer look
constexpr double kCloseLookAhead = 0.2;  // m
constexpr double kCloseSpeed = 0.25;     // m/s
constexpr double kPush = 0.25;           // m: told to drive that far and moved less than the share
constexpr double kStuckShare = 0.3;      // below, it is stuck
constexpr double kBackOff = 0.15;        // m
constexpr double kBackOffSpeed = 0.15;   // m/s
constexpr double kBackOffTime = 3.0;     // s, at most
constexpr double kMaxPeriod = 0.2;       // s: a longer gap between steps counts as this

}  // namespace

const char* toString(DrivePhase phase)
{
  switch (phase)
  {
    case DrivePhase::kIdle:
      return "idle";
    case DrivePhase::kPlanning:
      return "planning";
    case DrivePhase::kDriving:
      return "driving";
    case DrivePhase::kTurning:
      return "turning";
    case DrivePhase::kBlocked:
      return "blocked";
    case DrivePhase::kBackingOff:
      return "backing off";
    case DrivePhase::kArrived:
      return "arrived";
    case DrivePhase::kUnreachable:
      return "unreachable";
  }
  return "?";
}

void Driver::start(const DriveGoal& goal)
{
  goal_ = goal;
  phase_ = DrivePhase::kPlanning;
  reason_.clear();
  follower_.reset();
  close_planner_.reset();
  nearest_remaining_m_ = std::numeric_limits<double>::infinity();
  progress_ = 0.0;
  replans_ = 0;
  wants_fresh_map_ = false;
  contact_.reset();
  commanded_m_ = 0.0;
}

void Driver::redirect(const DriveGoal& goal)
{
  goal_ = goal;
  if (phase_ != DrivePhase::kBlocked && phase_ != DrivePhase::kBackingOff)
    phase_ = DrivePhase::kPlanning;
}

std::optional<Point> Driver::takeContact()
{
  return std::exchange(contact_, std::nullopt);
}

bool Driver::takeFreshMapRequest()
{
  return std::exchange(wants_fresh_map_, false);
}

void Driver::cancel()
{
  phase_ = DrivePhase::kIdle;
  follower_.reset();
  close_planner_.reset();
  current_ = Velocity{};
  last_time_s_.reset();
}

const std::vector<Point>& Driver::path() const
{
  static const std::vector<Point> kNone;
  return follower_ ? follower_->path() : kNone;
}

void Driver::giveUp(const std::string& reason)
{
  cancel();
  phase_ = DrivePhase::kUnreachable;
  reason_ = reason;
}

void Driver::arrive()
{
  cancel();
  phase_ = DrivePhase::kArrived;
  progress_ = 1.0;
}

void Driver::lookCloser(const DriveInput& input)
{
  std::vector<Point> hits;
  for (const Point& obstacle : input.obstacles_base)
  {
    if (std::hypot(obstacle.x, obstacle.y) < kCloseRange)
      hits.push_back(input.pose * obstacle);
  }
  close_planner_.emplace(*input.grid, input.planner.options(), hits);
}

PlannedPath Driver::findPath(const DriveInput& input)
{
  const Point here = input.pose.position();
  // Stopped before something: the map's nodes showed a way there that the laser does not.
  const bool stopped = phase_ == DrivePhase::kBlocked && follower_.has_value();
  close_planner_.reset();
  PlannedPath path;
  if (!stopped || input.grid == nullptr)
    path = input.planner.plan(here, goal_.position);
  if (path.found() || input.grid == nullptr)
    return path;
  lookCloser(input);
  PlannedPath close_path = close_planner_->plan(here, goal_.position);
  if (close_path.found())
    return close_path;
  close_planner_.reset();
  return stopped ? close_path : path;
}

void Driver::followMapChange(const DriveInput& input)
{
  // Through the gap: the map alone will do again.
  if (close_planner_ && input.planner.isFree(input.pose.position()) &&
      follower_->isFree(input.planner))
    close_planner_.reset();
  if (close_planner_)
    lookCloser(input);
  // Hits differ by a centimetre from scan to scan: what was wide enough is not planned again for
  // that.
  const bool is_free =
      close_planner_
          ? follower_->keepsClear(*close_planner_, options_.robot_radius_m + options_.side_margin_m)
          : follower_->isFree(input.planner);
  if (!is_free)
    plan(input);
}

void Driver::plan(const DriveInput& input)
{
  const bool under_way = follower_.has_value();
  const PlannedPath path = findPath(input);
  if (!path.found())
  {
    // What blocks the way may have left since it was seen, or be a passer-by.
    const int patience = under_way ? options_.max_replans : 1;
    if (++replans_ > patience || !input.planner.geometry().contains(goal_.position))
    {
      giveUp(path.reason);
      return;
    }
    wants_fresh_map_ = !under_way;
    phase_ = DrivePhase::kBlocked;
    blocked_since_s_ = input.time_s;
    return;
  }
  follower_.emplace(path.points, options_.limits);
  ++num_plans_;
  if (!under_way)
  {
    replans_ = 0;
    first_remaining_m_ = path.length_m;
    nearest_remaining_m_ = path.length_m;
    nearest_time_s_ = input.time_s;
  }
  else if (++replans_ > options_.max_replans)
  {
    giveUp("gave up " + std::to_string(path.length_m).substr(0, 4) + " m before the goal after " +
           std::to_string(options_.max_replans) + " attempts to get around obstacles");
    return;
  }
  phase_ = DrivePhase::kDriving;
}

void Driver::noteProgress(const DriveInput& input, double remaining_m)
{
  if (remaining_m < nearest_remaining_m_ - kProgress)
  {
    nearest_remaining_m_ = remaining_m;
    nearest_time_s_ = input.time_s;
    replans_ = 0;
  }
  if (first_remaining_m_ > 0.0)
    progress_ = std::clamp(1.0 - remaining_m / first_remaining_m_, progress_, 1.0);
}

Velocity Driver::step(const DriveInput& input)
{
  const double period =
      last_time_s_ ? std::clamp(input.time_s - *last_time_s_, 0.0, kMaxPeriod) : 0.0;
  if (last_time_s_ && input.time_s < *last_time_s_)  // the clock started again
    blocked_since_s_ = nearest_time_s_ = touched_time_s_ = input.time_s;
  last_time_s_ = input.time_s;
  if (isStuck(input, period))
  {
    const Point ahead{options_.robot_radius_m + options_.contact_reach_m, 0.0};
    contact_ = input.pose * ahead;
    touched_at_ = input.pose.position();
    touched_time_s_ = input.time_s;
    phase_ = DrivePhase::kBackingOff;
    current_.linear = std::min(current_.linear, 0.0);
  }

  if (phase_ == DrivePhase::kPlanning)
    plan(input);
  else if (phase_ == DrivePhase::kBlocked &&
           input.time_s - blocked_since_s_ >= options_.blocked_wait_s)
    plan(input);
  else if (phase_ == DrivePhase::kDriving && input.map_changed)
    followMapChange(input);
  else if (phase_ == DrivePhase::kDriving && input.time_s - nearest_time_s_ > options_.stall_time_s)
  {
    nearest_time_s_ = input.time_s;
    plan(input);
  }

  Velocity wanted;
  if (phase_ == DrivePhase::kDriving)
    wanted = drive(input);
  if (phase_ == DrivePhase::kTurning)
    wanted = turn(input);
  if (phase_ == DrivePhase::kBackingOff)
    wanted = backOff(input);
  if (!isActive())
    return Velocity{};
  current_ = limited(wanted, current_, period, options_.limits);

  const bool still =
      std::abs(current_.linear) < kStill && std::abs(current_.angular) < kStillTurning;
  if (phase_ == DrivePhase::kTurning && still &&
      std::abs(wrapAngle(*goal_.yaw_rad - input.pose.yaw)) < options_.yaw_tolerance_rad)
    arrive();
  return isActive() ? current_ : Velocity{};
}

Velocity Driver::drive(const DriveInput& input)
{
  const double remaining = follower_->remaining(input.pose);
  noteProgress(input, remaining);
  if (distance(input.pose.position(), goal_.position) < options_.position_tolerance_m)
  {
    if (goal_.yaw_rad)
      phase_ = DrivePhase::kTurning;
    else if (std::abs(current_.linear) < 0.1)
      arrive();
    return {};
  }
  Velocity wanted = close_planner_ ? follower_->follow(input.pose, *close_planner_, kCloseLookAhead)
                                   : follower_->follow(input.pose, input.planner);
  if (close_planner_ && wanted.linear > kCloseSpeed)
  {
    wanted.angular *= kCloseSpeed / wanted.linear;
    wanted.linear = kCloseSpeed;
  }
  // Slow down so that the robot can stand still before an obstacle ahead.
  const double reach = options_.stop_margin_m + options_.stop_distance_m;
  const double ahead = freeDistance(wanted, input.obstacles_base,
                                    options_.robot_radius_m + options_.side_margin_m, reach);
  if (ahead < reach)
  {
    const double a = options_.limits.linear_acceleration;
    const double room = std::max(0.0, ahead - options_.stop_margin_m);
    const double allowed = a * (std::sqrt(kReaction * kReaction + 2.0 * room / a) - kReaction);
    if (allowed < wanted.linear)
    {
      wanted.angular *= allowed / wanted.linear;
      wanted.linear = allowed;
    }
    if (allowed < kStill)
    {
      phase_ = DrivePhase::kBlocked;
      blocked_since_s_ = input.time_s;
      current_.linear = 0.0;  // an emergency knows no comfortable deceleration
      return {};
    }
  }
  return wanted;
}

bool Driver::isStuck(const DriveInput& input, double period_s)
{
  const Point here = input.pose.position();
  if (phase_ != DrivePhase::kDriving || commanded_m_ == 0.0)
    moved_from_ = here;
  commanded_m_ = phase_ == DrivePhase::kDriving
                     ? commanded_m_ + std::max(0.0, current_.linear) * period_s
                     : 0.0;
  if (input.slipped && commanded_m_ > 0.0)
  {
    commanded_m_ = 0.0;
    return true;
  }
  if (commanded_m_ < kPush)
    return false;
  const bool stood = distance(here, moved_from_) < kStuckShare * commanded_m_;
  commanded_m_ = 0.0;
  return stood;
}

Velocity Driver::backOff(const DriveInput& input)
{
  const Velocity back{-kBackOffSpeed, 0.0};
  const double room = freeDistance(back, input.obstacles_base, options_.robot_radius_m, kBackOff);
  if (room >= kBackOff / 2.0 && distance(input.pose.position(), touched_at_) < kBackOff &&
      input.time_s - touched_time_s_ < kBackOffTime)
    return back;
  plan(input);
  return {};
}

Velocity Driver::turn(const DriveInput& input) const
{
  const double error = wrapAngle(*goal_.yaw_rad - input.pose.yaw);
  if (std::abs(error) < options_.yaw_tolerance_rad / 2.0)
    return {};
  // The speed from which it can just stop in time.
  const double speed =
      std::min({options_.limits.max_angular, 1.5 * std::abs(error) + 0.05,
                std::sqrt(options_.limits.angular_acceleration * std::abs(error))});
  return {0.0, std::copysign(speed, error)};
}

}  // namespace kr3::navigation
