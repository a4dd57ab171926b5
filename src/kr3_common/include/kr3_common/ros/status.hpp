#pragma once

#include <exception>
#include <string>

#include <kr3_msgs/Status.h>

#include "kr3_common/error.hpp"

namespace kr3
{

/// The status that stands for the exception under way. Call it from a catch block only.
/// An Error keeps its code; anything else becomes INTERNAL.
[[nodiscard]] kr3_msgs::Status statusFromCurrentException();

[[nodiscard]] kr3_msgs::Status okStatus();
[[nodiscard]] kr3_msgs::Status makeStatus(ErrorCode code, const std::string& message);

/// Logs a failed request with ROS_ERROR: what was asked, the code, the message.
void logFailure(const std::string& request, const kr3_msgs::Status& status);

/// Runs `work` and fills `status`: OK, or the code and message of what it threw, with one log line.
/// Always returns true, the value that a service callback returns when transport worked.
template <typename Work>
bool respond(kr3_msgs::Status& status, const std::string& request, Work&& work)
{
  try
  {
    work();
    status = okStatus();
  }
  catch (...)
  {
    status = statusFromCurrentException();
    logFailure(request, status);
  }
  return true;
}

}  // namespace kr3
