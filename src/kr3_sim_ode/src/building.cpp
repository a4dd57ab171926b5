#include "kr3_sim_ode/building.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <nlohmann/json.hpp>

#include <kr3_common/error.hpp>

#include "kr3_sim_ode/placement.hpp"
#include "yaml_reader.hpp"

namespace kr3::sim
{

namespace
{
constexpr double kTolerance = 1e-6;      // m; coordinates in a file are typed by people
constexpr double kFarthest = 10e3;       // m, from the origin
constexpr double kThickestWall = 1.0;    // m
constexpr double kHighestWall = 20.0;    // m
constexpr double kStartClearance = 0.2;  // m, half of the robot's length

/// The part of a door's border, from its middle to either side, that two places share.
double sharedHalfWidth(const Rectangle& a, const Rectangle& b, const Door& door)
{
  const double x = std::min({door.x - std::max(a.x0, b.x0), std::min(a.x1, b.x1) - door.x});
  const double y = std::min({door.y - std::max(a.y0, b.y0), std::min(a.y1, b.y1) - door.y});
  return std::max(x, y);
}

/// @throws InvalidArgument  a place that no sequence of doors joins with the first one
void checkDoorsLeadEverywhere(const YamlReader& yaml, const Building& building)
{
  std::set<std::string> reached{building.places.front().name};
  for (bool grew = true; grew;)
  {
    grew = false;
    for (const Door& door : building.doors)
    {
      if (reached.count(door.place_a) != reached.count(door.place_b))
      {
        reached.insert({door.place_a, door.place_b});
        grew = true;
      }
    }
  }
  for (std::size_t i = 0; i < building.places.size(); ++i)
  {
    if (reached.count(building.places[i].name) == 0)
    {
      yaml.fail(yaml.root()["places"][i], "no doors lead from '" + building.places.front().name +
                                              "' to '" + building.places[i].name + "'");
    }
  }
}

/// Whether the whole footprint lies in the rectangle.
bool isInside(const Furniture& furniture, const Rectangle& r)
{
  constexpr double kMargin = 1e-3;  // m
  const double c = std::abs(std::cos(furniture.pose.yaw));
  const double s = std::abs(std::sin(furniture.pose.yaw));
  const double half_x = (c * furniture.size.x + s * furniture.size.y) / 2.0 - kMargin;
  const double half_y = (s * furniture.size.x + c * furniture.size.y) / 2.0 - kMargin;
  return furniture.pose.x - half_x >= r.x0 && furniture.pose.x + half_x <= r.x1 &&
         furniture.pose.y - half_y >= r.y0 && furniture.pose.y + half_y <= r.y1;
}

/// Whether (x, y) lies on the border of the rectangle.
bool onBorder(const Rectangle& r, double x, double y)
{
  const bool on_x = std::abs(x - r.x0) < kTolerance || std::abs(x - r.x1) < kTolerance;
  const bool on_y = std::abs(y - r.y0) < kTolerance || std::abs(y - r.y1) < kTolerance;
  return (on_x && y > r.y0 && y < r.y1) || (on_y && x > r.x0 && x < r.x1);
}

/// A place's name in `key`. @throws InvalidArgument  the building has no such place
std::string placeName(const YamlReader& yaml, const YAML::Node& node, const std::string& key,
                      const Building& building)
{
  std::string name = yaml.text(node, key);
  try
  {
    (void)building.place(name);
  }
  catch (const NotFound& e)
  {
    yaml.fail(node[key], e.what());
  }
  return name;
}

void readPlaces(const YamlReader& yaml, Building& building)
{
  for (const YAML::Node& node : yaml.list(yaml.root(), "places"))
  {
    yaml.checkMap(node, "a place", {"name", "rectangle"});
    Place place;
    place.name = yaml.text(node, "name");
    const auto r = yaml.numbers(node, "rectangle", 4);
    place.rectangle = {r[0], r[1], r[2], r[3]};
    if (r[2] - r[0] < kTolerance || r[3] - r[1] < kTolerance)
    {
      yaml.fail(node["rectangle"], "'rectangle' must be [x0, y0, x1, y1] with x0 < x1 and y0 < y1");
    }
    if (std::any_of(r.begin(), r.end(), [](double v) { return std::abs(v) > kFarthest; }))
    {
      yaml.fail(node["rectangle"], "'rectangle' must be within 10 km of the origin");
    }
    for (const Place& other : building.places)
    {
      if (other.name == place.name)
      {
        yaml.fail(node["name"], "place '" + place.name + "' twice");
      }
      const Rectangle& o = other.rectangle;
      if (std::min(o.x1, r[2]) - std::max(o.x0, r[0]) > kTolerance &&
          std::min(o.y1, r[3]) - std::max(o.y0, r[1]) > kTolerance)
      {
        yaml.fail(node["rectangle"], "place '" + place.name + "' overlaps '" + other.name + "'");
      }
    }
    building.places.push_back(place);
  }
  if (building.places.empty())
  {
    yaml.fail(yaml.root()["places"], "a building needs at least one place");
  }
}

void readDoors(const YamlReader& yaml, Building& building)
{
  if (!yaml.root()["doors"])
  {
    return;
  }
  for (const YAML::Node& node : yaml.list(yaml.root(), "doors"))
  {
    yaml.checkMap(node, "a door", {"between", "center", "width"});
    const YAML::Node between = yaml.child(node, "between");
    if (!between.IsSequence() || between.size() != 2 || !between[0].IsScalar() ||
        !between[1].IsScalar())
    {
      yaml.fail(between, "'between' must be a list of 2 places");
    }
    Door door;
    for (std::size_t i = 0; i < 2; ++i)
    {
      try
      {
        (i == 0 ? door.place_a : door.place_b) = building.place(between[i].Scalar()).name;
      }
      catch (const NotFound& e)
      {
        yaml.fail(between, e.what());
      }
    }
    const auto center = yaml.numbers(node, "center", 2);
    door.x = center[0];
    door.y = center[1];
    door.width_m = yaml.positive(node, "width");
    if (!onBorder(building.place(door.place_a).rectangle, door.x, door.y) ||
        !onBorder(building.place(door.place_b).rectangle, door.x, door.y))
    {
      yaml.fail(node["center"], "'center' must lie on the wall between '" + door.place_a +
                                    "' and '" + door.place_b + "'");
    }
    const double half_width = sharedHalfWidth(building.place(door.place_a).rectangle,
                                              building.place(door.place_b).rectangle, door);
    if (door.place_a == door.place_b || door.width_m / 2.0 > half_width + kTolerance)
    {
      yaml.fail(node["width"], "the door between '" + door.place_a + "' and '" + door.place_b +
                                   "' is wider than their wall lets it be there, " +
                                   std::to_string(std::max(0.0, 2.0 * half_width)) + " m");
    }
    building.doors.push_back(door);
  }
}

void readFurniture(const YamlReader& yaml, Building& building)
{
  if (!yaml.root()["furniture"])
  {
    return;
  }
  std::set<std::string> names;
  for (const YAML::Node& node : yaml.list(yaml.root(), "furniture"))
  {
    yaml.checkMap(node, "a piece of furniture", {"name", "size", "pose", "texture", "place"});
    Furniture furniture;
    furniture.name = yaml.text(node, "name");
    if (!names.insert(furniture.name).second)
    {
      yaml.fail(node["name"], "furniture '" + furniture.name + "' twice");
    }
    furniture.place = placeName(yaml, node, "place", building);
    const auto size = yaml.numbers(node, "size", 3);
    if (*std::min_element(size.begin(), size.end()) <= 0.0)
    {
      yaml.fail(node["size"], "'size' must be 3 numbers above 0");
    }
    furniture.size = {size[0], size[1], size[2]};
    const auto pose = yaml.numbers(node, "pose", 3);
    furniture.pose = {pose[0], pose[1], pose[2]};
    if (!building.place(furniture.place).rectangle.contains(pose[0], pose[1]))
    {
      yaml.fail(node["pose"],
                "furniture '" + furniture.name + "' is not in '" + furniture.place + "'");
    }
    if (!isInside(furniture, building.place(furniture.place).rectangle))
    {
      yaml.fail(node["pose"],
                "furniture '" + furniture.name + "' reaches out of '" + furniture.place + "'");
    }
    furniture.texture = yaml.file(node, "texture");
    building.furniture.push_back(furniture);
  }
}

void readObjects(const YamlReader& yaml, Building& building)
{
  if (!yaml.root()["objects"])
  {
    return;
  }
  std::set<std::string> names;
  for (const YAML::Node& node : yaml.list(yaml.root(), "objects"))
  {
    yaml.checkMap(node, "an object", {"name", "place"});
    const std::string name = yaml.text(node, "name");
    if (!names.insert(name).second)
    {
      yaml.fail(node["name"], "object '" + name + "' twice");
    }
    building.objects.push_back({name, placeName(yaml, node, "place", building)});
  }
}
}  // namespace

const Place& Building::place(const std::string& place_name) const
{
  const auto found = std::find_if(places.begin(), places.end(), [&](const Place& candidate) {
    return candidate.name == place_name;
  });
  if (found != places.end())
  {
    return *found;
  }
  std::vector<std::string> names;
  for (const Place& place : places)
  {
    names.push_back(place.name);
  }
  throw NotFound("unknown place '" + place_name + "', expected one of: " + joined(names));
}

const Place* Building::placeAt(double x, double y) const
{
  const auto found = std::find_if(places.begin(), places.end(), [&](const Place& place) {
    return place.rectangle.contains(x, y);
  });
  return found == places.end() ? nullptr : &*found;
}

Rectangle Building::extent() const
{
  Rectangle all = places.front().rectangle;
  for (const Place& place : places)
  {
    all.x0 = std::min(all.x0, place.rectangle.x0);
    all.y0 = std::min(all.y0, place.rectangle.y0);
    all.x1 = std::max(all.x1, place.rectangle.x1);
    all.y1 = std::max(all.y1, place.rectangle.y1);
  }
  return all;
}

Building loadBuilding(const std::string& path)
{
  const YamlReader yaml(path);
  yaml.checkMap(yaml.root(), "a building file",
                {"name", "walls", "floor", "places", "doors", "furniture", "robot", "objects"});
  Building building;
  building.name = yaml.text(yaml.root(), "name");

  const YAML::Node walls = yaml.child(yaml.root(), "walls");
  yaml.checkMap(walls, "'walls'", {"height", "thickness", "texture"});
  building.wall_height_m = yaml.positive(walls, "height");
  building.wall_thickness_m = yaml.positive(walls, "thickness");
  if (building.wall_height_m > kHighestWall || building.wall_thickness_m > kThickestWall)
  {
    yaml.fail(walls, "'walls' must be at most 20 m high and 1 m thick");
  }
  building.wall_texture = yaml.file(walls, "texture");
  const YAML::Node floor = yaml.child(yaml.root(), "floor");
  yaml.checkMap(floor, "'floor'", {"texture"});
  building.floor_texture = yaml.file(floor, "texture");

  readPlaces(yaml, building);
  readDoors(yaml, building);
  checkDoorsLeadEverywhere(yaml, building);
  readFurniture(yaml, building);
  readObjects(yaml, building);

  const YAML::Node robot = yaml.child(yaml.root(), "robot");
  yaml.checkMap(robot, "'robot'", {"start"});
  const auto start = yaml.numbers(robot, "start", 3);
  building.robot_start = {start[0], start[1], start[2]};
  if (building.placeAt(start[0], start[1]) == nullptr)
  {
    yaml.fail(robot["start"], "the robot's start is in no place");
  }
  if (Obstacles(building).clearance(start[0], start[1], kStartClearance) < kStartClearance)
  {
    yaml.fail(robot["start"], "the robot's start is inside of a wall or of furniture");
  }
  return building;
}

std::string floorPlanJson(const Building& building)
{
  const auto boxJson = [](const Box& box) {
    return nlohmann::json{{"center", {box.center.x, box.center.y}},
                          {"size", {box.size.x, box.size.y, box.size.z}},
                          {"yaw", box.yaw}};
  };
  nlohmann::json plan{{"name", building.name},
                      {"places", nlohmann::json::array()},
                      {"doors", nlohmann::json::array()},
                      {"walls", nlohmann::json::array()},
                      {"furniture", nlohmann::json::array()}};
  for (const Place& place : building.places)
  {
    const Rectangle& r = place.rectangle;
    plan["places"].push_back({{"name", place.name}, {"rectangle", {r.x0, r.y0, r.x1, r.y1}}});
  }
  for (const Door& door : building.doors)
  {
    plan["doors"].push_back({{"between", {door.place_a, door.place_b}},
                             {"center", {door.x, door.y}},
                             {"width", door.width_m}});
  }
  for (const Box& wall : wallsOf(building))
  {
    plan["walls"].push_back(boxJson(wall));
  }
  for (const Furniture& furniture : building.furniture)
  {
    nlohmann::json item = boxJson(furniture.box());
    item["name"] = furniture.name;
    item["place"] = furniture.place;
    plan["furniture"].push_back(item);
  }
  const Rectangle all = building.extent();
  plan["extent"] = {all.x0, all.y0, all.x1, all.y1};
  plan["robot_start"] = {building.robot_start.x, building.robot_start.y, building.robot_start.yaw};
  return plan.dump(2);
}

}  // namespace kr3::sim
