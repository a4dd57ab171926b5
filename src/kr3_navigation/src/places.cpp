#include "kr3_navigation/places.hpp"

#include <algorithm>
#include <fstream>
#include <sstream>

#include <yaml-cpp/yaml.h>

#include <kr3_common/error.hpp>

namespace kr3::navigation
{
namespace
{

constexpr double kFarthest = 10e3;  // m
constexpr double kTouch = 0.01;     // m: rectangles that share a wall may overlap by rounding

[[noreturn]] void fail(const std::string& source, const YAML::Mark& mark,
                       const std::string& problem)
{
  std::string where = source;
  if (!mark.is_null())
    where += ":" + std::to_string(mark.line + 1) + ":" + std::to_string(mark.column + 1);
  throw InvalidArgument(where + ": " + problem);
}

bool isIdentifier(const std::string& text)
{
  const auto allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  };
  return !text.empty() && text.front() >= 'a' && text.front() <= 'z' &&
         std::all_of(text.begin(), text.end(), allowed);
}

double numberOf(const YAML::Node& node, const std::string& source)
{
  try
  {
    const double value = node.as<double>();
    if (std::abs(value) <= kFarthest)
      return value;
  }
  catch (const YAML::Exception&)
  {
    // reported below
  }
  fail(source, node.Mark(),
       "expected a number in metres, within 10 km of the origin" +
           (node.IsScalar() ? ", found '" + node.Scalar() + "'" : ""));
}

Rectangle rectangleOf(const YAML::Node& node, const std::string& source,
                      const YAML::Mark& place_mark)
{
  if (!node)
    fail(source, place_mark, "the place has no `rectangle: [x_min, y_min, x_max, y_max]`");
  if (!node.IsSequence() || node.size() != 4)
    fail(source, node.Mark(),
         "`rectangle` must be a list of 4 numbers [x_min, y_min, x_max, y_max]" +
             (node.IsSequence() ? ", found " + std::to_string(node.size()) : std::string()));
  const Rectangle rectangle{numberOf(node[0], source), numberOf(node[1], source),
                            numberOf(node[2], source), numberOf(node[3], source)};
  if (!(rectangle.x_min < rectangle.x_max && rectangle.y_min < rectangle.y_max))
    fail(source, node.Mark(), "`rectangle` must have x_min < x_max and y_min < y_max");
  return rectangle;
}

bool overlap(const Rectangle& a, const Rectangle& b)
{
  return std::min(a.x_max, b.x_max) - std::max(a.x_min, b.x_min) > kTouch &&
         std::min(a.y_max, b.y_max) - std::max(a.y_min, b.y_min) > kTouch;
}

YAML::Node parsed(const std::string& text, const std::string& source)
{
  try
  {
    return YAML::Load(text);
  }
  catch (const YAML::ParserException& e)
  {
    fail(source, e.mark, e.msg);
  }
}

std::string textOf(const std::filesystem::path& path)
{
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file)
    throw Unavailable("cannot read the building file " + path.string());
  return text.str();
}

Door doorOf(const YAML::Node& entry, const std::string& source, const std::vector<Place>& places)
{
  if (!entry.IsMap())
    fail(source, entry.Mark(),
         "a door must be written {between: [place, place], center: [x, y], width: ...}");
  const YAML::Node between = entry["between"];
  if (!between || !between.IsSequence() || between.size() != 2 || !between[0].IsScalar() ||
      !between[1].IsScalar())
    fail(source, between ? between.Mark() : entry.Mark(), "a door needs `between: [place, place]`");
  for (const YAML::Node& name : between)
  {
    if (std::none_of(places.begin(), places.end(),
                     [&](const Place& place) { return place.name == name.Scalar(); }))
      fail(source, name.Mark(), "there is no place '" + name.Scalar() + "'");
  }
  const YAML::Node center = entry["center"];
  if (!center || !center.IsSequence() || center.size() != 2)
    fail(source, center ? center.Mark() : entry.Mark(), "a door needs `center: [x, y]`");
  const YAML::Node width = entry["width"];
  if (!width)
    fail(source, entry.Mark(), "a door needs a `width` in metres");
  const Door door{between[0].Scalar(),
                  between[1].Scalar(),
                  {numberOf(center[0], source), numberOf(center[1], source)},
                  numberOf(width, source)};
  if (!(door.width_m > 0.0))
    fail(source, width.Mark(), "the width of a door must be greater than 0");
  return door;
}

}  // namespace

std::vector<Place> parsePlaces(const std::string& text, const std::string& source)
{
  const YAML::Node root = parsed(text, source);
  if (!root.IsMap() || !root["places"])
    fail(source, root.Mark(), "expected a section `places`");
  const YAML::Node list = root["places"];
  if (!list.IsSequence() || list.size() == 0)
    fail(source, list.Mark(), "`places` must be a list with at least one place");

  std::vector<Place> places;
  for (const YAML::Node& entry : list)
  {
    if (!entry.IsMap())
      fail(source, entry.Mark(), "a place must be written {name: ..., rectangle: [...]}");
    const YAML::Node name = entry["name"];
    if (!name || !name.IsScalar() || !isIdentifier(name.Scalar()))
      fail(source, name ? name.Mark() : entry.Mark(),
           "a place needs a `name` of lower-case letters, digits and _" +
               (name && name.IsScalar() ? ", found '" + name.Scalar() + "'" : std::string()));
    const Place place{name.Scalar(), rectangleOf(entry["rectangle"], source, entry.Mark())};
    for (const Place& other : places)
    {
      if (other.name == place.name)
        fail(source, name.Mark(), "the place '" + place.name + "' is defined twice");
      if (overlap(other.rectangle, place.rectangle))
        fail(source, entry.Mark(), "the place '" + place.name + "' overlaps '" + other.name + "'");
    }
    places.push_back(place);
  }
  return places;
}

Rectangle areaOf(const std::vector<Place>& places, double margin_m)
{
  Rectangle area = places.front().rectangle;
  for (const Place& place : places)
  {
    area = {
        std::min(area.x_min, place.rectangle.x_min), std::min(area.y_min, place.rectangle.y_min),
        std::max(area.x_max, place.rectangle.x_max), std::max(area.y_max, place.rectangle.y_max)};
  }
  return area.shrunk(-margin_m);
}

std::vector<Place> loadPlaces(const std::filesystem::path& path)
{
  return parsePlaces(textOf(path), path.string());
}

std::vector<Door> parseDoors(const std::string& text, const std::string& source,
                             const std::vector<Place>& places)
{
  const YAML::Node root = parsed(text, source);
  std::vector<Door> doors;
  if (!root.IsMap() || !root["doors"])
    return doors;
  const YAML::Node list = root["doors"];
  if (!list.IsSequence() && !list.IsNull())
    fail(source, list.Mark(), "`doors` must be a list");
  for (const YAML::Node& entry : list)
    doors.push_back(doorOf(entry, source, places));
  return doors;
}

std::vector<Door> loadDoors(const std::filesystem::path& path, const std::vector<Place>& places)
{
  return parseDoors(textOf(path), path.string(), places);
}

}  // namespace kr3::navigation
