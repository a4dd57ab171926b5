#pragma once

#include <string>
#include <vector>

#include "kr3_perception/detector_model.hpp"
#include "kr3_perception/labelled_folder.hpp"

namespace kr3::perception
{

/// Reads names, classes and sizes from a domain's objects file.
/// @throws Unavailable      the file cannot be read
/// @throws InvalidArgument  it is malformed; the message names file and object
[[nodiscard]] std::vector<ObjectDescription> loadObjectList(const std::string& path);

/// The objects that the labels name, by name: each is a class of its own, of unknown size.
[[nodiscard]] std::vector<ObjectDescription> objectsOf(const std::vector<LabelledFolder>& folders);

}  // namespace kr3::perception
