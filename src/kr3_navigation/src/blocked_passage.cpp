#include "kr3_navigation/blocked_passage.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

namespace kr3::navigation
{
namespace
{

constexpr double kDoorDepth = 0.5;  // m before and behind a door's centre that belong to it
constexpr double kStep = 0.05;      // m along a way

std::string textOf(Point p)
{
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "(%.2f, %.2f)", p.x, p.y);
  return text.data();
}

const Place* placeAt(const std::vector<Place>& places, Point p)
{
  const auto place = std::find_if(places.begin(), places.end(),
                                  [&](const Place& each) { return each.rectangle.contains(p); });
  return place == places.end() ? nullptr : &*place;
}

const Door* doorAt(const std::vector<Door>& doors, Point p)
{
  const auto nearest = std::min_element(
      doors.begin(), doors.end(),
      [&](const Door& a, const Door& b) { return distance(a.center, p) < distance(b.center, p); });
  if (nearest == doors.end() ||
      distance(nearest->center, p) > std::max(nearest->width_m / 2.0, kDoorDepth))
    return nullptr;
  return &*nearest;
}

std::string doorText(const Door& door)
{
  return "the door between " + door.place_a + " and " + door.place_b + " at " + textOf(door.center);
}

/// Points along the way, close enough together to see every node it crosses.
std::vector<Point> sampled(const std::vector<Point>& way)
{
  std::vector<Point> points;
  for (std::size_t i = 1; i < way.size(); ++i)
  {
    const int count = std::max(1, static_cast<int>(distance(way[i - 1], way[i]) / kStep));
    for (int k = 0; k < count; ++k)
    {
      const double t = static_cast<double>(k) / count;
      points.push_back({way[i - 1].x + t * (way[i].x - way[i - 1].x),
                        way[i - 1].y + t * (way[i].y - way[i - 1].y)});
    }
  }
  points.push_back(way.back());
  return points;
}

std::string describe(Point middle, const Place* before, const Place* after, const Place* in)
{
  if (before != nullptr && after != nullptr && before != after)
    return "the passage between " + before->name + " and " + after->name + " is blocked at " +
           textOf(middle);
  return "the way is blocked at " + textOf(middle) + (in == nullptr ? "" : " in " + in->name);
}

}  // namespace

std::optional<BlockedPassage> findBlockedPassage(const PathPlanner& given,
                                                 const PathPlanner& present, Point start,
                                                 Point goal, const std::vector<Place>& places,
                                                 const std::vector<Door>& doors)
{
  const PlannedPath path = given.plan(start, goal);
  if (!path.found())
    return std::nullopt;
  const std::vector<Point> points = sampled(path.points);
  const auto is_free = [&](Point p) { return present.isFree(p); };
  // The robot itself may stand where something is near: the way begins where it is free.
  auto here = std::find_if(points.begin(), points.end(), is_free);
  std::optional<BlockedPassage> first;
  while (here != points.end())
  {
    const auto blocked = std::find_if_not(here, points.end(), is_free);
    if (blocked == points.end())
      break;
    here = std::find_if(blocked, points.end(), is_free);
    // What blocks lies in the middle of the part that is not free, for obstacles are inflated.
    const Point middle = *(blocked + std::distance(blocked, here) / 2);
    if (const Door* door = doorAt(doors, middle))
      return BlockedPassage{middle, doorText(*door) + " is shut or blocked"};
    if (first)
      continue;
    const Point after = here == points.end() ? *blocked : *here;
    first = BlockedPassage{middle, describe(middle, placeAt(places, *blocked),
                                            placeAt(places, after), placeAt(places, middle))};
  }
  return first;
}

std::string describeShutDoors(const PathPlanner& planner, Point goal,
                              const std::vector<Place>& places, const std::vector<Door>& doors)
{
  const Place* place = placeAt(places, goal);
  if (place == nullptr)
    return {};
  std::string shut;
  for (const Door& door : doors)
  {
    if (door.place_a != place->name && door.place_b != place->name)
      continue;
    if (planner.isFree(door.center))
      return {};
    shut += (shut.empty() ? "" : ", ") + doorText(door);
  }
  return shut.empty() ? shut : "every door of " + place->name + " is shut in the map: " + shut;
}

}  // namespace kr3::navigation
