#include "kr3_sim_ode/octomap.hpp"

#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include <kr3_common/error.hpp>

#include "kr3_sim_ode/scenario.hpp"

namespace kr3::sim
{

namespace
{
const std::string kData = std::string(KR3_TEST_DIR) + "/data/";

enum class Voxel
{
  kUnknown,
  kFree,
  kOccupied,
};

class Octomap : public testing::Test
{
protected:
  Octomap()
  {
    scenario.building = loadBuilding(kData + "two_rooms.yaml");
    scenario.models = loadObjectModels(kData + "objects.yaml");
    scenario.world.grasp_failure_rate = 0.0;
    scenario.world.laser.noise_stddev_m = 0.0;
    scenario.world.laser.dropout_rate = 0.0;
    world = makeWorld(scenario);
    world->setObjectPose("book", {{2.0, 0.45, 0.545}, {}});
  }

  /// Reads the bytes as any user of OctoMap does.
  std::unique_ptr<octomap::OcTree> tree(const OctomapOptions& options = {}) const
  {
    const std::vector<std::uint8_t> bytes = world->octomap(options);
    std::istringstream stream(std::string(bytes.begin(), bytes.end()));
    auto result = std::make_unique<octomap::OcTree>(1.0);
    EXPECT_TRUE(result->readBinary(stream));
    return result;
  }

  static Voxel at(const octomap::OcTree& tree, double x, double y, double z)
  {
    const octomap::OcTreeNode* const node = tree.search(x, y, z);
    if (node == nullptr)
    {
      return Voxel::kUnknown;
    }
    return tree.isNodeOccupied(node) ? Voxel::kOccupied : Voxel::kFree;
  }

  Scenario scenario;
  std::unique_ptr<World> world;
};
}  // namespace

TEST_F(Octomap, HasWallsFurnitureAndObjectsWhereTheyAre)
{
  const auto map = tree();
  EXPECT_DOUBLE_EQ(map->getResolution(), 0.1);
  EXPECT_EQ(at(*map, 4.02, 0.55, 1.95), Voxel::kOccupied) << "wall";
  EXPECT_EQ(at(*map, 4.02, 2.05, 1.05), Voxel::kFree) << "door";
  EXPECT_EQ(at(*map, 2.05, 0.35, 0.25), Voxel::kOccupied) << "inside of the table";
  EXPECT_EQ(at(*map, 2.75, 0.35, 0.55), Voxel::kFree) << "above the table";
  EXPECT_EQ(at(*map, 2.0, 0.45, 0.55), Voxel::kOccupied) << "the book on it";
  EXPECT_EQ(at(*map, 1.05, 2.05, 0.15), Voxel::kFree) << "the robot is not in it";
  EXPECT_EQ(at(*map, -0.55, 2.05, 1.05), Voxel::kUnknown) << "outside";
  EXPECT_EQ(at(*map, 2.05, 2.05, 2.05), Voxel::kUnknown) << "above the band";
}

TEST_F(Octomap, LeavesOutWhatTheRobotHolds)
{
  world->setRobotPose({2.0, 1.1, -M_PI / 2.0});
  ASSERT_TRUE(world->closeGripper());
  const Vector3 p = world->objects().front().pose.position;
  const auto map = tree();
  EXPECT_EQ(at(*map, p.x, p.y, p.z), Voxel::kFree);
  EXPECT_EQ(at(*map, 2.0, 0.45, 0.55), Voxel::kFree) << "where it lay";
}

TEST_F(Octomap, AgreesWithTheLaser)
{
  const double resolution = 0.05;
  const auto map = tree({resolution, 0.25, 0.35});
  for (const Pose2& pose : {Pose2{1.0, 2.0, 0.3}, Pose2{6.3, 1.7, 1.1}, Pose2{3.1, 3.2, 2.0}})
  {
    world->setRobotPose(pose);
    const std::vector<double> ranges = world->scan();
    for (std::size_t i = 0; i < ranges.size(); ++i)
    {
      const double angle = pose.yaw - M_PI +
                           static_cast<double>(i) * 2.0 * M_PI / static_cast<double>(ranges.size());
      const auto beam = [&](double range) {
        return at(*map, pose.x + range * std::cos(angle), pose.y + range * std::sin(angle), 0.3);
      };
      EXPECT_EQ(beam(ranges[i] + 1e-3), Voxel::kOccupied) << "beam " << i;
      // Half of what is before the hit: a voxel is occupied when the wall reaches into it at all.
      EXPECT_EQ(beam(ranges[i] / 2.0), Voxel::kFree) << "beam " << i;
    }
  }
}

TEST_F(Octomap, HasTheLayersOfItsBandOnly)
{
  const auto map = tree({0.1, 0.25, 0.35});
  double low = 0.0;
  double high = 0.0;
  double unused = 0.0;
  map->getMetricMin(unused, unused, low);
  map->getMetricMax(unused, unused, high);
  EXPECT_NEAR(low, 0.2, 1e-6) << "the centre of voxel [0.2, 0.3) is in the band";
  EXPECT_NEAR(high, 0.3, 1e-6);
}

TEST_F(Octomap, RefusesWhatItCannotDo)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)world->octomap({0.0, 0.0, 2.0}), InvalidArgument);
  EXPECT_THROW((void)world->octomap({nan, 0.0, 2.0}), InvalidArgument);
  EXPECT_THROW((void)world->octomap({0.1, 1.0, 1.0}), InvalidArgument);
  EXPECT_THROW((void)world->octomap({0.1, nan, 1.0}), InvalidArgument);
  EXPECT_THROW((void)world->octomap({1e-4, 0.0, 2.0}), InvalidArgument);
  EXPECT_THROW(saveOctomap({1, 2, 3}, "/nowhere/world.bt"), Unavailable);
}

TEST_F(Octomap, IsSavedAsAFileThatOctomapReads)
{
  const std::string path = testing::TempDir() + "/kr3_sim_ode_world.bt";
  saveOctomap(world->octomap({}), path);
  octomap::OcTree map(1.0);
  EXPECT_TRUE(map.readBinary(path));
  EXPECT_EQ(at(map, 4.02, 0.55, 1.95), Voxel::kOccupied);
  std::filesystem::remove(path);
}

}  // namespace kr3::sim
