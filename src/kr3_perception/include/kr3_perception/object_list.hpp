#pragma once

#include <string>
#include <vector>

#include "kr3_perception/detector_model.hpp"

namespace kr3::perception
{

/// Reads names, classes and sizes from a domain's objects file.
/// @throws Unavailable      the file cannot be read
/// @throws InvalidArgument  it is malformed; the message names file and object
[[nodiscard]] std::vector<ObjectDescription> loadObjectList(const std::string& path);

}  // namespace kr3::perception
