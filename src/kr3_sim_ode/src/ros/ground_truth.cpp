#include "ground_truth.hpp"

#include <kr3_msgs/ContactArray.h>
#include <kr3_msgs/ModelTwists.h>

#include "conversions.hpp"
#include "names.hpp"

namespace kr3::sim
{

GroundTruth::GroundTruth(ros::NodeHandle& nh, const OctomapOptions& octomap)
  : pose_(nh.advertise<nav_msgs::Odometry>(names::kTruePose, 50))
  , models_(nh.advertise<kr3_msgs::ModelStates>(names::kTrueModels, 5, true))
  , twists_(nh.advertise<kr3_msgs::ModelTwists>(names::kTrueTwists, 50))
  , contacts_(nh.advertise<kr3_msgs::ContactArray>(names::kContacts, 50))
  , octomap_(nh, octomap)
{
}

void GroundTruth::publishMotion(const ros::Time& stamp, World& world)
{
  pose_.publish(toOdometry(stamp, names::kWorldFrame, world.robotPose(), world.robotVelocity()));
  if (twists_.getNumSubscribers() > 0)
  {
    twists_.publish(toModelTwists(stamp, world.twists()));
  }
  const std::vector<ContactReport> contacts = world.takeContacts();
  if (!contacts.empty())
  {
    contacts_.publish(toContactArray(stamp, contacts));
  }
}

void GroundTruth::publishModels(const ros::Time& stamp, const World& world)
{
  models_.publish(toModelStates(stamp, world));
}

}  // namespace kr3::sim
