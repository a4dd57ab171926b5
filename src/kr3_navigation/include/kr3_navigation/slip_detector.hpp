#pragma once

#include <optional>

#include "kr3_navigation/laser_scan.hpp"

namespace kr3::navigation
{

struct SlipDetectorOptions
{
  double driven_m = 0.2;      ///< by the wheels, between the two scans that are compared
  double outlier_m = 0.07;    ///< a hit farther than that from the earlier scan disagrees with it
  double least_share = 0.02;  ///< of the hits, that must speak against what odometry says
  double farthest_m = 0.3;    ///< of motions looked for instead, along each axis
  double farthest_rad = 0.6;  ///< of what they turn
};

/// What the wheels told and what the laser saw between two moments: the robot's later pose in its
/// earlier frame.
struct Slip
{
  Pose told;
  Pose seen;
};

/// Tells when the wheels turn and the robot does not move as they say, as when it presses against
/// something that the laser does not see. Two scans are compared: when their hits do not agree with
/// what odometry says, and do agree with another motion, then that one took place. Says nothing
/// where both look alike. Not thread-safe. Deterministic.
///
/// Source: correlative scan matching, Olson, "Real-Time Correlative Scan Matching" (ICRA 2009),
/// here by counting the hits that disagree.
/// Cost: about 1 ms each `driven_m`; 60 ms when odometry is wrong.
class SlipDetector
{
public:
  explicit SlipDetector(const SlipDetectorOptions& options = {}) : options_(options) {}

  /// Takes the next scan.
  /// @param T_odom_base  of its moment
  /// @return what happened since an earlier scan, when that is not what odometry told
  [[nodiscard]] std::optional<Slip> add(const LaserScan& scan, const Pose& T_base_laser,
                                        const Pose& T_odom_base);

  /// Forgets the earlier scan: odometry started again.
  void reset() { earlier_.reset(); }

private:
  struct Earlier
  {
    LaserScan scan;
    Pose T_base_laser;
    Pose T_odom_base;
  };

  SlipDetectorOptions options_;
  std::optional<Earlier> earlier_;
};

}  // namespace kr3::navigation
