#include "markers.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>
#include <vector>

#include "../literal_text.hpp"

namespace kr3::executive
{
namespace
{

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

constexpr double kLeastShown = 0.01;  // probability
constexpr double kLayer_m = 0.12;     // between the boxes of two fluents
constexpr double kTextHeight_m = 0.25;
constexpr std::array<std::array<float, 3>, 4> kColors{
    {{0.9F, 0.5F, 0.1F}, {0.2F, 0.5F, 0.9F}, {0.2F, 0.7F, 0.3F}, {0.7F, 0.3F, 0.8F}}};

Marker marker(const std_msgs::Header& header, const std::string& kind, std::size_t id, int type)
{
  Marker message;
  message.header = header;
  message.ns = kind;
  message.id = static_cast<int>(id);
  message.type = type;
  message.pose.orientation.w = 1.0;
  message.color.a = 1.0F;
  return message;
}

Marker text(const std_msgs::Header& header, const std::string& kind, std::size_t id,
            const geometry_msgs::Point& position, const std::string& words)
{
  Marker message = marker(header, kind, id, Marker::TEXT_VIEW_FACING);
  message.pose.position = position;
  message.scale.z = kTextHeight_m;
  message.text = words;
  return message;
}

MarkerArray cleared(const std_msgs::Header& header)
{
  MarkerArray message;
  message.markers.push_back(marker(header, "all", 0, Marker::CUBE));
  message.markers.back().action = Marker::DELETEALL;
  return message;
}

std::string percent(double probability)
{
  char digits[16];
  std::snprintf(digits, sizeof digits, "%.0f %%", 100.0 * probability);
  return digits;
}

}  // namespace

MissionMarkers::MissionMarkers(const kr3_msgs::CellArray& cells) : header_(cells.header)
{
  std::map<std::string, double> number;
  for (const auto& cell : cells.cells)
  {
    cells_[cell.name] = {cell.center, cell.size_x, cell.size_y};
    geometry_msgs::Point& place = places_[cell.room];
    const double n = ++number[cell.room];
    place.x += (cell.center.x - place.x) / n;
    place.y += (cell.center.y - place.y) / n;
    place.z += (cell.center.z - place.z) / n;
  }
}

MarkerArray MissionMarkers::of(const kr3_msgs::BeliefState& belief) const
{
  std_msgs::Header header = header_;
  header.stamp = belief.header.stamp;
  MarkerArray message = cleared(header);
  std::size_t shown = 0;
  for (const auto& fluent : belief.fluents)
  {
    const std::size_t size = std::min(fluent.values.size(), fluent.probabilities.size());
    bool any = false;
    for (std::size_t i = 0; i < size; ++i)
    {
      const auto cell = cells_.find(fluent.values[i]);
      if (cell == cells_.end() || fluent.probabilities[i] < kLeastShown)
        continue;
      any = true;
      const auto& color = kColors[shown % kColors.size()];
      Marker box = marker(header, fluent.fluent, i, Marker::CUBE);
      box.pose.position = cell->second.center;
      box.pose.position.z += kLayer_m * static_cast<double>(shown);
      box.scale.x = std::max(0.9 * cell->second.size_x, 0.05);
      box.scale.y = std::max(0.9 * cell->second.size_y, 0.05);
      box.scale.z = 0.05;
      box.color.r = color[0];
      box.color.g = color[1];
      box.color.b = color[2];
      box.color.a = static_cast<float>(std::min(fluent.probabilities[i], 1.0));
      message.markers.push_back(box);
      geometry_msgs::Point above = box.pose.position;
      above.z += 0.1;
      message.markers.push_back(text(header, fluent.fluent + " text", i, above,
                                     fluent.fluent + " " + percent(fluent.probabilities[i])));
    }
    shown += any ? 1 : 0;
  }
  return message;
}

MarkerArray MissionMarkers::of(const kr3_msgs::MissionState& mission) const
{
  std_msgs::Header header = header_;
  header.stamp = mission.header.stamp;
  MarkerArray message = cleared(header);
  if (mission.plan_index < 0)
    return message;
  Marker line = marker(header, "plan", 0, Marker::LINE_STRIP);
  line.scale.x = 0.06;
  line.color.g = 0.6F;
  std::map<std::string, int> stacked;  // texts at a place
  std::string place;
  for (std::size_t i = static_cast<std::size_t>(mission.plan_index); i < mission.plan.steps.size();
       ++i)
  {
    for (const auto& action : mission.plan.steps[i].actions)
    {
      for (const auto& argument : takeApart(action).arguments)
        place = places_.count(argument) > 0 ? argument : place;
      if (place.empty())
        continue;
      geometry_msgs::Point at = places_.at(place);
      line.points.push_back(at);
      at.z += 0.5 + kTextHeight_m * stacked[place]++;
      message.markers.push_back(
          text(header, "step", message.markers.size(), at, std::to_string(i + 1) + " " + action));
    }
  }
  if (line.points.size() > 1)
    message.markers.push_back(line);
  return message;
}

}  // namespace kr3::executive
