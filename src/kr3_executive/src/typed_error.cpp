#include "typed_error.hpp"

namespace kr3::executive
{

void throwError(ErrorCode code, const std::string& message)
{
  switch (code)
  {
    case ErrorCode::kInvalidArgument:
      throw InvalidArgument(message);
    case ErrorCode::kNotFound:
      throw NotFound(message);
    case ErrorCode::kFailedPrecondition:
      throw FailedPrecondition(message);
    case ErrorCode::kUnavailable:
      throw Unavailable(message);
    case ErrorCode::kResourceExhausted:
      throw ResourceExhausted(message);
    case ErrorCode::kDeadlineExceeded:
      throw DeadlineExceeded(message);
    case ErrorCode::kCancelled:
      throw Cancelled(message);
    case ErrorCode::kOk:
    case ErrorCode::kInternal:
      break;
  }
  throw InternalError(message);
}

}  // namespace kr3::executive
