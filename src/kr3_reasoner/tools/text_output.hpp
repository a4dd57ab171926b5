#pragma once

#include <string>

#include "commands.hpp"

namespace kr3::reasoner::tool
{

/// The answer of a command as people read it.
[[nodiscard]] std::string textOf(const Arguments& arguments, const Json& answer);

}  // namespace kr3::reasoner::tool
