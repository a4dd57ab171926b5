#include "kr3_refinement/component_map.hpp"

#include <cmath>
#include <limits>

#include "fixtures.hpp"

namespace kr3::refinement
{
namespace
{

using test::expectError;

ComponentMapData two()
{
  return {{{"a1", "a"}, {"a2", "a"}}, {{1}, {0}}, {}, {0.0, 2.5, 2.5, 0.0}};
}

TEST(ComponentMap, FindsWhatItWasGiven)
{
  const ComponentMap map(two());
  EXPECT_EQ(map.find("a2"), std::size_t{1});
  EXPECT_FALSE(map.find("a3").has_value());
  EXPECT_DOUBLE_EQ(map.distance(0, 1), 2.5);
}

TEST(ComponentMap, RefusesDataThatDoNotFit)
{
  const auto rejects = [](const std::string& part, auto change) {
    ComponentMapData data = two();
    change(data);
    expectError(ErrorCode::kInvalidArgument, part, [&] { ComponentMap map(data); });
  };
  rejects("two components named 'a1'",
          [](ComponentMapData& data) { data.components[1].name = "a1"; });
  rejects("part of nothing", [](ComponentMapData& data) { data.components[1].part_of.clear(); });
  rejects("'a1' has neighbour 7 of 2", [](ComponentMapData& data) { data.neighbors[0] = {7}; });
  rejects("expected 2 and 4", [](ComponentMapData& data) { data.distances_m.pop_back(); });
  rejects("from 'a1' to 'a2'", [](ComponentMapData& data) { data.distances_m[1] = std::nan(""); });
  rejects("from 'a2' to 'a1'", [](ComponentMapData& data) { data.distances_m[2] = -1.0; });
}

TEST(ComponentMap, AcceptsWhatIsOutOfReach)
{
  ComponentMapData data = two();
  data.distances_m[1] = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(std::isinf(ComponentMap(data).distance(0, 1)));
}

TEST(GridMap, HasNeighboursWithinEachWhole)
{
  const ComponentMap map = gridMap({"a", "b"}, 4, 2.0);
  ASSERT_EQ(map.size(), 8U);
  for (std::size_t i = 0; i < map.size(); ++i)
  {
    EXPECT_EQ(map.neighbors(i).size(), 2U);
    for (const std::size_t j : map.neighbors(i))
    {
      EXPECT_EQ(map.components()[i].part_of, map.components()[j].part_of);
      EXPECT_DOUBLE_EQ(map.distance(i, j), 2.0);
    }
  }
}

TEST(ReadComponentMap, ReadsTheWorkbench)
{
  const ComponentMap map = readComponentMap(test::domainFile("workbench", "map.yaml"));
  EXPECT_EQ(map.components()[*map.find("mixer")].part_of, "tuner");
  EXPECT_EQ(map.neighbors(*map.find("transformer")).size(), 2U);
}

TEST(ReadComponentMap, SaysThatAFileIsMissing)
{
  expectError(ErrorCode::kUnavailable, "no_such.yaml",
              [] { (void)readComponentMap("no_such.yaml"); });
}

TEST(ReadComponentMap, ReportsEveryProblemWithItsLine)
{
  const std::string path = ::testing::TempDir() + "bad_map.yaml";
  std::ofstream(path) << "components:\n  - {name: m1, part_of: d}\n  - {name: m2, part: "
                         "d}\nneighbors:\n  - [m1, m9]\n";
  expectError(ErrorCode::kInvalidArgument, "bad_map.yaml:3: a component: unknown key 'part'",
              [&] { (void)readComponentMap(path); });
  expectError(ErrorCode::kInvalidArgument, "bad_map.yaml:5: neighbors: 'm9'",
              [&] { (void)readComponentMap(path); });
}

}  // namespace
}  // namespace kr3::refinement
