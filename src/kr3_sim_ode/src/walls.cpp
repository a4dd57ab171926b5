#include <algorithm>
#include <cmath>
#include <map>

#include "kr3_sim_ode/building.hpp"

namespace kr3::sim
{

namespace
{
struct Interval
{
  double from = 0.0;
  double to = 0.0;
  bool cut_from = false;  ///< the end is the side of a door
  bool cut_to = false;
};

enum class Axis
{
  kX,
  kY,
};

/// A line that walls stand on: parallel to an axis, at a coordinate in micrometres (so that it can
/// be compared).
struct Line
{
  Axis axis;
  long long offset_um;

  bool operator<(const Line& other) const
  {
    return axis != other.axis ? axis < other.axis : offset_um < other.offset_um;
  }
};

Line lineAt(Axis axis, double offset_m)
{
  return {axis, std::llround(offset_m * 1e6)};
}

std::vector<Interval> merged(std::vector<Interval> intervals)
{
  std::sort(intervals.begin(), intervals.end(),
            [](const Interval& a, const Interval& b) { return a.from < b.from; });
  std::vector<Interval> result;
  for (const Interval& interval : intervals)
  {
    if (!result.empty() && interval.from <= result.back().to + 1e-6)
    {
      result.back().to = std::max(result.back().to, interval.to);
    }
    else
    {
      result.push_back(interval);
    }
  }
  return result;
}

std::vector<Interval> withOpening(const std::vector<Interval>& intervals, double from, double to)
{
  std::vector<Interval> result;
  for (const Interval& interval : intervals)
  {
    if (to <= interval.from || from >= interval.to)
    {
      result.push_back(interval);
      continue;
    }
    if (from > interval.from)
    {
      result.push_back({interval.from, from, interval.cut_from, true});
    }
    if (to < interval.to)
    {
      result.push_back({to, interval.to, true, interval.cut_to});
    }
  }
  return result;
}
}  // namespace

std::vector<Box> wallsOf(const Building& building)
{
  std::map<Line, std::vector<Interval>> lines;
  for (const Place& place : building.places)
  {
    const Rectangle& r = place.rectangle;
    lines[lineAt(Axis::kX, r.y0)].push_back({r.x0, r.x1});
    lines[lineAt(Axis::kX, r.y1)].push_back({r.x0, r.x1});
    lines[lineAt(Axis::kY, r.x0)].push_back({r.y0, r.y1});
    lines[lineAt(Axis::kY, r.x1)].push_back({r.y0, r.y1});
  }

  std::map<Line, std::vector<Interval>> openings;
  for (const Door& door : building.doors)
  {
    const Rectangle& r = building.place(door.place_a).rectangle;
    const bool along_x = std::abs(door.y - r.y0) < 1e-6 || std::abs(door.y - r.y1) < 1e-6;
    const double middle = along_x ? door.x : door.y;
    openings[lineAt(along_x ? Axis::kX : Axis::kY, along_x ? door.y : door.x)].push_back(
        {middle - door.width_m / 2.0, middle + door.width_m / 2.0});
  }

  // Walls reach half a thickness into their neighbours at corners, less a millimetre, so that no
  // two visible faces lie in one plane.
  const double reach = building.wall_thickness_m / 2.0 - 0.001;
  std::vector<Box> walls;
  for (const auto& [line, raw_intervals] : lines)
  {
    std::vector<Interval> intervals = merged(raw_intervals);
    for (const Interval& opening : openings[line])
    {
      intervals = withOpening(intervals, opening.from, opening.to);
    }
    const double offset = static_cast<double>(line.offset_um) * 1e-6;
    for (const Interval& interval : intervals)
    {
      const double from = interval.from - (interval.cut_from ? 0.0 : reach);
      const double to = interval.to + (interval.cut_to ? 0.0 : reach);
      const double middle = (from + to) / 2.0;
      const double z = building.wall_height_m / 2.0;
      walls.push_back(
          line.axis == Axis::kX
              ? Box{{middle, offset, z}, {to - from, building.wall_thickness_m, 2.0 * z}}
              : Box{{offset, middle, z}, {building.wall_thickness_m, to - from, 2.0 * z}});
    }
  }
  return walls;
}

}  // namespace kr3::sim
