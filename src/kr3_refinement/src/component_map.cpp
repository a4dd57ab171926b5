#include "kr3_refinement/component_map.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <kr3_common/error.hpp>

#include "problems.hpp"

namespace kr3::refinement
{

ComponentMap::ComponentMap(ComponentMapData data) : data_(std::move(data))
{
  const std::size_t count = data_.components.size();
  if (data_.neighbors.empty())
  {
    data_.neighbors.resize(count);
  }
  has_distances_ = count == 0 || !data_.distances_m.empty();
  if (data_.distances_m.empty())
  {
    data_.distances_m.assign(count * count, 0.0);
  }
  if (data_.neighbors.size() != count || data_.distances_m.size() != count * count)
  {
    throw InvalidArgument(data_.source + ": a map of " + std::to_string(count) +
                          " components has neighbours of " +
                          std::to_string(data_.neighbors.size()) + " and " +
                          std::to_string(data_.distances_m.size()) + " distances, expected " +
                          std::to_string(count) + " and " + std::to_string(count * count));
  }
  Problems problems;
  checkNames(problems);
  problems.throwIfAny();
  for (std::size_t i = 0; i < count; ++i)
  {
    checkNeighbors(i, problems);
    checkDistances(i, problems);
  }
  problems.throwIfAny();
}

void ComponentMap::checkNames(Problems& problems)
{
  for (std::size_t i = 0; i < size(); ++i)
  {
    const Component& component = data_.components[i];
    const reasoner::SourcePosition at{data_.source, component.line, 0};
    if (component.name.empty() || component.part_of.empty())
    {
      problems.add(
          at, "component " + std::to_string(i) + " of the map has no name, or is part of nothing");
      continue;
    }
    const auto [first, is_new] = index_.emplace(component.name, i);
    const Component& other = data_.components[first->second];
    if (!is_new)
    {
      problems.add(at, "the map has two components named '" + component.name + "', parts of '" +
                           other.part_of + "' and of '" + component.part_of +
                           "'; a component is part of one whole, rename or leave one of them");
    }
  }
}

void ComponentMap::checkNeighbors(std::size_t component, Problems& problems) const
{
  const Component& from = data_.components[component];
  const reasoner::SourcePosition at{data_.source, from.line, 0};
  for (const std::size_t neighbor : data_.neighbors[component])
  {
    if (neighbor >= size())
    {
      problems.add(at, "'" + from.name + "' has neighbour " + std::to_string(neighbor) + " of " +
                           std::to_string(size()));
      continue;
    }
    const std::vector<std::size_t>& back = data_.neighbors[neighbor];
    if (neighbor == component)
    {
      problems.add(at, "'" + from.name + "' is its own neighbour; leave that out");
    }
    else if (std::find(back.begin(), back.end(), component) == back.end())
    {
      problems.add(at, "'" + data_.components[neighbor].name + "' is a neighbour of '" + from.name +
                           "', but not the other way round; expected both");
    }
  }
}

void ComponentMap::checkDistances(std::size_t component, Problems& problems) const
{
  const Component& from = data_.components[component];
  for (std::size_t j = 0; j < size(); ++j)
  {
    const double value = distance(component, j);
    if (std::isnan(value) || value < 0.0)
    {
      problems.add({data_.source, from.line, 0},
                   "the distance from '" + from.name + "' to '" + data_.components[j].name +
                       "' is " + std::to_string(value) + ", expected a length in m or infinity");
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
