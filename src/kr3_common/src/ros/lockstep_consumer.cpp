#include "kr3_common/ros/lockstep_consumer.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include <ros/service.h>
#include <ros/this_node.h>

#include <kr3_msgs/Acknowledgement.h>
#include <kr3_msgs/LockstepState.h>
#include <kr3_msgs/RegisterConsumer.h>
#include <kr3_msgs/Status.h>
#include <kr3_msgs/UnregisterConsumer.h>

#include "kr3_common/error.hpp"

namespace kr3
{
namespace
{

constexpr char kAcknowledge[] = "lockstep/acknowledge";
constexpr char kState[] = "lockstep/state";
constexpr char kRegister[] = "lockstep/register";
constexpr char kUnregister[] = "lockstep/unregister";
constexpr double kPeriod_s = 0.1;      // simulated, between the stamps that the simulator waits at
constexpr double kPoll_s = 0.002;      // wall; bounds the real-time factor to kPeriod_s / kPoll_s
constexpr double kPatience_s = 60.0;   // wall: a node that stopped is left behind after this time
constexpr double kDiscovery_s = 20.0;  // wall: for the simulator's service and its subscription

}  // namespace

LockstepConsumer::LockstepConsumer(ros::NodeHandle nh)
  : nh_(std::move(nh))
  , name_(ros::this_node::getName().substr(1))  // as the simulator lists it, without the slash
  , acknowledgements_(nh_.advertise<kr3_msgs::Acknowledgement>(kAcknowledge, 100))
{
  const std::string service = nh_.resolveName(kRegister);
  const ros::SteadyTime deadline = ros::SteadyTime::now() + ros::WallDuration(kDiscovery_s);
  while (!ros::service::exists(service, false) || acknowledgements_.getNumSubscribers() == 0)
  {
    if (!ros::ok() || ros::SteadyTime::now() > deadline)
    {
      throw Unavailable("lockstep was asked for, but no simulator offers service " + service +
                        " and listens to " + acknowledgements_.getTopic());
    }
    ros::WallDuration(0.02).sleep();
  }
  enlist();
  state_ = nh_.subscribe<kr3_msgs::LockstepState>(
      kState, 1, [this](const kr3_msgs::LockstepStateConstPtr& state) {
        if (std::find(state->consumers.begin(), state->consumers.end(), name_) !=
            state->consumers.end())
          return;
        ROS_ERROR("the simulation went on without this node; it is in lockstep again");
        try
        {
          enlist();
        }
        catch (const Error& e)
        {
          ROS_ERROR("%s", e.what());
        }
      });
  timer_ = nh_.createSteadyTimer(ros::WallDuration(kPoll_s),
                                 [this](const ros::SteadyTimerEvent&) { acknowledge(); });
}

LockstepConsumer::~LockstepConsumer()
{
  timer_.stop();
  state_.shutdown();
  kr3_msgs::UnregisterConsumer service;
  service.request.name = name_;
  ros::service::call(nh_.resolveName(kUnregister), service);
}

void LockstepConsumer::enlist()
{
  kr3_msgs::RegisterConsumer service;
  service.request.name = name_;
  service.request.period = ros::Duration(kPeriod_s);
  service.request.timeout = ros::Duration(kPatience_s);
  const std::string resolved = nh_.resolveName(kRegister);
  if (!ros::service::call(resolved, service))
    throw Unavailable("service " + resolved + " did not answer");
  if (service.response.status.code != kr3_msgs::Status::OK)
    throw FailedPrecondition(resolved + ": " + service.response.status.message);
}

void LockstepConsumer::pace()
{
  const std::lock_guard<std::mutex> lock(mutex_);
  paced_since_ = Instant{ros::Time::now(), ros::SteadyTime::now()};
}

void LockstepConsumer::release()
{
  const std::lock_guard<std::mutex> lock(mutex_);
  paced_since_.reset();
}

void LockstepConsumer::acknowledge()
{
  const std::lock_guard<std::mutex> lock(mutex_);
  const ros::Time now = ros::Time::now();
  if (now == acknowledged_)
    return;
  const bool ahead = paced_since_ && (now - paced_since_->simulated).toSec() >
                                         (ros::SteadyTime::now() - paced_since_->wall).toSec();
  if (ahead)
    return;
  kr3_msgs::Acknowledgement message;
  message.name = name_;
  message.stamp = now;
  acknowledgements_.publish(message);
  acknowledged_ = now;
}

}  // namespace kr3
