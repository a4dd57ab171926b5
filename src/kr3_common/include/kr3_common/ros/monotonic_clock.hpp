#pragma once

#include <mutex>

#include <ros/duration.h>
#include <ros/time.h>

namespace kr3
{

/// ROS time that never goes back. Where the clock jumps back (a simulator that was started anew, a
/// bag that is played again), time stands still for the jump and goes on from there, so that what
/// lasts neither has a negative duration nor waits until the clock has caught up. Thread-safe.
class MonotonicClock
{
public:
  /// s since the clock's beginning, jumps back left out.
  [[nodiscard]] ros::Time now();

private:
  std::mutex mutex_;
  ros::Time last_;
  ros::Duration ahead_;  ///< of the clock: the sum of its jumps back
};

}  // namespace kr3
