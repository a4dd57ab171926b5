#include <cstdlib>
#include <exception>

#include <ros/ros.h>

#include "sim_node.hpp"

int main(int argc, char** argv)
{
  ros::init(argc, argv, "sim_node");
  const ros::NodeHandle private_nh("~");
  try
  {
    kr3::sim::SimNode node(ros::NodeHandle(), kr3::sim::loadSimNodeConfig(private_nh));
    node.run();
  }
  catch (const std::exception& e)
  {
    ROS_FATAL("%s", e.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
