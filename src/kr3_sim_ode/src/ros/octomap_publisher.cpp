#include "octomap_publisher.hpp"

#include <std_msgs/UInt8MultiArray.h>

#include "names.hpp"

namespace kr3::sim
{

namespace
{
constexpr double kMinPeriod = 1.0;  // s, wall
}

OctomapPublisher::OctomapPublisher(ros::NodeHandle& nh, const OctomapOptions& options)
  : options_(options)
  , publisher_(nh.advertise<std_msgs::UInt8MultiArray>(names::kTrueOctomap, 1, true))
{
}

void OctomapPublisher::update(const World& world)
{
  const ros::WallTime now = ros::WallTime::now();
  if (is_current_ || publisher_.getNumSubscribers() == 0 || (now - last_).toSec() < kMinPeriod)
  {
    return;
  }
  std_msgs::UInt8MultiArray msg;
  msg.data = world.octomap(options_);
  publisher_.publish(msg);
  is_current_ = true;
  last_ = now;
}

}  // namespace kr3::sim
