#include "../src/dataset.hpp"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_sim_ode/random.hpp"

namespace kr3::sim
{

namespace
{
const std::string kData = std::string(KR3_TEST_DIR) + "/data/";

/// `count` models like the first one of the test's objects.
std::vector<ObjectModel> manyModels(int count)
{
  const ObjectModel book = loadObjectModels(kData + "objects.yaml").front();
  std::vector<ObjectModel> models;
  for (int i = 0; i < count; ++i)
  {
    models.push_back(book);
    models.back().name += std::to_string(i);
  }
  return models;
}
}  // namespace

TEST(Dataset, FillsTheWholeBuildingBeforeItGivesUp)
{
  // The tables, 2.0 m and 1.4 m wide, take six and four books when these lie well: a table drawn
  // too often must not be the end.
  const Building building = loadBuilding(kData + "two_rooms.yaml");
  std::mt19937_64 generator = makeGenerator(1, Stream::kDataset);
  for (int i = 0; i < 100; ++i)
  {
    const LabelledView view =
        drawView(building, manyModels(6), RobotModel{}, SceneOptions{}, false, generator);
    EXPECT_EQ(view.objects.size(), 6U);
  }
}

TEST(Dataset, SaysThatTheObjectsAreTooMany)
{
  const Building building = loadBuilding(kData + "two_rooms.yaml");
  std::mt19937_64 generator = makeGenerator(1, Stream::kDataset);
  EXPECT_THROW(
      (void)drawView(building, manyModels(40), RobotModel{}, SceneOptions{}, false, generator),
      FailedPrecondition);
}

TEST(Dataset, StandsInFrontOfAnObjectOfTheSamePlace)
{
  const Building building = loadBuilding(kData + "two_rooms.yaml");
  std::mt19937_64 generator = makeGenerator(2, Stream::kDataset);
  const RobotModel robot;
  for (int i = 0; i < 50; ++i)
  {
    const LabelledView view =
        drawView(building, manyModels(2), robot, SceneOptions{}, false, generator);
    const Pose T_world_camera = poseOf(view.T_world_base, 0.0) * robot.T_base_camera();
    bool sees_one = false;
    for (const ObjectState& object : view.objects)
    {
      const double dx = object.pose.position.x - T_world_camera.position.x;
      const double dy = object.pose.position.y - T_world_camera.position.y;
      const double off = wrapped(std::atan2(dy, dx) - view.T_world_base.yaw);
      sees_one |= std::hypot(dx, dy) <= 2.5 && std::abs(off) <= 0.4 + 1e-9;
    }
    EXPECT_TRUE(sees_one);
  }
}

TEST(Dataset, CrowdsSomeObjectsOntoOnePieceWithoutOverlap)
{
  const Building building = loadBuilding(kData + "two_rooms.yaml");
  const std::vector<ObjectModel> models = manyModels(8);
  SceneOptions scene;
  scene.crowd = 4;
  scene.max_turn_rad = 3.0;
  std::mt19937_64 generator = makeGenerator(1, Stream::kDataset);
  for (int i = 0; i < 20; ++i)
  {
    const std::vector<ObjectState> objects =
        drawView(building, models, {}, scene, false, generator).objects;
    EXPECT_GE(objects.size(), 1U);
    EXPECT_LE(objects.size(), 4U);
    for (std::size_t a = 0; a < objects.size(); ++a)
    {
      for (std::size_t b = 0; b < a; ++b)
      {
        const double distance = std::hypot(objects[a].pose.position.x - objects[b].pose.position.x,
                                           objects[a].pose.position.y - objects[b].pose.position.y);
        EXPECT_GT(distance, 2.0 * models.front().footprintRadius());
        EXPECT_LT(distance, 1.1);
      }
    }
  }
}

}  // namespace kr3::sim
