// Files that nobody should write: every reader either takes a damaged file or
// refuses it with an error of ours, and what it takes can be used. See
// damaged_files.hpp for long runs.
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <kr3_common/testing/damaged_files.hpp>

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

namespace fs = std::filesystem;
using kr3::test_support::damageFile;
using kr3::test_support::write;

class Readers : public ::testing::Test
{
protected:
  void readAll() const
  {
    const LabelledFolder folder(path_ / "set");
    for (std::size_t i = 0; i < folder.size(); ++i)
    {
      const LabelledImage image = folder.image(i);
      for (const Label& label : image.labels)
        (void)maskOf(image, label);
    }
  }

  test::TemporaryFolder folder_;
  fs::path path_ = folder_.path();
  test::SyntheticWorld world_{2};
};

TEST_F(Readers, OfModels)
{
  world_.writeFolder(path_ / "set", 8, 1, true);
  const LabelledFolder images(path_ / "set");
  TrainerOptions options;
  options.views_per_object = 2;
  options.keypoints_per_view = 10;
  options.background_features = 20;
  const fs::path file = path_ / "model.yml";
  saveModel(Trainer(world_.objects(), options).train({images}, {images}, [](const std::string&) {}),
            file);
  const LabelledImage image = world_.scene(99);
  EXPECT_GT(damageFile(file, 60, [&] { (void)Detector(loadModel(file), {}).detect(image.bgr); }),
            0U);
}

TEST_F(Readers, OfOurLabels)
{
  world_.writeFolder(path_ / "set", 3, 1, true);
  EXPECT_GT(damageFile(path_ / "set" / "labels.json", 600, [&] { readAll(); }), 0U);
}

TEST_F(Readers, OfCocoLabels)
{
  world_.writeFolder(path_ / "set", 2, 1, false);
  fs::remove(path_ / "set" / "labels.json");
  std::string names;
  for (const fs::directory_entry& entry : fs::directory_iterator(path_ / "set"))
    names += R"({"file_name": ")" + entry.path().filename().string() + R"(", "id": )" +
             std::to_string(names.size()) + "},";
  names.pop_back();
  write(
      path_ / "set" / "coco.json",
      R"({"images": [)" + names +
          R"(], "categories": [{"id": 3, "name": "mug"}, {"id": 4, "name": "pot"}], "annotations": [
{"image_id": 0, "category_id": 3, "bbox": [10.5, 20, 30, 40.25], "iscrowd": 0},
{"image_id": 0, "category_id": 4, "bbox": [100, 20, 30, 40]}]})");
  EXPECT_GT(damageFile(path_ / "set" / "coco.json", 600, [&] { readAll(); }), 0U);
}

TEST_F(Readers, OfYoloLabels)
{
  world_.writeFolder(path_ / "set", 1, 1, false);
  fs::remove(path_ / "set" / "labels.json");
  const fs::path image = fs::directory_iterator(path_ / "set")->path();
  write(path_ / "set" / "classes.txt", "mug\npot\n");
  write(fs::path(image).replace_extension(".txt"), "0 0.5 0.5 0.25 0.25\n1 0.2 0.3 0.1 0.125\n");
  EXPECT_GT(damageFile(fs::path(image).replace_extension(".txt"), 600, [&] { readAll(); }), 0U);
  EXPECT_GT(damageFile(path_ / "set" / "classes.txt", 100, [&] { readAll(); }), 0U);
}

TEST_F(Readers, OfImages)
{
  world_.writeFolder(path_ / "set", 1, 1, true);
  for (const fs::directory_entry& entry : fs::directory_iterator(path_ / "set"))
  {
    if (entry.path().extension() != ".png")
      continue;
    EXPECT_GT(damageFile(entry.path(), 100, [&] { readAll(); }), 0U);
  }
}

TEST_F(Readers, OfObjectLists)
{
  write(path_ / "objects.yaml", R"(objects:
  - {name: tb, class: textbook, shape: box, size: [0.06, 0.21, 0.28], mass: 0.8, texture: textures/tb.png}
  - name: mug
    class: kitchenware
    shape: cylinder
    size: [0.11, 0.13]
)");
  EXPECT_GT(damageFile(path_ / "objects.yaml", 1000,
                       [&] { (void)loadObjectList(path_ / "objects.yaml"); }),
            0U);
}

TEST_F(Readers, WhatIsReadCanBeLearnedFrom)
{
  world_.writeFolder(path_ / "set", 6, 1, true);
  TrainerOptions options;
  options.views_per_object = 2;
  EXPECT_GT(damageFile(
                path_ / "set" / "labels.json", 40,
                [&] {
    const std::vector<LabelledFolder> folders = {LabelledFolder(path_ / "set")};
    (void)Trainer(objectsOf(folders), options).train(folders, folders, [](const std::string&) {});
                }),
            0U);
}

}  // namespace
}  // namespace kr3::perception
