#include <csignal>
#include <cstdlib>

#include <ros/callback_queue.h>
#include <ros/ros.h>

#include "navigation_node.hpp"

namespace
{

volatile std::sig_atomic_t stop_requested = 0;

void requestStop(int /*signal*/)
{
  stop_requested = 1;
}

void spinFor(double wall_s)
{
  ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(wall_s));
}

}  // namespace

int main(int argc, char** argv)
{
  // ROS's own handler would close the connections before the wheels are stopped.
  ros::init(argc, argv, "navigation_node", ros::init_options::NoSigintHandler);
  std::signal(SIGINT, requestStop);
  std::signal(SIGTERM, requestStop);
  const ros::NodeHandle private_nh("~");
  try
  {
    kr3::navigation::NavigationNode node(kr3::navigation::loadNavigationNodeConfig(private_nh));
    while (ros::ok() && stop_requested == 0)
      spinFor(0.1);
    node.stop();
    const ros::WallTime flushed = ros::WallTime::now() + ros::WallDuration(0.1);
    while (ros::ok() && ros::WallTime::now() < flushed)
      spinFor(0.02);  // lets the last messages leave
  }
  catch (const std::exception& e)
  {
    ROS_FATAL("%s", e.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
