#include "kr3_refinement/component_map.hpp"

#include <cmath>
#include <string>

#include <kr3_common/error.hpp>

namespace kr3::refinement
{

ComponentMap::ComponentMap(ComponentMapData data) : data_(std::move(data))
{
  const std::size_t count = data_.components.size();
  for (std::size_t i = 0; i < count; ++i)
  {
    const Component& component = data_.components[i];
    if (component.name.empty() || component.part_of.empty())
    {
      throw InvalidArgument("component " + std::to_string(i) +
                            " of the map has no name, or is part of nothing");
    }
    if (!index_.emplace(component.name, i).second)
    {
      throw InvalidArgument("the map has two components named '" + component.name + "'");
    }
  }
  if (data_.neighbors.empty())
  {
    data_.neighbors.resize(count);
  }
  if (data_.distances_m.empty())
  {
    data_.distances_m.assign(count * count, 0.0);
  }
  if (data_.neighbors.size() != count || data_.distances_m.size() != count * count)
  {
    throw InvalidArgument("a map of " + std::to_string(count) + " components has neighbours of " +
                          std::to_string(data_.neighbors.size()) + " and " +
                          std::to_string(data_.distances_m.size()) + " distances, expected " +
                          std::to_string(count) + " and " + std::to_string(count * count));
  }
  for (std::size_t i = 0; i < count; ++i)
  {
    for (const std::size_t neighbor : data_.neighbors[i])
    {
      if (neighbor >= count)
      {
        throw InvalidArgument("'" + data_.components[i].name + "' has neighbour " +
                              std::to_string(neighbor) + " of " + std::to_string(count));
      }
    }
    for (std::size_t j = 0; j < count; ++j)
    {
      const double value = distance(i, j);
      if (std::isnan(value) || value < 0.0)
      {
        throw InvalidArgument("the distance from '" + data_.components[i].name + "' to '" +
                              data_.components[j].name + "' is " + std::to_string(value) +
                              ", expected a length in m or infinity");
      }
    }
  }
}

std::optional<std::size_t> ComponentMap::find(const std::string& name) const
{
  const auto entry = index_.find(name);
  return entry == index_.end() ? std::nullopt : std::optional<std::size_t>(entry->second);
}

ComponentMap gridMap(const std::vector<std::string>& wholes, std::size_t per_whole, double pitch_m)
{
  if (wholes.empty() || per_whole == 0 || !(pitch_m > 0.0))
  {
    throw InvalidArgument(
        "a grid map needs at least one whole, one component in each and a positive pitch");
  }
  struct Point
  {
    std::size_t x;
    std::size_t y;
  };
  const auto width = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(per_whole))));
  ComponentMapData data;
  std::vector<Point> points;
  for (std::size_t whole = 0; whole < wholes.size(); ++whole)
  {
    for (std::size_t i = 0; i < per_whole; ++i)
    {
      data.components.push_back({wholes[whole] + "_c" + std::to_string(i), wholes[whole]});
      points.push_back({whole * (width + 1) + i % width, i / width});
    }
  }
  const auto apart = [](std::size_t a, std::size_t b) { return a > b ? a - b : b - a; };
  data.neighbors.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    for (std::size_t j = 0; j < points.size(); ++j)
    {
      const std::size_t steps = apart(points[i].x, points[j].x) + apart(points[i].y, points[j].y);
      data.distances_m.push_back(pitch_m * static_cast<double>(steps));
      if (steps == 1)
      {
        data.neighbors[i].push_back(j);
      }
    }
  }
  return ComponentMap(std::move(data));
}

}  // namespace kr3::refinement
