#include <cstdlib>
#include <exception>

#include <ros/ros.h>

#include "reasoner_node.hpp"

int main(int argc, char** argv)
{
  ros::init(argc, argv, "reasoner_node");
  const ros::NodeHandle private_nh(
      "~");  // outlives the try: destroying the last handle silences the log
  try
  {
    const kr3::reasoner::ReasonerNode node(ros::NodeHandle(),
                                           kr3::reasoner::loadReasonerNodeConfig(private_nh));
    ros::spin();
  }
  catch (const std::exception& e)
  {
    ROS_FATAL("%s", e.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
