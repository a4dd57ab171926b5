#pragma once

#include <string>

#include <kr3_common/error.hpp>

namespace kr3::executive
{

/// Throws the error type of a code that was received or recorded; kOk counts as a defect.
/// @throws Error  always
[[noreturn]] void throwError(ErrorCode code, const std::string& message);

}  // namespace kr3::executive
