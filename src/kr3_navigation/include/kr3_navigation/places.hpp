#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "kr3_navigation/geometry.hpp"

namespace kr3::navigation
{

/// A room or corridor as the building file names it.
struct Place
{
  std::string name;     ///< lower-case identifier, unique
  Rectangle rectangle;  ///< map frame
};

/// Reads the section `places` of a building file and ignores the others:
///
///     places:
///       - {name: office, rectangle: [x_min, y_min, x_max, y_max]}
///
/// @throws Unavailable      the file cannot be read
/// @throws InvalidArgument  file and line, what was found and what was expected; places must not
/// overlap
[[nodiscard]] std::vector<Place> loadPlaces(const std::filesystem::path& path);

/// The same from text; `source` names it in errors.
[[nodiscard]] std::vector<Place> parsePlaces(const std::string& text, const std::string& source);

}  // namespace kr3::navigation
