#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>
#include <utility>

#include "kr3_refinement/component_map.hpp"
#include "yaml_file.hpp"

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
  explicit MapReader(YamlFile& file) : file_(file) {}

  ComponentMap read()
  {
    const YAML::Node& root = file_.root();
    if (file_.checkMap(root, "the map", {"components", "neighbors", "facts"}))
    {
      readComponents(root);
      for (const YAML::Node& node : list(root, "neighbors", "[[m1, m2], ...]"))
      {
        readNeighbors(node);
      }
      for (const YAML::Node& node : list(root, "facts", "[\"heavy(m1)\", ...]"))
      {
        data_.facts.push_back(text(node, "a fact"));
      }
    }
    file_.problems().throwIfAny();
    for (std::size_t i = 0; i < points_.size(); ++i)
    {
      for (const std::optional<Point>& b : points_)
      {
        data_.distances_m.push_back(std::hypot(points_[i]->x_m - b->x_m, points_[i]->y_m - b->y_m));
      }
    }
    data_.source = file_.name();
    return ComponentMap(std::move(data_));
  }

private:
  /// The items of a list; none, and a report, when there is something else.
  std::vector<YAML::Node> list(const YAML::Node& map, const std::string& key,
                               const std::string& example)
  {
    const YAML::Node node = YamlFile::entry(map, key);
    if (node.IsDefined() && !node.IsSequence())
    {
      file_.report(node,
                   key + ": found " + YamlFile::shown(node) + ", expected a list, as " + example);
      return {};
    }
    return node.IsDefined() ? std::vector<YAML::Node>(node.begin(), node.end())
                            : std::vector<YAML::Node>{};
  }

  std::string text(const YAML::Node& node, const std::string& what)
  {
    if (!node.IsDefined() || !node.IsScalar() || node.Scalar().empty())
    {
      file_.report(node, what + ": found " + YamlFile::shown(node) + ", expected a text");
      return {};
    }
    return node.Scalar();
  }

  void readComponents(const YAML::Node& root)
  {
    if (!YamlFile::entry(root, "components").IsDefined())
    {
      file_.report(root,
                   "found no list 'components', expected entries as '{name: m1, part_of: d1}'");
    }
    for (const YAML::Node& node : list(root, "components", "[{name: m1, part_of: d1}, ...]"))
    {
      readComponent(node);
    }
    data_.neighbors.resize(data_.components.size());
    const auto placed = static_cast<std::size_t>(
        std::count_if(points_.begin(), points_.end(), [](const auto& point) { return point; }));
    for (std::size_t i = 0; i < points_.size(); ++i)
    {
      if (placed > 0 && !points_[i])
      {
        file_.problems().add(
            {file_.name(), data_.components[i].line, 0},
            "'" + data_.components[i].name +
                "' does not say where it is, but others do; add 'at: [x, y]', in m");
      }
    }
    if (placed == 0)
    {
      points_.clear();
    }
  }

  void readComponent(const YAML::Node& node)
  {
    if (!file_.checkMap(node, "a component", {"name", "part_of", "at"}))
    {
      return;
    }
    if (!YamlFile::entry(node, "name").IsDefined() || !YamlFile::entry(node, "part_of").IsDefined())
    {
      file_.report(node, "a component needs 'name' and 'part_of'");
      return;
    }
    Component component{text(node["name"], "name"), text(node["part_of"], "part_of"),
                        YamlFile::line(node)};
    index_.emplace(component.name, data_.components.size());
    names_.push_back(component.name);
    data_.components.push_back(std::move(component));
    points_.push_back(point(YamlFile::entry(node, "at")));
  }

  std::optional<Point> point(const YAML::Node& at)
  {
    if (!at.IsDefined())
    {
      return std::nullopt;
    }
    if (!at.IsSequence() || at.size() != 2)
    {
      file_.report(at, "at: found " + YamlFile::shown(at) + ", expected [x, y] in m");
      return Point{};
    }
    return Point{file_.finite(at[0], "at, x").value_or(0.0),
                 file_.finite(at[1], "at, y").value_or(0.0)};
  }

  void readNeighbors(const YAML::Node& node)
  {
    if (!node.IsSequence() || node.size() != 2)
    {
      file_.report(node, "neighbors: found " + YamlFile::shown(node) +
                             ", expected pairs, as [m1, m2]; both become neighbours of each other");
      return;
    }
    std::vector<std::size_t> pair;
    for (const YAML::Node& end : node)
    {
      const std::string name = end.IsScalar() ? end.Scalar() : "";
      const auto component = index_.find(name);
      if (component == index_.end())
      {
        file_.report(end, "neighbors: " + YamlFile::shown(end) + " is no component of the map" +
                              suggestion(name, names_));
        return;
      }
      pair.push_back(component->second);
    }
    std::vector<std::size_t>& of_first = data_.neighbors[pair[0]];
    if (pair[0] == pair[1])
    {
      file_.report(node,
                   "neighbors: '" + names_[pair[0]] + "' is its own neighbour; leave that out");
    }
    else if (std::find(of_first.begin(), of_first.end(), pair[1]) != of_first.end())
    {
      file_.report(node, "neighbors: '" + names_[pair[0]] + "' and '" + names_[pair[1]] +
                             "' a second time; a pair counts both ways, leave one of them");
    }
    else
    {
      of_first.push_back(pair[1]);
      data_.neighbors[pair[1]].push_back(pair[0]);
    }
  }

  YamlFile& file_;
  ComponentMapData data_;
  std::vector<std::optional<Point>> points_;
  std::vector<std::string> names_;
  std::unordered_map<std::string, std::size_t> index_;
};

}  // namespace

ComponentMap readComponentMap(const std::string& path)
{
  YamlFile file(fileText(path), path);
  return MapReader(file).read();
}

}  // namespace kr3::refinement
