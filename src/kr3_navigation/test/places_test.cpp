#include "kr3_navigation/places.hpp"

#include <filesystem>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

namespace kr3::navigation
{
namespace
{

std::string errorOf(const std::string& text)
{
  try
  {
    (void)parsePlaces(text, "building.yaml");
  }
  catch (const InvalidArgument& e)
  {
    return e.what();
  }
  return "no error";
}

TEST(Places, ReadsNamesAndRectanglesAndIgnoresOtherSections)
{
  const std::vector<Place> places = parsePlaces(
      "walls: {height: 2.0}\nplaces:\n  - {name: office, rectangle: [0, 0, 4, 4.5]}\n  - {name: "
      "hall_2, rectangle: [4, 0, 8, 4]}\n",
      "building.yaml");
  ASSERT_EQ(places.size(), 2U);
  EXPECT_EQ(places[0].name, "office");
  EXPECT_DOUBLE_EQ(places[0].rectangle.y_max, 4.5);
  EXPECT_EQ(places[1].name, "hall_2");
}

TEST(Places, NamesTheLineOfAnError)
{
  const auto expect =
      [](const std::string& text, const std::string& where, const std::string& what) {
    const std::string error = errorOf(text);
    EXPECT_EQ(error.rfind("building.yaml:" + where, 0), 0U) << error;
    EXPECT_NE(error.find(what), std::string::npos) << error;
  };
  expect("places:\n  - {name: office}\n", "2:", "no `rectangle");
  expect("places:\n  - {name: office, rectangle: [0, 0, 4]}\n", "2:", "found 3");
  expect("places:\n  - {name: office, rectangle: [0, 0, four, 4]}\n", "2:", "found 'four'");
  expect("places:\n  - {name: office, rectangle: [4, 0, 0, 4]}\n", "2:", "x_min < x_max");
  expect("places:\n  - {name: Main Hall, rectangle: [0, 0, 4, 4]}\n", "2:", "found 'Main Hall'");
  expect(
      "places:\n  - {name: a, rectangle: [0, 0, 4, 4]}\n  - {name: a, rectangle: [4, 0, 8, 4]}\n",
      "3:", "twice");
  expect(
      "places:\n  - {name: a, rectangle: [0, 0, 4, 4]}\n  - {name: b, rectangle: [3, 0, 8, 4]}\n",
      "3:", "overlaps 'a'");
  expect("places: office\n", "1:", "must be a list");
  expect("walls: {}\n", "1:", "expected a section `places`");
  expect("places:\n  - {name: office, rectangle: [0, 0\n", "", "");
}

TEST(Places, ReadsDoors)
{
  const std::vector<Place> places{{"a", {0, 0, 4, 4}}, {"b", {4, 0, 8, 4}}};
  const std::vector<Door> doors =
      parseDoors("doors:\n  - {between: [a, b], center: [4, 2], width: 0.9}\n", "x.yaml", places);
  ASSERT_EQ(doors.size(), 1U);
  EXPECT_EQ(doors[0].place_b, "b");
  EXPECT_EQ(doors[0].center.x, 4.0);
  EXPECT_EQ(doors[0].width_m, 0.9);
  EXPECT_TRUE(parseDoors("places: []\n", "x.yaml", places).empty());
  for (const char* wrong :
       {"doors: 3\n", "doors:\n  - {between: [a, c], center: [4, 2], width: 1}\n",
        "doors:\n  - {between: [a], center: [4, 2], width: 1}\n",
        "doors:\n  - {between: [a, b], center: [4, .nan], width: 1}\n",
        "doors:\n  - {between: [a, b], center: [4, 2], width: -1}\n", "doors:\n  - 7\n"})
  {
    try
    {
      (void)parseDoors(wrong, "x.yaml", places);
      ADD_FAILURE() << wrong;
    }
    catch (const InvalidArgument& e)
    {
      EXPECT_EQ(std::string(e.what()).rfind("x.yaml:", 0), 0U) << e.what();
    }
  }
}

TEST(Places, SaysWhenTheFileIsMissing)
{
  EXPECT_THROW((void)loadPlaces("/nowhere/building.yaml"), Unavailable);
}

TEST(Places, ReadsTheBuildingOfEveryDomain)
{
  for (const auto& domain : std::filesystem::directory_iterator(KR3_DOMAINS_DIR))
  {
    const std::filesystem::path building = domain.path() / "building.yaml";
    if (std::filesystem::exists(building))
    {
      EXPECT_FALSE(loadPlaces(building).empty()) << building;
    }
  }
}

}  // namespace
}  // namespace kr3::navigation
