#pragma once

#include <optional>

#include "kr3_navigation/particle_filter.hpp"
#include "kr3_navigation/pose_history.hpp"
#include "kr3_navigation/slip_detector.hpp"

namespace kr3::navigation
{

/// What became of an odometry message.
enum class OdometryResult
{
  kTaken,
  kStale,      ///< not newer than the last one: ignored
  kRestarted,  ///< it jumped, or its time went back: localisation starts again at the initial pose
};

/// Where the robot is in the map: odometry, corrected at every scan by a particle filter or by
/// known poses. Not thread-safe.
class PoseTracker
{
public:
  /// @param filter   localises; without one, poses come from addKnownPose()
  /// @param T_map_odom  where the robot was in the map when its odometry was zero: so a node that
  /// starts again while the robot is under way finds it
  /// @param initial_spread  how well that is known; drift on the way so far is added
  PoseTracker(std::optional<ParticleFilter> filter, const Pose& T_map_odom,
              const PoseSpread& initial_spread = {0.10, 0.05});

  /// Localises in a map that grows: how well scans fit it then says nothing about the pose.
  void setGrowingField(DistanceField field);
  /// Whether poses come from a particle filter.
  [[nodiscard]] bool localises() const { return filter_.has_value(); }

  /// A jump (the robot was put elsewhere, or its odometry started again) and a time that goes back
  /// by more than a second (the clock started again) reset the pose to the initial one.
  OdometryResult addOdometry(double time_s, const Pose& T_odom_base);
  /// The true pose of the robot, while a map is built with known poses.
  void addKnownPose(double time_s, const Pose& T_map_base) { known_.add(time_s, T_map_base); }

  /// Starts localisation again, around a pose that holds now.
  void reset(const Pose& T_map_base, const PoseSpread& spread);

  /// Whether everything that correct() needs for a scan of that time has arrived.
  [[nodiscard]] bool isReadyFor(double time_s) const;
  /// Takes a scan into account.
  /// @return the robot's pose in the map when the scan was taken; nothing when the scan is older
  /// than what is
  ///         remembered
  std::optional<Pose> correct(double time_s, const LaserScan& scan, const Pose& T_base_laser);

  /// Puts the motion that took place in the place of the one that odometry told before the last
  /// correct(). With known poses there is nothing to replace.
  void replaceMotion(const Slip& slip);

  [[nodiscard]] bool hasPose() const { return !odometry_.empty() && T_map_odom_.has_value(); }
  /// At the time of the latest odometry. Only with hasPose().
  [[nodiscard]] Pose pose() const { return *T_map_odom_ * odometry_.latest(); }
  [[nodiscard]] double poseTime() const { return odometry_.latestTime(); }
  [[nodiscard]] const Pose& correction() const
  {
    return *T_map_odom_;
  }  ///< T_map_odom; only with hasPose()
  [[nodiscard]] const PoseHistory& odometry() const { return odometry_; }

  /// At the last scan. Covariance 0 with known poses.
  [[nodiscard]] PoseEstimate estimate() const;
  /// Whether the estimate is sharp and explains the scans: good enough to revise the map with.
  [[nodiscard]] bool isConfident() const;
  /// Probability that the robot is inside a rectangle.
  [[nodiscard]] double probabilityIn(const Rectangle& area) const;

private:
  struct Start
  {
    Pose T_map_base;
    PoseSpread spread;
  };

  std::optional<ParticleFilter> filter_;
  Pose initial_T_map_odom_;
  PoseSpread initial_spread_;
  bool map_grows_ = false;
  std::optional<Start> requested_start_;
  PoseHistory odometry_;
  PoseHistory known_;
  std::optional<Pose> T_map_odom_;
  std::optional<Pose> last_scan_odometry_;  ///< T_odom_base at the last scan
};

}  // namespace kr3::navigation
