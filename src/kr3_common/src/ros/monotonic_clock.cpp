#include "kr3_common/ros/monotonic_clock.hpp"

#include <ros/console.h>

namespace kr3
{

ros::Time MonotonicClock::now()
{
  const std::lock_guard<std::mutex> lock(mutex_);
  ros::Time time = ros::Time::now() + ahead_;
  if (time < last_)
  {
    ROS_WARN("time went back by %.3f s: what is under way counts that as no time",
             (last_ - time).toSec());
    ahead_ += last_ - time;
    time = last_;
  }
  last_ = time;
  return time;
}

}  // namespace kr3
