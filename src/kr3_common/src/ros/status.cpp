#include "kr3_common/ros/status.hpp"

#include <ros/console.h>

namespace kr3
{
namespace
{

constexpr bool same(ErrorCode code, int constant)
{
  return static_cast<int>(code) == constant;
}

static_assert(same(ErrorCode::kOk, kr3_msgs::Status::OK));
static_assert(same(ErrorCode::kInvalidArgument, kr3_msgs::Status::INVALID_ARGUMENT));
static_assert(same(ErrorCode::kNotFound, kr3_msgs::Status::NOT_FOUND));
static_assert(same(ErrorCode::kFailedPrecondition, kr3_msgs::Status::FAILED_PRECONDITION));
static_assert(same(ErrorCode::kUnavailable, kr3_msgs::Status::UNAVAILABLE));
static_assert(same(ErrorCode::kResourceExhausted, kr3_msgs::Status::RESOURCE_EXHAUSTED));
static_assert(same(ErrorCode::kDeadlineExceeded, kr3_msgs::Status::DEADLINE_EXCEEDED));
static_assert(same(ErrorCode::kCancelled, kr3_msgs::Status::CANCELLED));
static_assert(same(ErrorCode::kInternal, kr3_msgs::Status::INTERNAL));

}  // namespace

kr3_msgs::Status makeStatus(ErrorCode code, const std::string& message)
{
  kr3_msgs::Status status;
  status.code = static_cast<std::uint8_t>(code);
  status.message = message;
  return status;
}

kr3_msgs::Status okStatus()
{
  return makeStatus(ErrorCode::kOk, "");
}

kr3_msgs::Status statusFromCurrentException()
{
  try
  {
    throw;
  }
  catch (const Error& e)
  {
    return makeStatus(e.code(), e.what());
  }
  catch (const std::exception& e)
  {
    return makeStatus(ErrorCode::kInternal, e.what());
  }
  catch (...)
  {
    return makeStatus(ErrorCode::kInternal, "an exception of unknown type");
  }
}

void logFailure(const std::string& request, const kr3_msgs::Status& status)
{
  ROS_ERROR("%s: %s: %s", request.c_str(), toString(static_cast<ErrorCode>(status.code)),
            status.message.c_str());
}

}  // namespace kr3
