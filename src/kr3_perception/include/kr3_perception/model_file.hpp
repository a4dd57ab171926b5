#pragma once

#include <string>

#include "kr3_perception/detector_model.hpp"

namespace kr3::perception
{

/// Writes a model as an OpenCV FileStorage; a name that ends in ".gz" is compressed. The file
/// appears complete or not at all.
/// @throws Unavailable  the file cannot be written
void saveModel(const DetectorModel& model, const std::string& path);

/// @throws Unavailable      the file cannot be read
/// @throws InvalidArgument  it is not a model, or an inconsistent one
[[nodiscard]] DetectorModel loadModel(const std::string& path);

}  // namespace kr3::perception
