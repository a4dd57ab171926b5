#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <unordered_map>

#include <yaml-cpp/yaml.h>

#include <kr3_common/error.hpp>

#include "kr3_refinement/component_map.hpp"

namespace kr3::refinement
{
namespace
{

struct Point
{
  double x_m = 0.0;
  double y_m = 0.0;
};

class MapReader
{
public:
  explicit MapReader(std::string file) : file_(std::move(file)) {}

  ComponentMap read(const YAML::Node& root)
  {
    checkKeys(root, "the map", {"components", "neighbors", "facts"});
    stopOnProblems();
    const YAML::Node components = root["components"];
    if (!components.IsDefined() || !components.IsSequence())
    {
      report(root, "found no list 'components', expected entries as '{name: m1, part_of: d1}'");
      stopOnProblems();
    }
    for (const YAML::Node& node : components)
    {
      readComponent(node);
    }
    data_.neighbors.resize(data_.components.size());
    for (const YAML::Node& node : root["neighbors"])
    {
      readNeighbors(node);
    }
    for (const YAML::Node& node : root["facts"])
    {
      data_.facts.push_back(text(node, "a fact"));
    }
    stopOnProblems();
    if (!points_.empty())
    {
      for (const Point& a : points_)
      {
        for (const Point& b : points_)
        {
          data_.distances_m.push_back(std::hypot(a.x_m - b.x_m, a.y_m - b.y_m));
        }
      }
    }
    return ComponentMap(std::move(data_));
  }

private:
  void report(const YAML::Node& node, const std::string& message)
  {
    problems_ += (problems_.empty() ? "" : "\n") + file_ + ":" +
                 std::to_string(std::max(node.Mark().line, 0) + 1) + ": " + message;
  }

  void stopOnProblems() const
  {
    if (!problems_.empty())
    {
      throw InvalidArgument(problems_);
    }
  }

  void checkKeys(const YAML::Node& node, const std::string& what,
                 const std::vector<std::string>& keys)
  {
    if (!node.IsMap())
    {
      report(node, what + ": found no map");
      return;
    }
    for (const auto& entry : node)
    {
      const auto key = entry.first.as<std::string>();
      if (std::find(keys.begin(), keys.end(), key) == keys.end())
      {
        report(entry.first, what + ": unknown key '" + key + "', expected one of " + listed(keys));
      }
    }
  }

  [[nodiscard]] static std::string listed(const std::vector<std::string>& keys)
  {
    std::string result;
    for (const std::string& key : keys)
    {
      result += (result.empty() ? "'" : ", '") + key + "'";
    }
    return result;
  }

  std::string text(const YAML::Node& node, const std::string& what)
  {
    if (!node.IsDefined() || !node.IsScalar())
    {
      report(node, what + ": found no text");
      return {};
    }
    return node.Scalar();
  }

  void readComponent(const YAML::Node& node)
  {
    const std::size_t problems_before = problems_.size();
    checkKeys(node, "a component", {"name", "part_of", "at"});
    if (problems_.size() > problems_before)
    {
      return;
    }
    if (!node["name"].IsDefined() || !node["part_of"].IsDefined())
    {
      report(node, "a component needs 'name' and 'part_of'");
      return;
    }
    index_.emplace(node["name"].Scalar(), data_.components.size());
    data_.components.push_back({text(node["name"], "name"), text(node["part_of"], "part_of")});
    const YAML::Node at = node["at"];
    if (at.IsDefined())
    {
      Point point;
      const bool good = at.IsSequence() && at.size() == 2 &&
                        YAML::convert<double>::decode(at[0], point.x_m) &&
                        YAML::convert<double>::decode(at[1], point.y_m);
      if (!good)
      {
        report(at, "at: expected [x, y] in m");
      }
      points_.push_back(point);
    }
    if (points_.size() != (at.IsDefined() ? data_.components.size() : 0))
    {
      report(node, "either all components say where they are ('at: [x, y]') or none does");
    }
  }

  void readNeighbors(const YAML::Node& node)
  {
    std::vector<std::size_t> pair;
    for (const YAML::Node& end : node)
    {
      const auto component = end.IsScalar() ? index_.find(end.Scalar()) : index_.end();
      if (component == index_.end())
      {
        report(end, "neighbors: '" + (end.IsScalar() ? end.Scalar() : "") +
                        "' is no component of the map");
        return;
      }
      pair.push_back(component->second);
    }
    if (!node.IsSequence() || pair.size() != 2)
    {
      report(node, "neighbors: expected pairs, as [m1, m2]; both become neighbours of each other");
      return;
    }
    data_.neighbors[pair[0]].push_back(pair[1]);
    data_.neighbors[pair[1]].push_back(pair[0]);
  }

  std::string file_;
  std::string problems_;
  ComponentMapData data_;
  std::vector<Point> points_;
  std::unordered_map<std::string, std::size_t> index_;
};

}  // namespace

ComponentMap readComponentMap(const std::string& path)
{
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file.is_open() || file.bad())
  {
    throw Unavailable("cannot read '" + path + "'");
  }
  try
  {
    return MapReader(path).read(YAML::Load(text.str()));
  }
  catch (const YAML::Exception& error)
  {
    throw InvalidArgument(path + ":" + std::to_string(error.mark.line + 1) + ": " + error.msg);
  }
}

}  // namespace kr3::refinement
