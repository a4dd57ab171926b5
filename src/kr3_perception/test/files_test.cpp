// Model files, labelled folders and object lists: what is written is read back, and what is wrong
// is named.
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_perception/detector.hpp"
#include "kr3_perception/labelled_folder.hpp"
#include "kr3_perception/model_file.hpp"
#include "kr3_perception/object_list.hpp"
#include "kr3_perception/trainer.hpp"
#include "synthetic_scenes.hpp"

namespace kr3::perception
{
namespace
{

std::string write(const test::TemporaryFolder& folder, const std::string& name,
                  const std::string& text)
{
  std::ofstream(folder.path() + "/" + name) << text;
  return folder.path() + "/" + name;
}

TEST(ModelFile, ReadsBackWhatItWrote)
{
  const test::TemporaryFolder folder;
  const test::SyntheticWorld world(2);
  world.writeFolder(folder.path() + "/images", 16, 1, true);
  const LabelledFolder images(folder.path() + "/images");
  TrainerOptions options;
  options.views_per_object = 3;
  const DetectorModel model =
      Trainer(world.objects(), options).train({images}, {images}, [](const std::string&) {});
  const std::string path = folder.path() + "/model.yml.gz";
  saveModel(model, path);
  const DetectorModel read = loadModel(path);
  const LabelledImage image = world.scene(99);
  const std::vector<Detection> before = Detector(model, {}).detect(image.bgr);
  const std::vector<Detection> after = Detector(read, {}).detect(image.bgr);
  ASSERT_EQ(before.size(), after.size());
  for (std::size_t i = 0; i < before.size(); ++i)
  {
    EXPECT_EQ(before[i].name, after[i].name);
    EXPECT_EQ(before[i].box, after[i].box);
    EXPECT_NEAR(before[i].probability, after[i].probability,
                0.02);  // histograms are rounded to 16 bits
  }
}

TEST(ModelFile, NamesAFileThatIsMissingOrBad)
{
  const test::TemporaryFolder folder;
  EXPECT_THROW((void)loadModel(folder.path() + "/none.yml.gz"), Unavailable);
  EXPECT_THROW((void)loadModel(write(folder, "empty.yml", "%YAML:1.0\n---\n")), InvalidArgument);
  EXPECT_THROW((void)loadModel(write(folder, "other.yml", "%YAML:1.0\n---\nformat: 1\n")),
               InvalidArgument);
  EXPECT_THROW((void)loadModel(write(folder, "text.yml", "no model at all")), InvalidArgument);
}

TEST(ModelFile, EveryDomainWithObjectsHasAModelOfThem)
{
  int domains = 0;
  for (const auto& domain : std::filesystem::directory_iterator(KR3_DOMAINS_DIR))
  {
    if (!std::filesystem::exists(domain.path() / "objects.yaml"))
      continue;
    SCOPED_TRACE(domain.path().filename().string());
    ++domains;
    const DetectorModel model = loadModel((domain.path() / "perception.yml.gz").string());
    const std::vector<ObjectDescription> objects =
        loadObjectList((domain.path() / "objects.yaml").string());
    ASSERT_EQ(model.objects.size(), objects.size());
    for (std::size_t i = 0; i < objects.size(); ++i)
    {
      EXPECT_EQ(model.objects[i].name, objects[i].name);
      EXPECT_EQ(model.objects[i].class_name, objects[i].class_name);
      EXPECT_DOUBLE_EQ(model.objects[i].height_m, objects[i].height_m);
    }
    EXPECT_NO_THROW(Detector(model, {}));
  }
  EXPECT_GE(domains, 4);
}

TEST(ObjectList, TakesSizesByShape)
{
  const test::TemporaryFolder folder;
  const std::string path = write(folder, "objects.yaml",
                                 "objects:\n"
                                 "  - {name: a, class: x, shape: box, size: [0.1, 0.3, 0.2]}\n"
                                 "  - {name: b, class: y, shape: cylinder, size: [0.11, 0.13]}\n");
  const std::vector<ObjectDescription> objects = loadObjectList(path);
  ASSERT_EQ(objects.size(), 2U);
  EXPECT_DOUBLE_EQ(objects[0].width_m, 0.3);
  EXPECT_DOUBLE_EQ(objects[0].height_m, 0.2);
  EXPECT_DOUBLE_EQ(objects[1].width_m, 0.11);
  EXPECT_DOUBLE_EQ(objects[1].height_m, 0.13);
}

TEST(ObjectList, NamesTheObjectThatIsWrong)
{
  const test::TemporaryFolder folder;
  EXPECT_THROW((void)loadObjectList(folder.path() + "/none.yaml"), Unavailable);
  EXPECT_THROW((void)loadObjectList(write(folder, "list.yaml", "things: []\n")), InvalidArgument);
  const std::string path = write(
      folder, "objects.yaml", "objects:\n  - {name: blob, class: x, shape: sphere, size: [0.1]}\n");
  try
  {
    (void)loadObjectList(path);
    FAIL() << "expected InvalidArgument";
  }
  catch (const InvalidArgument& e)
  {
    EXPECT_NE(std::string(e.what()).find("blob"), std::string::npos);
  }
}

}  // namespace
}  // namespace kr3::perception
