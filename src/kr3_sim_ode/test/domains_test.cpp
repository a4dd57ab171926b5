// Every building in domains/, and what scripts/make_building.py writes, can be lived in: objects
// fit, the robot reaches them and every quarter of every room.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <queue>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "kr3_sim_ode/placement.hpp"
#include "kr3_sim_ode/random.hpp"
#include "kr3_sim_ode/robot.hpp"

namespace kr3::sim
{

namespace
{
constexpr double kCell = 0.05;         // m
constexpr double kRobotRadius = 0.30;  // m, a little more than the robot's 0.28

std::vector<std::string> domains()
{
  std::vector<std::string> paths;
  for (const auto& entry : std::filesystem::directory_iterator(KR3_DOMAINS_DIR))
  {
    if (std::filesystem::exists(entry.path() / "building.yaml"))
    {
      paths.push_back(entry.path().string());
    }
  }
  return paths;
}

/// Folder of a building of `rooms` rooms that the generator writes, once; "" when it fails.
std::string generated(const std::string& layout, int rooms)
{
  const std::string folder = testing::TempDir() + "/kr3_sim_ode_" + layout;
  const std::string command = std::string("/usr/bin/python3 ") + KR3_DOMAINS_DIR +
                              "/../scripts/make_building.py " + folder + " --rooms " +
                              std::to_string(rooms) + " --layout " + layout +
                              " --objects 8 --seed 11 --looks " + KR3_DOMAINS_DIR + "/floor_a";
  static std::set<std::string> written;
  return !written.insert(folder).second || std::system(command.c_str()) == 0 ? folder : "";
}

struct GridPoint
{
  int i;
  int j;

  bool operator<(const GridPoint& other) const { return i != other.i ? i < other.i : j < other.j; }
  [[nodiscard]] double x() const { return i * kCell; }
  [[nodiscard]] double y() const { return j * kCell; }
};

/// Where the robot can drive from its start.
std::set<GridPoint> reachableFloor(const Building& building)
{
  const GridPoint start{static_cast<int>(std::lround(building.robot_start.x / kCell)),
                        static_cast<int>(std::lround(building.robot_start.y / kCell))};
  const Obstacles obstacles(building);
  std::set<GridPoint> reached{start};
  std::queue<GridPoint> open({start});
  while (!open.empty())
  {
    const GridPoint point = open.front();
    open.pop();
    for (const auto& [di, dj] :
         {std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)})
    {
      const GridPoint next{point.i + di, point.j + dj};
      if (reached.count(next) == 0 && building.placeAt(next.x(), next.y()) != nullptr &&
          obstacles.clearance(next.x(), next.y(), kRobotRadius) >= kRobotRadius)
      {
        reached.insert(next);
        open.push(next);
      }
    }
  }
  return reached;
}
}  // namespace

struct Origin
{
  std::string folder;  ///< empty: the generator writes it
  std::string layout;
  int rooms = 0;
};

std::vector<Origin> origins()
{
  std::vector<Origin> all{{"", "wings", 20}, {"", "ring", 8}, {"", "hall", 7}};
  for (const std::string& folder : domains())
  {
    all.push_back({folder, "", 0});
  }
  return all;
}

class Domain : public testing::TestWithParam<Origin>
{
protected:
  Domain()
    : folder(GetParam().folder.empty() ? generated(GetParam().layout, GetParam().rooms)
                                       : GetParam().folder)
    , building(loadBuilding(folder + "/building.yaml"))
    , models(loadObjectModels(folder + "/objects.yaml"))
  {
  }

  std::string folder;

  Building building;
  std::vector<ObjectModel> models;
};

TEST_P(Domain, LetsTheRobotIntoEveryQuarterOfEveryPlace)
{
  const std::set<GridPoint> reached = reachableFloor(building);
  for (const Place& place : building.places)
  {
    const Rectangle& r = place.rectangle;
    for (int quarter = 0; quarter < 4; ++quarter)
    {
      const double x0 = r.x0 + (quarter % 2) * (r.x1 - r.x0) / 2.0;
      const double y0 = r.y0 + (quarter / 2) * (r.y1 - r.y0) / 2.0;
      const Rectangle part{x0, y0, x0 + (r.x1 - r.x0) / 2.0, y0 + (r.y1 - r.y0) / 2.0};
      int count = 0;
      for (const GridPoint& point : reached)
      {
        count += part.contains(point.x(), point.y()) ? 1 : 0;
      }
      EXPECT_GE(count * kCell * kCell, 0.2) << place.name << " quarter " << quarter << ", m^2";
    }
  }
}

TEST_P(Domain, PlacesObjectsInTheirPlaceOnFurnitureApartAndWithinReach)
{
  const std::set<GridPoint> reached = reachableFloor(building);
  const RobotModel robot;
  for (std::uint64_t seed = 1; seed <= 15; ++seed)
  {
    std::mt19937_64 generator = makeGenerator(seed, Stream::kPlacement);
    const auto objects = placedObjects(building, models, building.objects, generator);
    ASSERT_EQ(objects.size(), building.objects.size());
    for (std::size_t i = 0; i < objects.size(); ++i)
    {
      const Vector3& p = objects[i].pose.position;
      EXPECT_EQ(building.placeAt(p.x, p.y)->name, building.objects[i].place);
      bool on_furniture = false;
      for (const Furniture& furniture : building.furniture)
      {
        on_furniture |= planarDistance(furniture.box(), p.x, p.y) == 0.0 &&
                        p.z > furniture.size.z && p.z < furniture.size.z + 0.3;
      }
      EXPECT_TRUE(on_furniture) << objects[i].name << " seed " << seed;
      const bool within_reach =
          std::any_of(reached.begin(), reached.end(), [&](const GridPoint& point) {
            return std::hypot(point.x() - p.x, point.y() - p.y) < robot.reach_m - 0.05;
          });
      EXPECT_TRUE(within_reach) << objects[i].name << " seed " << seed;
      for (std::size_t j = 0; j < i; ++j)
      {
        const Vector3& q = objects[j].pose.position;
        EXPECT_GE(std::hypot(p.x - q.x, p.y - q.y), 0.3) << objects[i].name << objects[j].name;
      }
    }
  }
}

TEST_P(Domain, TakesEveryObjectInEveryFurnishedPlace)
{
  std::mt19937_64 generator(1);
  for (const Furniture& furniture : building.furniture)
  {
    for (const ObjectModel& model : models)
    {
      EXPECT_NO_THROW(
          (void)freeSurfacePose(building, furniture.place, model, {}, models, generator))
          << model.name << " " << furniture.place;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, Domain, testing::ValuesIn(origins()),
                         [](const testing::TestParamInfo<Origin>& origin) {
  const std::filesystem::path folder = origin.param.folder;
  return folder.empty() ? "generated_" + origin.param.layout : folder.filename().string();
});

}  // namespace kr3::sim
