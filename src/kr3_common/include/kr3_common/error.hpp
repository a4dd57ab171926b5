#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

namespace kr3
{

/// What a caller can act on. The values equal the constants of kr3_msgs/Status.
enum class ErrorCode : std::uint8_t
{
  kOk = 0,
  kInvalidArgument = 1,     ///< the request itself is wrong: malformed, unknown name, out of range
  kNotFound = 2,            ///< it names something that does not exist (any more)
  kFailedPrecondition = 3,  ///< it is right, but not in this state
  kUnavailable = 4,         ///< a peer, a sensor or a file is missing; try again later
  kResourceExhausted = 5,   ///< a limit of memory, size or count was reached
  kDeadlineExceeded = 6,    ///< the time allowed ran out
  kCancelled = 7,           ///< the client cancelled, or the program shuts down
  kInternal = 8,            ///< a defect of ours
};

/// "INVALID_ARGUMENT" for ErrorCode::kInvalidArgument, and so on.
[[nodiscard]] const char* toString(ErrorCode code);

/// The place in our code that raised an error. As a default argument `current()` is the caller's
/// place.
struct SourceLocation
{
  const char* file = "";
  int line = 0;

  static constexpr SourceLocation current(const char* file = __builtin_FILE(),
                                          int line = __builtin_LINE())
  {
    return {file, line};
  }
};

/// Base of everything that KR3's cores throw. `what()` says what was found and what was expected.
class Error : public std::runtime_error
{
public:
  Error(ErrorCode code, const std::string& what, SourceLocation where = SourceLocation::current())
    : std::runtime_error(what), code_(code), where_(where)
  {
  }

  [[nodiscard]] ErrorCode code() const noexcept { return code_; }
  [[nodiscard]] SourceLocation where() const noexcept { return where_; }

private:
  ErrorCode code_;
  SourceLocation where_;
};

/// An Error whose code is part of its type, so that a caller can catch just that one.
template <ErrorCode kCode>
class CodedError : public Error
{
public:
  explicit CodedError(const std::string& what, SourceLocation where = SourceLocation::current())
    : Error(kCode, what, where)
  {
  }
};

using InvalidArgument = CodedError<ErrorCode::kInvalidArgument>;
using NotFound = CodedError<ErrorCode::kNotFound>;
using FailedPrecondition = CodedError<ErrorCode::kFailedPrecondition>;
using Unavailable = CodedError<ErrorCode::kUnavailable>;
using ResourceExhausted = CodedError<ErrorCode::kResourceExhausted>;
using DeadlineExceeded = CodedError<ErrorCode::kDeadlineExceeded>;
using Cancelled = CodedError<ErrorCode::kCancelled>;
using InternalError = CodedError<ErrorCode::kInternal>;

}  // namespace kr3
