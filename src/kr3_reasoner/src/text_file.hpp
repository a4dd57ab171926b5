#pragma once

#include <string>

namespace kr3::reasoner
{

/// The contents of a file. Private to the package.
/// @throws NotFound  it cannot be read, or is a folder
[[nodiscard]] std::string readTextFile(const std::string& path);

}  // namespace kr3::reasoner
