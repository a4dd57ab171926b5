#include "lockstep_servers.hpp"

#include <utility>

#include <kr3_common/error.hpp>
#include <kr3_common/ros/status.hpp>
#include <kr3_msgs/LockstepState.h>

#include "names.hpp"

namespace kr3::sim
{

namespace
{
constexpr std::uint32_t kQueue = 1000;

double wallSeconds()
{
  return ros::WallTime::now().toSec();
}

/// Nodes are known by their names without the leading slash.
std::string plainName(const std::string& name)
{
  return !name.empty() && name.front() == '/' ? name.substr(1) : name;
}
}  // namespace

LockstepServers::LockstepServers(ros::NodeHandle& nh, const ros::Duration& tick,
                                 const std::vector<std::string>& required, double default_timeout_s,
                                 std::function<ros::Time()> now)
  : lockstep_(now().toNSec(), static_cast<std::uint64_t>(tick.toNSec()), required)
  , default_timeout_s_(default_timeout_s)
  , now_(std::move(now))
  , state_(nh.advertise<kr3_msgs::LockstepState>(names::kLockstepState, 5, true))
  , acknowledge_(nh.subscribe(names::kAcknowledge, kQueue, &LockstepServers::onAcknowledge, this,
                              ros::TransportHints().tcpNoDelay()))
  , register_(nh.advertiseService(names::kRegister, &LockstepServers::onRegister, this))
  , unregister_(nh.advertiseService(names::kUnregister, &LockstepServers::onUnregister, this))
{
  publishState();
}

bool LockstepServers::mayAdvance()
{
  const std::uint64_t now = now_().toNSec();
  if (lockstep_.isReady(now))
  {
    return true;
  }
  for (const std::string& name : lockstep_.expire(now, wallSeconds()))
  {
    ROS_ERROR("lockstep: '%s' did not acknowledge %.3f s in time and is removed", name.c_str(),
              now_().toSec());
    removed_.push_back(name);
    publishState();
  }
  return lockstep_.isReady(now);
}

void LockstepServers::advanced()
{
  lockstep_.advanced(now_().toNSec(), wallSeconds());
}

void LockstepServers::noteCommand(const std::string& node)
{
  lockstep_.noteCommand(plainName(node));
}

std::string LockstepServers::waitingFor() const
{
  std::string all;
  for (const std::string& name : lockstep_.waitingFor(now_().toNSec()))
  {
    all += (all.empty() ? "" : ", ") + name;
  }
  return all;
}

void LockstepServers::onAcknowledge(const kr3_msgs::Acknowledgement& acknowledgement)
{
  try
  {
    lockstep_.acknowledge(plainName(acknowledgement.name), acknowledgement.stamp.toNSec(),
                          acknowledgement.num_commands, now_().toNSec());
  }
  catch (const Error& e)
  {
    ROS_WARN_THROTTLE(1.0, "lockstep: ignored an acknowledgement: %s", e.what());
  }
}

bool LockstepServers::onRegister(kr3_msgs::RegisterConsumer::Request& request,
                                 kr3_msgs::RegisterConsumer::Response& response)
{
  return respond(response.status, "register '" + request.name + "'", [&] {
    if (request.period < ros::Duration(0.0))
    {
      throw InvalidArgument("period of " + std::to_string(request.period.toSec()) +
                            " s, expected 0 or more");
    }
    const double timeout_s =
        request.timeout.isZero() ? default_timeout_s_ : request.timeout.toSec();
    const Lockstep::Schedule schedule =
        lockstep_.add(plainName(request.name), static_cast<std::uint64_t>(request.period.toNSec()),
                      timeout_s, now_().toNSec(), wallSeconds());
    response.stamp.fromNSec(schedule.first_ns);
    response.period.fromNSec(static_cast<std::int64_t>(schedule.period_ns));
    ROS_INFO("lockstep: waiting for '%s' every %.3f s", request.name.c_str(),
             response.period.toSec());
    publishState();
  });
}

bool LockstepServers::onUnregister(kr3_msgs::UnregisterConsumer::Request& request,
                                   kr3_msgs::UnregisterConsumer::Response& response)
{
  return respond(response.status, "unregister '" + request.name + "'", [&] {
    lockstep_.remove(plainName(request.name));
    publishState();
  });
}

void LockstepServers::publishState()
{
  kr3_msgs::LockstepState msg;
  msg.header.stamp = now_();
  msg.consumers = lockstep_.consumers();
  msg.removed = removed_;
  state_.publish(msg);
}

}  // namespace kr3::sim
