// Files that nobody should write: every reader either takes a damaged file or refuses it with file
// and line, and a world can be made of what it takes, or says why not. See damaged_files.hpp.
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include <kr3_common/testing/damaged_files.hpp>
#include <kr3_common/testing/temporary_folder.hpp>

#include "kr3_sim_ode/camera.hpp"
#include "kr3_sim_ode/scenario.hpp"

namespace kr3::sim
{
namespace
{

namespace fs = std::filesystem;
using kr3::test_support::damageFile;
using kr3::test_support::takes;
using kr3::test_support::TemporaryFolder;

class Readers : public ::testing::Test
{
protected:
  Readers() { fs::copy(KR3_TEST_DIR "/data", folder_.path()); }

  [[nodiscard]] Scenario scenario() const
  {
    Scenario scenario;
    scenario.building = loadBuilding(building_);
    scenario.models = loadObjectModels(objects_);
    return scenario;
  }

  /// The building and its objects for a moment, as the node uses them.
  static void live(const Scenario& scenario)
  {
    constexpr int kSteps = 20;
    constexpr double kSmallArea = 1000.0;  // m^2: a large OctoMap takes long
    (void)floorPlanJson(scenario.building);
    const std::unique_ptr<World> world = makeWorld(scenario);
    world->setCommand(0.5, 0.2);
    for (int step = 0; step < kSteps; ++step)
      world->step();
    (void)world->scan();
    const Rectangle all = scenario.building.extent();
    if ((all.x1 - all.x0) * (all.y1 - all.y0) < kSmallArea)
      (void)world->octomap({0.5, 0.0, 2.0});
  }

  TemporaryFolder folder_;
  std::string building_ = folder_.path() + "/two_rooms.yaml";
  std::string objects_ = folder_.path() + "/objects.yaml";
};

TEST_F(Readers, OfBuildings)
{
  EXPECT_GT(damageFile(
                building_, 500,
                [&] {
    const Scenario taken = scenario();
    (void)takes([&] { live(taken); }, "a building that was taken");
                },
                "two_rooms.yaml:"),
            0U);
}

TEST_F(Readers, OfObjects)
{
  EXPECT_GT(damageFile(
                objects_, 500,
                [&] {
    const Scenario taken = scenario();
    (void)takes([&] { live(taken); }, "objects that were taken");
                },
                "objects.yaml:"),
            0U);
}

TEST_F(Readers, OfTextures)
{
  const auto render = [&] {
    const Scenario taken = scenario();
    const Renderer renderer(taken.building, taken.models, CameraModel{});
  };
  // The checksums of a PNG refuse nearly every damage.
  for (const char* const texture : {"plain.png", "checks.png"})
    (void)damageFile(fs::path(folder_.path()) / texture, 15, render, texture);
}

}  // namespace
}  // namespace kr3::sim
