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

/// An opening between two places, as the building file names it.
struct Door
{
  std::string place_a;
  std::string place_b;
  Point center;  ///< map frame
  double width_m = 1.0;
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

/// Reads the section `doors` of a building file; none when it has no such section:
///
///     doors:
///       - {between: [office, corridor], center: [x, y], width: 1.0}
///
/// @param places  those of the same file: a door must join two of them
/// @throws Unavailable, InvalidArgument  as loadPlaces()
[[nodiscard]] std::vector<Door> loadDoors(const std::filesystem::path& path,
                                          const std::vector<Place>& places);

/// The same from text; `source` names it in errors.
[[nodiscard]] std::vector<Door> parseDoors(const std::string& text, const std::string& source,
                                           const std::vector<Place>& places);

/// The rectangle around all places, `margin_m` wider on every side. At least one place.
[[nodiscard]] Rectangle areaOf(const std::vector<Place>& places, double margin_m);

}  // namespace kr3::navigation
