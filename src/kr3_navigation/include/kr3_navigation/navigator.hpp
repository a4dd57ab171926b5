#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "kr3_navigation/driver.hpp"
#include "kr3_navigation/live_map.hpp"
#include "kr3_navigation/places.hpp"
#include "kr3_navigation/pose_tracker.hpp"
#include "kr3_navigation/slip_detector.hpp"

namespace kr3::navigation
{

struct NavigatorOptions
{
  double control_period_s = 0.05;
  double revise_period_s = 0.5;  ///< of grid and planner
  double scan_timeout_s = 0.6;   ///< without a scan for longer nobody may drive
};

/// The robot's pose when a scan was taken, and what is known about it then.
struct StampedEstimate
{
  double time_s = 0.0;
  PoseEstimate estimate;
};

/// What the robot knows while it moves, from odometry and scans: its pose, the map as it is now,
/// the obstacles around. navigation_node puts it on topics, simulations in one process call it
/// directly.
///
/// A tracker that localises on a map that was not given localises in the map as it grows.
/// The stamps of odometry are its only clock, so the same inputs give the same outputs at any
/// speed. Not thread-safe.
class Navigator
{
public:
  Navigator(LiveMap map, PoseTracker tracker, const NavigatorOptions& options);

  /// Moves the clock, and processes the scans that waited for odometry of their moment.
  /// @throws InvalidArgument  time or pose are not finite, or more than 1000 km away
  OdometryResult addOdometry(double time_s, const Pose& T_odom_base);

  /// The true pose, for a tracker that does not localise.
  /// @throws InvalidArgument  time or pose are not finite, or more than 1000 km away
  void addKnownPose(double time_s, const Pose& T_map_base);

  /// A scan waits until odometry of its moment has arrived; of more than five that wait the oldest
  /// is dropped.
  /// @throws InvalidArgument  see check(const LaserScan&); also a time that is not finite
  void addScan(double time_s, LaserScan scan, const LaserMount& mount);

  /// Starts localisation again around a pose.
  /// @throws InvalidArgument  the pose or the spread is not finite, or the pose is not in the map
  void reset(const Pose& T_map_base, const PoseSpread& spread);

  /// Whether a control period has passed since the last call that returned true.
  [[nodiscard]] bool takeControlTurn();

  /// Everything a driver needs now; nothing before the first scan, or when scans stay away: then
  /// the robot must stand. Valid until the next call of any other member.
  /// @param with_obstacles  false leaves the obstacles out, for a driver that stands
  [[nodiscard]] std::optional<DriveInput> driveInput(bool with_obstacles);

  /// The robot touched something there that it did not see: see LiveMap::addContact().
  void addContact(Point p_map);
  /// See LiveMap::forgetRevisions().
  void forgetRevisions();
  /// Brings grid and planner up to date now.
  void reviseMap();

  /// Why a goal cannot be reached from here, for a person: names the door or passage that is
  /// blocked when one is, and then says what the driver found.
  [[nodiscard]] std::string whyUnreachable(Point goal, const std::string& reason,
                                           const std::vector<Place>& places,
                                           const std::vector<Door>& doors) const;

  /// The poses at the scans processed since the last call, oldest first.
  [[nodiscard]] std::vector<StampedEstimate> takeEstimates();
  /// Whether grid and planner changed since the last call.
  [[nodiscard]] bool takeMapChange();

  [[nodiscard]] const LiveMap& map() const { return map_; }
  [[nodiscard]] const PoseTracker& tracker() const { return tracker_; }
  [[nodiscard]] bool hasScan() const { return scan_time_s_.has_value(); }
  /// Scans that were too old, or too many at once.
  [[nodiscard]] long droppedScans() const { return dropped_scans_; }

private:
  struct PendingScan
  {
    double time_s;
    LaserScan scan;
    LaserMount mount;
  };

  void followGrowingMap();
  void processScans();
  void processScan(const PendingScan& pending);

  NavigatorOptions options_;
  LiveMap map_;
  PoseTracker tracker_;
  SlipDetector slip_detector_;
  bool slipped_ = false;  ///< since the driver asked last
  std::deque<PendingScan> pending_;
  std::vector<StampedEstimate> estimates_;
  std::vector<Point> obstacles_odom_;  ///< hits of the latest scan
  std::vector<Point> obstacles_base_;  ///< the same in the robot's present frame
  std::optional<double> scan_time_s_;  ///< of that scan
  std::optional<double> control_time_s_;
  std::optional<double> revise_time_s_;
  bool map_changed_for_driver_ = false;
  bool map_changed_ = true;
  long dropped_scans_ = 0;
};

}  // namespace kr3::navigation
