#include <cstdlib>

#include <ros/ros.h>

#include "skill_node.hpp"

int main(int argc, char** argv)
{
  ros::init(argc, argv, "skill_node");
  const ros::NodeHandle private_nh(
      "~");  // outlives the try: destroying the last handle silences the log
  try
  {
    ros::AsyncSpinner spinner(1);  // skills wait on their own threads for what arrives on this one
    const kr3::executive::skills::SkillNode node(
        ros::NodeHandle(), kr3::executive::skills::loadSkillNodeConfig(private_nh));
    spinner.start();
    ros::waitForShutdown();
  }
  catch (const std::exception& e)
  {
    ROS_FATAL("%s", e.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
