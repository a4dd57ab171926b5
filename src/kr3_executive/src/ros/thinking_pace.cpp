#include "thinking_pace.hpp"

#include <string>

#include <ros/service.h>
#include <ros/this_node.h>

#include <kr3_common/error.hpp>
#include <kr3_msgs/Acknowledgement.h>
#include <kr3_msgs/RegisterConsumer.h>
#include <kr3_msgs/Status.h>
#include <kr3_msgs/UnregisterConsumer.h>

#include "kr3_executive/names.hpp"

namespace kr3::executive
{
namespace
{

constexpr double kPeriod_s = 0.1;      // simulated, between the stamps that the simulator waits at
constexpr double kPoll_s = 0.002;      // wall; bounds the real-time factor to kPeriod_s / kPoll_s
constexpr double kPatience_s = 60.0;   // wall: a node that stopped is left behind after this time
constexpr double kDiscovery_s = 20.0;  // wall: for the simulator's service and its subscription

}  // namespace

ThinkingPace::ThinkingPace(ros::NodeHandle nh)
  : nh_(std::move(nh))
  , name_(ros::this_node::getName())
  , acknowledgements_(nh_.advertise<kr3_msgs::Acknowledgement>(names::kAcknowledge, 100))
{
  auto client = nh_.serviceClient<kr3_msgs::RegisterConsumer>(names::kRegisterConsumer);
  const ros::SteadyTime deadline = ros::SteadyTime::now() + ros::WallDuration(kDiscovery_s);
  while (!client.exists() || acknowledgements_.getNumSubscribers() == 0)
  {
    if (!ros::ok() || ros::SteadyTime::now() > deadline)
    {
      throw Unavailable("lockstep was asked for, but no simulator offers service " +
                        client.getService() + " and listens to " + acknowledgements_.getTopic());
    }
    ros::WallDuration(0.02).sleep();
  }
  kr3_msgs::RegisterConsumer service;
  service.request.name = name_;
  service.request.period = ros::Duration(kPeriod_s);
  service.request.timeout = ros::Duration(kPatience_s);
  if (!client.call(service))
    throw Unavailable("service " + client.getService() + " did not answer");
  if (service.response.status.code != kr3_msgs::Status::OK)
    throw FailedPrecondition(client.getService() + ": " + service.response.status.message);
  timer_ = nh_.createSteadyTimer(ros::WallDuration(kPoll_s),
                                 [this](const ros::SteadyTimerEvent&) { acknowledge(); });
}

ThinkingPace::~ThinkingPace()
{
  timer_.stop();
  kr3_msgs::UnregisterConsumer service;
  service.request.name = name_;
  ros::service::call(nh_.resolveName(names::kUnregisterConsumer), service);
}

void ThinkingPace::beginThinking()
{
  const std::lock_guard<std::mutex> lock(mutex_);
  thinking_since_ = Instant{ros::Time::now(), ros::SteadyTime::now()};
}

void ThinkingPace::endThinking()
{
  const std::lock_guard<std::mutex> lock(mutex_);
  thinking_since_.reset();
}

void ThinkingPace::acknowledge()
{
  const std::lock_guard<std::mutex> lock(mutex_);
  const ros::Time now = ros::Time::now();
  if (now == acknowledged_)
    return;
  const bool ahead =
      thinking_since_ && (now - thinking_since_->simulated).toSec() >
                             (ros::SteadyTime::now() - thinking_since_->wall).toSec();
  if (ahead)
    return;
  kr3_msgs::Acknowledgement message;
  message.name = name_;
  message.stamp = now;
  acknowledgements_.publish(message);
  acknowledged_ = now;
}

LowLevelResult PacedExecutor::execute(const LowLevelAction& action, const FluentLookup& believed,
                                      const std::atomic<bool>& cancel)
{
  struct Acting
  {
    ThinkingPace& pace;
    explicit Acting(ThinkingPace& paced) : pace(paced) { pace.endThinking(); }
    ~Acting() { pace.beginThinking(); }
    Acting(const Acting&) = delete;
    Acting& operator=(const Acting&) = delete;
  };
  const Acting acting(pace_);
  return inner_.execute(action, believed, cancel);
}

}  // namespace kr3::executive
