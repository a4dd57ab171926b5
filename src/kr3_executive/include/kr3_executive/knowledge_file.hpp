#pragma once

#include <optional>
#include <string>

#include "kr3_executive/driver.hpp"

namespace kr3::executive
{

/// Writes knowledge as JSON; the old file stays whole until the new one is.
/// @throws Unavailable  the file cannot be written
void writeKnowledge(const std::string& path, const Knowledge& knowledge);

/// @return nothing when there is no such file
/// @throws Unavailable      it cannot be read
/// @throws InvalidArgument  it is malformed
[[nodiscard]] std::optional<Knowledge> readKnowledge(const std::string& path);

}  // namespace kr3::executive
