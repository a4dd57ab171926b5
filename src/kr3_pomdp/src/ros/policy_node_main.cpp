#include <algorithm>
#include <cstdlib>
#include <exception>

#include <ros/ros.h>
#include <sys/resource.h>

#include <kr3_common/error.hpp>

#include "policy_node.hpp"

namespace
{

/// Makes an allocation beyond this fail, which a request survives, in place of the system ending
/// the process.
void limitMemory(int megabytes)
{
  if (megabytes == 0)
  {
    return;
  }
  const rlim_t bytes = static_cast<rlim_t>(megabytes) << 20U;
  rlimit limit{};
  if (getrlimit(RLIMIT_DATA, &limit) != 0)
  {
    throw kr3::Unavailable("cannot read this process's limit of memory");
  }
  limit.rlim_cur = std::min(bytes, limit.rlim_max);
  if (setrlimit(RLIMIT_DATA, &limit) != 0)
  {
    throw kr3::Unavailable("cannot set this process's limit of memory");
  }
}

}  // namespace

int main(int argc, char** argv)
{
  ros::init(argc, argv, "policy_node");
  const ros::NodeHandle private_nh(
      "~");  // outlives the try: destroying the last handle silences the log
  try
  {
    const kr3::pomdp::PolicyNodeConfig config = kr3::pomdp::loadPolicyNodeConfig(private_nh);
    limitMemory(config.max_process_megabytes);
    kr3::pomdp::PolicyNode node(config);
    ros::waitForShutdown();
    if (!node.stop())
    {
      std::_Exit(EXIT_SUCCESS);  // a thread still reads a model; what it uses must stay
    }
  }
  catch (const std::exception& e)
  {
    ROS_FATAL("%s", e.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
