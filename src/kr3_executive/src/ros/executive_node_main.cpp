#include <atomic>
#include <csignal>
#include <cstdlib>
#include <exception>

#include <ros/ros.h>

#include <kr3_common/error.hpp>

#include "executive_node.hpp"

namespace
{

std::atomic<bool> stop{false};

/// Waits until there is time, which is the simulator's: action clients wait for it too, but cannot
/// be interrupted.
void waitForTime(double deadline_s)
{
  const ros::WallTime deadline = ros::WallTime::now() + ros::WallDuration(deadline_s);
  while (!ros::Time::isValid())
  {
    if (stop || !ros::ok())
      throw kr3::Cancelled("stopped while waiting for /clock");
    if (ros::WallTime::now() > deadline)
      throw kr3::Unavailable("use_sim_time is set and nothing came on /clock in time");
    ros::WallDuration(0.02).sleep();
  }
}

}  // namespace

int main(int argc, char** argv)
{
  // Our own handler: with ROS's the publishers are gone before a running skill can be cancelled.
  ros::init(argc, argv, "executive_node", ros::init_options::NoSigintHandler);
  const auto on_signal = [](int) { stop = true; };
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  const ros::NodeHandle private_nh(
      "~");  // outlives the try: destroying the last handle silences the log
  try
  {
    ros::AsyncSpinner spinner(2);  // a service of ours may wait for one of the reasoner
    spinner.start();
    {
      const auto config = kr3::executive::loadExecutiveNodeConfig(private_nh);
      waitForTime(config.peer_deadline_s);
      const kr3::executive::ExecutiveNode node(ros::NodeHandle(), private_nh, config, stop);
      while (ros::ok() && !stop)
        ros::WallDuration(0.05).sleep();
    }
    spinner.stop();
  }
  catch (const kr3::Cancelled& e)
  {
    ROS_INFO("%s", e.what());
  }
  catch (const std::exception& e)
  {
    ROS_FATAL("%s", e.what());
    return EXIT_FAILURE;
  }
  ros::shutdown();
  return EXIT_SUCCESS;
}
