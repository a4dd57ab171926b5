#include "kr3_navigation/pose_tracker.hpp"

#include <cmath>

namespace kr3::navigation
{
namespace
{

constexpr double kMemory = 3.0;  // s
constexpr double kJump =
    0.5;  // m between two odometry messages: no robot drives that far in between
constexpr double kClockJitter = 1.0;  // s: a message that late is a new clock, not a late one
// Of the first pose: a share of the way from where odometry was zero.
constexpr double kDriftPosition = 0.03;      // m per m
constexpr double kDriftYaw = 0.01;           // rad per m
constexpr double kConfidentPosition = 0.10;  // m, standard deviation
constexpr double kConfidentYaw = 0.05;       // rad
constexpr double kConfidentFit = 0.30;       // m, mean distance of hits from the map

}  // namespace

PoseTracker::PoseTracker(std::optional<ParticleFilter> filter, const Pose& T_map_odom,
                         const PoseSpread& initial_spread)
  : filter_(std::move(filter))
  , initial_T_map_odom_(T_map_odom)
  , initial_spread_(initial_spread)
  , odometry_(kMemory)
  , known_(kMemory)
{
}

void PoseTracker::setGrowingField(DistanceField field)
{
  filter_->setField(std::move(field));
  map_grows_ = true;
}

OdometryResult PoseTracker::addOdometry(double time_s, const Pose& T_odom_base)
{
  const bool first = odometry_.empty();
  const bool clock_restarted = !first && time_s < odometry_.latestTime() - kClockJitter;
  const bool jumped =
      !first && distance(odometry_.latest().position(), T_odom_base.position()) > kJump;
  const bool restarted = clock_restarted || jumped;
  if (!first && !restarted && time_s <= odometry_.latestTime())
    return OdometryResult::kStale;
  if (restarted)
    odometry_.clear();
  if (clock_restarted)
    known_.clear();
  odometry_.add(time_s, T_odom_base);
  const OdometryResult result = restarted ? OdometryResult::kRestarted : OdometryResult::kTaken;
  if (!filter_ || !(first || restarted))
    return result;
  if (requested_start_)
  {
    const Start start = *requested_start_;
    reset(start.T_map_base, start.spread);
  }
  else
  {
    const double driven_m = std::hypot(T_odom_base.x, T_odom_base.y);
    reset(initial_T_map_odom_ * T_odom_base,
          {initial_spread_.position_m + kDriftPosition * driven_m,
           initial_spread_.yaw_rad + kDriftYaw * driven_m});
  }
  return result;
}

void PoseTracker::reset(const Pose& T_map_base, const PoseSpread& spread)
{
  if (filter_)
    filter_->reset(T_map_base, spread);
  if (odometry_.empty())
  {
    requested_start_ = Start{T_map_base, spread};  // holds from the first odometry on
    return;
  }
  requested_start_.reset();
  T_map_odom_ = T_map_base * inverse(odometry_.latest());
  last_scan_odometry_ = odometry_.latest();
}

bool PoseTracker::isReadyFor(double time_s) const
{
  return odometry_.covers(time_s) && (filter_ || known_.covers(time_s));
}

std::optional<Pose> PoseTracker::correct(double time_s, const LaserScan& scan,
                                         const Pose& T_base_laser)
{
  const std::optional<Pose> T_odom_base = odometry_.at(time_s);
  if (!T_odom_base)
    return std::nullopt;
  if (!filter_)
  {
    const std::optional<Pose> T_map_base = known_.at(time_s);
    if (T_map_base)
      T_map_odom_ = *T_map_base * inverse(*T_odom_base);
    return T_map_base;
  }
  filter_->predict(inverse(last_scan_odometry_.value_or(*T_odom_base)) * *T_odom_base);
  last_scan_odometry_ = *T_odom_base;
  filter_->update(scan, T_base_laser);
  T_map_odom_ = filter_->estimate().mean * inverse(*T_odom_base);
  return filter_->estimate().mean;
}

void PoseTracker::replaceMotion(const Slip& slip)
{
  if (!filter_ || !last_scan_odometry_)
    return;
  filter_->predict(inverse(slip.told) * slip.seen);
  T_map_odom_ = filter_->estimate().mean * inverse(*last_scan_odometry_);
}

PoseEstimate PoseTracker::estimate() const
{
  if (filter_)
    return filter_->estimate();
  PoseEstimate estimate;
  estimate.mean = pose();
  return estimate;
}

bool PoseTracker::isConfident() const
{
  if (!filter_)
    return true;
  const PoseEstimate& estimate = filter_->estimate();
  return std::sqrt(std::max(estimate.covariance[0], estimate.covariance[4])) < kConfidentPosition &&
         std::sqrt(estimate.covariance[8]) < kConfidentYaw &&
         (map_grows_ || estimate.mean_hit_distance_m < kConfidentFit);
}

double PoseTracker::probabilityIn(const Rectangle& area) const
{
  if (filter_)
    return filter_->probabilityIn(area);
  return hasPose() && area.contains(pose().position()) ? 1.0 : 0.0;
}

}  // namespace kr3::navigation
