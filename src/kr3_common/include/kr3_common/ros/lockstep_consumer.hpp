#pragma once

#include <mutex>
#include <optional>

#include <ros/node_handle.h>

namespace kr3
{

/// Keeps a simulation in lockstep with a node (kr3_sim_ode's README, Lockstep): its clock does not
/// leave the node behind.
///
/// The present is acknowledged from a timer in the node's callback queue. So a node that is spun by
/// one thread holds the simulation while it works on a message, and one that is idle does not. What
/// was sent and has not arrived yet is not waited for: the node may be late by one period. A node
/// that works elsewhere than in callbacks says so with pace().
class LockstepConsumer
{
public:
  /// Registers under the node's name.
  /// @param nh  its callback queue must be spun by a thread that is not the caller's, or afterwards
  /// @throws Unavailable         there is no simulator that offers lockstep
  /// @throws FailedPrecondition  it refused, with its reason
  explicit LockstepConsumer(ros::NodeHandle nh);
  ~LockstepConsumer();
  LockstepConsumer(const LockstepConsumer&) = delete;
  LockstepConsumer& operator=(const LockstepConsumer&) = delete;

  /// From now on simulated time goes as fast as wall time and no faster: the node works, and what
  /// it does takes a simulated robot as long as a real one. Thread-safe.
  void pace();
  /// From now on the simulation is not held. Thread-safe.
  void release();

private:
  struct Instant
  {
    ros::Time simulated;
    ros::SteadyTime wall;
  };

  void enlist();
  void acknowledge();

  ros::NodeHandle nh_;
  std::string name_;
  std::mutex mutex_;  // guards the next two
  std::optional<Instant> paced_since_;
  ros::Time acknowledged_;
  ros::Publisher acknowledgements_;
  ros::Subscriber state_;
  ros::SteadyTimer timer_;
};

}  // namespace kr3
