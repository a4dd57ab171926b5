#include "kr3_navigation/navigator.hpp"

#include <cmath>
#include <utility>

#include <kr3_common/error.hpp>

#include "kr3_navigation/blocked_passage.hpp"

namespace kr3::navigation
{
namespace
{

constexpr std::size_t kMaxPending = 5;

constexpr double kFarthest = 1e6;    // m, from the origin: beyond it numbers lose centimetres
constexpr double kLostToSlip = 0.1;  // m of the way between two compared scans
constexpr double kMostTurns = 1e6;   // rad

void checkFinite(const char* what, double time_s, const Pose& pose)
{
  if (!std::isfinite(time_s) || !std::isfinite(pose.x) || !std::isfinite(pose.y) ||
      !std::isfinite(pose.yaw))
    throw InvalidArgument(std::string(what) + ": time or pose are not finite");
  if (std::abs(pose.x) > kFarthest || std::abs(pose.y) > kFarthest ||
      std::abs(pose.yaw) > kMostTurns)
    throw InvalidArgument(std::string(what) + ": the pose (" + std::to_string(pose.x) + ", " +
                          std::to_string(pose.y) + ") is more than 1000 km away");
}

}  // namespace

Navigator::Navigator(LiveMap map, PoseTracker tracker, const NavigatorOptions& options)
  : options_(options), map_(std::move(map)), tracker_(std::move(tracker))
{
  followGrowingMap();
}

void Navigator::followGrowingMap()
{
  if (!map_.isGiven() && tracker_.localises())
    tracker_.setGrowingField(map_.planner().field());
}

OdometryResult Navigator::addOdometry(double time_s, const Pose& T_odom_base)
{
  checkFinite("odometry", time_s, T_odom_base);
  const OdometryResult result = tracker_.addOdometry(time_s, T_odom_base);
  if (result == OdometryResult::kRestarted)
  {
    pending_.clear();
    obstacles_odom_.clear();
    slip_detector_.reset();
    scan_time_s_.reset();
  }
  processScans();
  return result;
}

void Navigator::addKnownPose(double time_s, const Pose& T_map_base)
{
  checkFinite("known pose", time_s, T_map_base);
  tracker_.addKnownPose(time_s, T_map_base);
  processScans();
}

void Navigator::addScan(double time_s, LaserScan scan, const LaserMount& mount)
{
  checkFinite("scan", time_s, mount.T_base_laser);
  check(scan);
  pending_.push_back({time_s, std::move(scan), mount});
  if (pending_.size() > kMaxPending)
  {
    pending_.pop_front();
    ++dropped_scans_;
  }
  processScans();
}

void Navigator::reset(const Pose& T_map_base, const PoseSpread& spread)
{
  checkFinite("pose", 0.0, T_map_base);
  if (!(spread.position_m >= 0.0 && spread.yaw_rad >= 0.0) || !std::isfinite(spread.position_m) ||
      !std::isfinite(spread.yaw_rad))
    throw InvalidArgument("the spread of the pose is " + std::to_string(spread.position_m) +
                          " m and " + std::to_string(spread.yaw_rad) +
                          " rad, expected finite values of at least 0");
  if (!map_.grid().geometry.contains(T_map_base.position()))
    throw InvalidArgument("the pose (" + std::to_string(T_map_base.x) + ", " +
                          std::to_string(T_map_base.y) + ") is outside the map");
  tracker_.reset(T_map_base, spread);
}

bool Navigator::takeControlTurn()
{
  constexpr double kRounding = 1e-6;
  if (!tracker_.hasPose())
    return false;
  const double now = tracker_.poseTime();
  if (control_time_s_ && now >= *control_time_s_ &&
      now - *control_time_s_ < options_.control_period_s - kRounding)
    return false;
  control_time_s_ = now;
  return true;
}

std::optional<DriveInput> Navigator::driveInput(bool with_obstacles)
{
  if (!tracker_.hasPose() || !scan_time_s_ ||
      tracker_.poseTime() - *scan_time_s_ > options_.scan_timeout_s)
    return std::nullopt;
  obstacles_base_.clear();
  if (with_obstacles)
  {
    const Pose T_base_odom = inverse(tracker_.odometry().latest());
    for (const Point& p_odom : obstacles_odom_)
      obstacles_base_.push_back(T_base_odom * p_odom);
  }
  return DriveInput{tracker_.poseTime(),
                    tracker_.pose(),
                    map_.planner(),
                    obstacles_base_,
                    std::exchange(map_changed_for_driver_, false),
                    &map_.grid(),
                    std::exchange(slipped_, false)};
}

void Navigator::addContact(Point p_map)
{
  map_.addContact(p_map, tracker_.poseTime());
  reviseMap();
}

void Navigator::forgetRevisions()
{
  map_.forgetRevisions();
  map_changed_for_driver_ = map_changed_ = true;
}

void Navigator::reviseMap()
{
  if (!map_.revise())
    return;
  map_changed_for_driver_ = map_changed_ = true;
  followGrowingMap();
}

std::string Navigator::whyUnreachable(Point goal, const std::string& reason,
                                      const std::vector<Place>& places,
                                      const std::vector<Door>& doors) const
{
  std::string why;
  const std::optional<BlockedPassage> passage =
      map_.isGiven() && tracker_.hasPose()
          ? findBlockedPassage(map_.givenPlanner(), map_.planner(), tracker_.pose().position(),
                               goal, places, doors)
          : std::nullopt;
  if (passage)
    why = passage->description;
  else
    why = describeShutDoors(map_.planner(), goal, places, doors);
  return why.empty() ? reason : why + " (" + reason + ")";
}

std::vector<StampedEstimate> Navigator::takeEstimates()
{
  return std::exchange(estimates_, {});
}

bool Navigator::takeMapChange()
{
  return std::exchange(map_changed_, false);
}

void Navigator::processScans()
{
  // A scan waits until odometry of its own moment has arrived.
  while (!pending_.empty() && tracker_.isReadyFor(pending_.front().time_s))
  {
    const PendingScan pending = std::move(pending_.front());
    pending_.pop_front();
    processScan(pending);
  }
}

void Navigator::processScan(const PendingScan& pending)
{
  std::optional<Pose> pose =
      tracker_.correct(pending.time_s, pending.scan, pending.mount.T_base_laser);
  if (!pose)
  {
    ++dropped_scans_;
    return;
  }
  const Pose T_odom_base = inverse(tracker_.correction()) * *pose;
  if (const std::optional<Slip> slip =
          slip_detector_.add(pending.scan, pending.mount.T_base_laser, T_odom_base))
  {
    const double lost_m = distance(slip->told.position(), {}) - distance(slip->seen.position(), {});
    slipped_ = slipped_ || lost_m > kLostToSlip;
    tracker_.replaceMotion(*slip);
    pose = tracker_.correction() * T_odom_base;
  }
  obstacles_odom_ = hitPoints(pending.scan, T_odom_base * pending.mount.T_base_laser);
  scan_time_s_ = pending.time_s;
  PoseEstimate estimate = tracker_.estimate();
  estimate.mean = *pose;
  estimates_.push_back({pending.time_s, estimate});

  if (!tracker_.isConfident())
    return;
  map_.forgetOldContacts(tracker_.poseTime());
  map_.insertScan(pending.scan, *pose * pending.mount.T_base_laser, pending.mount.height_m);
  if (revise_time_s_ && pending.time_s >= *revise_time_s_ &&
      pending.time_s - *revise_time_s_ < options_.revise_period_s)
    return;
  revise_time_s_ = pending.time_s;
  reviseMap();
}

}  // namespace kr3::navigation
