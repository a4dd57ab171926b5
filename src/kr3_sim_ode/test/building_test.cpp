#include "kr3_sim_ode/building.hpp"

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <kr3_common/error.hpp>

namespace kr3::sim
{

namespace
{
const std::string kData = std::string(KR3_TEST_DIR) + "/data/";

/// The test building with `from` replaced by `to` in its file; `name` keeps parallel tests apart.
std::string brokenBuilding(const std::string& from, const std::string& to)
{
  std::ifstream original(kData + "two_rooms.yaml");
  std::string text((std::istreambuf_iterator<char>(original)), {});
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
  const std::filesystem::path directory =
      std::filesystem::path(testing::TempDir()) /
      ("kr3_sim_ode_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
  std::filesystem::create_directories(directory);
  for (const char* const texture : {"plain.png", "checks.png"})
  {
    std::filesystem::copy_file(kData + texture, directory / texture,
                               std::filesystem::copy_options::overwrite_existing);
  }
  std::ofstream(directory / "building.yaml") << text;
  return (directory / "building.yaml").string();
}

std::string loadError(const std::string& path)
{
  try
  {
    (void)loadBuilding(path);
  }
  catch (const InvalidArgument& e)
  {
    return e.what();
  }
  ADD_FAILURE() << "no error";
  return "";
}

void expectError(const std::string& from, const std::string& to, const std::string& line,
                 const std::string& message)
{
  const std::string error = loadError(brokenBuilding(from, to));
  EXPECT_NE(error.find("building.yaml:" + line + ": "), std::string::npos) << error;
  EXPECT_NE(error.find(message), std::string::npos) << error;
}
}  // namespace

TEST(Building, LoadsPlacesDoorsFurnitureAndObjects)
{
  const Building building = loadBuilding(kData + "two_rooms.yaml");
  EXPECT_EQ(building.name, "two_rooms");
  ASSERT_EQ(building.places.size(), 2U);
  EXPECT_EQ(building.doors.size(), 1U);
  EXPECT_EQ(building.furniture.size(), 2U);
  EXPECT_EQ(building.objects.size(), 2U);
  EXPECT_EQ(building.placeAt(1.0, 1.0)->name, "left");
  EXPECT_EQ(building.placeAt(-1.0, 1.0), nullptr);
}

TEST(Building, RefusesAnUnknownKeyAndNamesItsLine)
{
  expectError("width: 1.0", "widht: 1.0", "9", "unknown key 'widht'");
}

TEST(Building, RefusesFurnitureOutsideOfItsPlace)
{
  expectError("pose: [2.0, 0.35", "pose: [5.0, 0.35", "11", "is not in 'left'");
}

TEST(Building, RefusesADoorThatIsNotOnTheWall)
{
  expectError("center: [4.0, 2.0]", "center: [3.0, 2.0]", "9", "must lie on the wall between");
}

TEST(Building, RefusesAnUnknownPlaceAndListsThoseThereAre)
{
  expectError("name: cup, place: right", "name: cup, place: attic", "16",
              "unknown place 'attic', expected one of: left, right");
}

TEST(Building, RefusesOverlappingPlaces)
{
  expectError("[4.0, 0.0, 8.0, 4.0]", "[3.0, 0.0, 8.0, 4.0]", "7", "overlaps 'left'");
}

TEST(Building, RefusesSomethingThatIsNoNumber)
{
  expectError("size: [0.6, 2.0, 0.40]", "size: [0.6, wide, 0.40]", "11", "3 numbers");
  expectError("size: [0.6, 2.0, 0.40]", "size: [0.6, .nan, 0.40]", "11", "3 numbers");
}

TEST(Building, RefusesAMissingTextureAndAMissingKey)
{
  expectError("thickness: 0.1, texture: plain.png", "thickness: 0.1, texture: none.png", "3",
              "there is no file");
  expectError("thickness: 0.1, ", "", "3", "'thickness' is missing");
}

TEST(Building, RefusesADoorWiderThanItsWall)
{
  expectError("width: 1.0", "width: 4.2", "9", "is wider than their wall lets it be there, 4.0");
}

TEST(Building, RefusesAPlaceWithoutADoor)
{
  expectError("doors:\n  - {between: [left, right], center: [4.0, 2.0], width: 1.0}\n", "", "7",
              "no doors lead from 'left' to 'right'");
}

TEST(Building, RefusesFurnitureThatReachesThroughAWall)
{
  expectError("pose: [2.0, 0.35", "pose: [2.0, 0.25", "11", "reaches out of 'left'");
}

TEST(Building, RefusesAStartInsideOfFurniture)
{
  expectError("start: [1.0, 2.0, 0.0]", "start: [2.0, 0.4, 0.0]", "13", "inside of a wall or of");
}

TEST(Building, RefusesCoordinatesThatAreNoBuilding)
{
  expectError("[4.0, 0.0, 8.0, 4.0]", "[4.0, 0.0, 1.0e+300, 4.0]", "7", "within 10 km");
  expectError("height: 2.0", "height: 2000.0", "3", "at most 20 m high");
}

TEST(Building, LoadsAThousandRooms)
{
  std::string text =
      "name: long\nwalls: {height: 2.0, thickness: 0.1, texture: plain.png}\n"
      "floor: {texture: plain.png}\nplaces:\n";
  std::string doors = "doors:\n";
  for (int i = 0; i < 1000; ++i)
  {
    const std::string x0 = std::to_string(4 * i);
    text += "  - {name: r" + std::to_string(i) + ", rectangle: [" + x0 + ", 0, " +
            std::to_string(4 * i + 4) + ", 4]}\n";
    if (i > 0)
    {
      doors += "  - {between: [r" + std::to_string(i - 1) + ", r" + std::to_string(i) +
               "], center: [" + x0 + ", 2], width: 1}\n";
    }
  }
  const std::string path = brokenBuilding("name", "name");
  std::ofstream(path) << text + doors + "robot: {start: [2, 2, 0]}\n";
  const Building building = loadBuilding(path);
  EXPECT_EQ(building.places.size(), 1000U);
  // Two long walls; between rooms two parts each; two ends.
  EXPECT_EQ(wallsOf(building).size(), 2U + 2U * 999U + 2U);
}

TEST(Building, SaysThatAFileCannotBeOpened)
{
  EXPECT_THROW((void)loadBuilding("/nowhere/building.yaml"), Unavailable);
}

TEST(Building, RefusesWhatIsNotYaml)
{
  expectError("places:", "places: [", "6", "");
}

TEST(Walls, ShareTheWallBetweenPlacesAndCutItAtTheDoor)
{
  const Building building = loadBuilding(kData + "two_rooms.yaml");
  const std::vector<Box> walls = wallsOf(building);
  // South, north: one each for both rooms; west, east; the middle one in two parts.
  ASSERT_EQ(walls.size(), 6U);
  const auto distance = [&](double x, double y) {
    double nearest = 1e9;
    for (const Box& wall : walls)
    {
      nearest = std::min(nearest, planarDistance(wall, x, y));
    }
    return nearest;
  };
  EXPECT_NEAR(distance(4.0, 2.0), 0.5, 1e-9) << "half the door's width";
  EXPECT_NEAR(distance(4.0, 1.4), 0.0, 1e-9);
  EXPECT_NEAR(distance(1.0, 1.0), 0.95, 1e-9) << "half the thickness stands in the room";
}

TEST(FloorPlan, IsJsonWithAllParts)
{
  const auto plan = nlohmann::json::parse(floorPlanJson(loadBuilding(kData + "two_rooms.yaml")));
  EXPECT_EQ(plan.at("places").size(), 2U);
  EXPECT_EQ(plan.at("walls").size(), 6U);
  EXPECT_EQ(plan.at("furniture").at(0).at("name"), "left_table");
  EXPECT_EQ(plan.at("extent"), nlohmann::json({0.0, 0.0, 8.0, 4.0}));
}

}  // namespace kr3::sim
