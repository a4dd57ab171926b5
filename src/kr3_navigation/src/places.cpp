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

constexpr double kTouch = 0.01;  // m: rectangles that share a wall may overlap by rounding

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
    if (std::isfinite(value))
      return value;
  }
  catch (const YAML::Exception&)
  {
    // reported below
  }
  fail(source, node.Mark(),
       "expected a number in metres" + (node.IsScalar() ? ", found '" + node.Scalar() + "'" : ""));
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

}  // namespace

std::vector<Place> parsePlaces(const std::string& text, const std::string& source)
{
  YAML::Node root;
  try
  {
    root = YAML::Load(text);
  }
  catch (const YAML::ParserException& e)
  {
    fail(source, e.mark, e.msg);
  }
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

std::vector<Place> loadPlaces(const std::filesystem::path& path)
{
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file)
    throw Unavailable("cannot read the building file " + path.string());
  return parsePlaces(text.str(), path.string());
}

}  // namespace kr3::navigation
