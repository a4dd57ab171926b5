#include <cstdlib>

#include <opencv2/core/utility.hpp>
#include <ros/ros.h>

#include "detector_node.hpp"

int main(int argc, char** argv)
{
  ros::init(argc, argv, "detector_node");
  const ros::NodeHandle private_nh(
      "~");              // outlives the try: destroying the last handle silences the log
  cv::setNumThreads(1);  // leave the other cores to the rest of the robot
  try
  {
    const kr3::perception::DetectorNode node(ros::NodeHandle(),
                                             kr3::perception::loadDetectorNodeConfig(private_nh));
    ros::spin();
  }
  catch (const std::exception& e)
  {
    ROS_FATAL("%s", e.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
