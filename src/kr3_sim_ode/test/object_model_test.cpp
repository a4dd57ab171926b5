#include "kr3_sim_ode/object_model.hpp"

#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

namespace kr3::sim
{

namespace
{
const std::string kData = std::string(KR3_TEST_DIR) + "/data/";

std::string loadError(const std::string& text)
{
  const std::filesystem::path path =
      std::filesystem::path(testing::TempDir()) / "kr3_sim_ode_objects.yaml";
  std::ofstream(path) << text;
  try
  {
    (void)loadObjectModels(path.string());
  }
  catch (const InvalidArgument& e)
  {
    return e.what();
  }
  return "no error";
}
}  // namespace

TEST(ObjectModel, LoadsBoxesAndCylinders)
{
  const auto models = loadObjectModels(kData + "objects.yaml");
  ASSERT_EQ(models.size(), 3U);
  EXPECT_EQ(models[0].class_name, "textbook");
  EXPECT_EQ(findModel(models, "cup").shape, Shape::kCylinder);
  EXPECT_DOUBLE_EQ(findModel(models, "cup").size.y, 0.1);
  EXPECT_DOUBLE_EQ(findModel(models, "cup").size.z, 0.12);
  EXPECT_THROW((void)findModel(models, "sofa"), NotFound);
}

TEST(ObjectModel, RefusesBadEntriesWithTheirLine)
{
  const std::string good = "objects:\n  - {name: a, class: c, shape: ball, size: [1, 1], mass: 1, ";
  EXPECT_THAT(loadError(good + "texture: t.png}\n"),
              testing::HasSubstr("objects.yaml:2: unknown shape 'ball', expected box or cylinder"));
  EXPECT_THAT(loadError("objects:\n  - {name: a, class: c, shape: box, size: [1, 1]}\n"),
              testing::HasSubstr(":2: 'size' must be a list of 3 numbers"));
  EXPECT_THAT(loadError("objects:\n  - {name: \"a\xff\", class: c, shape: box}\n"),
              testing::HasSubstr(":2: 'name' must be a text in UTF-8"));
  const std::string sizes = "objects:\n  - {name: a, class: c, shape: box, size: ";
  EXPECT_THAT(loadError(sizes + "[1e-300, 1, 1], mass: 1, texture: t.png}\n"),
              testing::HasSubstr(":2: 'size' must be numbers from 0.001 to 20 m"));
  EXPECT_THAT(loadError(sizes + "[1, 1, 1], mass: 1e300, texture: t.png}\n"),
              testing::HasSubstr(":2: 'mass' must be a number from 0.001 to 10000 kg"));
  EXPECT_THAT(loadError("things: []\n"), testing::HasSubstr(":1: unknown key 'things'"));
  EXPECT_THAT(loadError("- 1\n"), testing::HasSubstr(":1: an objects file must be a map"));
}

}  // namespace kr3::sim
