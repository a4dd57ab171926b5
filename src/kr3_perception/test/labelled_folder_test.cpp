// Labelled folders in three formats: what is right is read, what is wrong is named.
#include "kr3_perception/labelled_folder.hpp"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include <kr3_common/error.hpp>

#include "kr3_perception/object_list.hpp"
#include "kr3_perception/trainer.hpp"
#include "synthetic_scenes.hpp"

namespace kr3::perception
{
namespace
{

class LabelledFolderTest : public testing::Test
{
protected:
  std::string write(const std::string& name, const std::string& text) const
  {
    const std::filesystem::path path = std::filesystem::path(folder_.path()) / name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path) << text;
    return path.string();
  }
  void picture(const std::string& name, int width = 100, int height = 80) const
  {
    const std::filesystem::path path = std::filesystem::path(folder_.path()) / name;
    std::filesystem::create_directories(path.parent_path());
    cv::imwrite(path.string(), cv::Mat(height, width, CV_8UC3, cv::Scalar(9, 99, 199)));
  }
  /// Reads the labels and all images; the message of what is thrown, else "".
  [[nodiscard]] std::string problem() const
  {
    try
    {
      const LabelledFolder folder(folder_.path());
      for (std::size_t i = 0; i < folder.size(); ++i)
        (void)folder.image(i);
    }
    catch (const Error& e)
    {
      return e.what();
    }
    return "";
  }

  test::TemporaryFolder folder_;
};

std::string ours(const std::string& object)
{
  return R"({"images": [{"image": "a.png", "objects": []}, {"image": "a.png", "objects": [)" +
         object + "]}]}";
}

TEST_F(LabelledFolderTest, ReadsOurOwnFormat)
{
  picture("a.png");
  write("labels.json", ours(R"({"name": "x", "box": [1, 2, 30, 40]})"));
  const LabelledFolder folder(folder_.path());
  ASSERT_EQ(folder.size(), 2U);
  EXPECT_EQ(folder.image(1).labels.at(0).box, cv::Rect(1, 2, 30, 40));
  EXPECT_THROW((void)folder.image(2), InvalidArgument);
}

TEST_F(LabelledFolderTest, ReadsCoco)
{
  picture("images/a.png");
  write("annotations.json", R"({
    "images": [{"id": 7, "file_name": "a.png", "width": 100, "height": 80}],
    "categories": [{"id": 3, "name": "cup"}],
    "annotations": [{"id": 1, "image_id": 7, "category_id": 3, "bbox": [10.2, 20.4, 29.9, 30.3]},
                    {"id": 2, "image_id": 7, "category_id": 3, "bbox": [60, 20, 30, 30]}]})");
  const LabelledFolder folder(folder_.path());
  const LabelledImage image = folder.image(0);
  ASSERT_EQ(image.labels.size(), 2U);
  EXPECT_EQ(image.labels[0].name, "cup");
  EXPECT_EQ(image.labels[0].box, cv::Rect(10, 20, 30, 31));
}

TEST_F(LabelledFolderTest, ReadsYolo)
{
  picture("images/a.jpg");
  picture("images/b.jpg");
  write("classes.txt", "cup\nplate\n");
  write("labels/a.txt", "1 0.5 0.5 0.2 0.25\n\n");
  const LabelledFolder folder(folder_.path());
  ASSERT_EQ(folder.size(), 2U);
  EXPECT_EQ(folder.image(0).labels.at(0).name, "plate");
  EXPECT_EQ(folder.image(0).labels.at(0).box, cv::Rect(40, 30, 20, 20));
  EXPECT_TRUE(folder.image(1).labels.empty());
}

TEST_F(LabelledFolderTest, MakesLargePhotographsSmaller)
{
  picture("a.png", 4000, 3000);
  write("labels.json", ours(R"({"name": "x", "box": [1000, 750, 2000, 1500]})"));
  const LabelledImage image = LabelledFolder(folder_.path()).image(1);
  EXPECT_EQ(image.bgr.size(), cv::Size(1280, 960));
  EXPECT_EQ(image.labels.at(0).box, cv::Rect(320, 240, 640, 480));
}

TEST_F(LabelledFolderTest, NamesFileAndEntryOfWhatIsWrong)
{
  picture("a.png");
  write("broken.png", "\x89PNG no picture");
  write("empty.png", "");
  const std::vector<std::pair<std::string, std::string>> cases{
      {"{", "labels.json"},
      {R"({"pictures": []})", "'images'"},
      {R"({"images": []})", "no images"},
      {ours("{}"), "image 1: object 0: 'name' is missing"},
      {ours(R"({"name": "x"})"), "image 1: object 0: 'box' is missing"},
      {ours(R"({"name": "x", "box": [1, 2, 3]})"), "image 1: object 0: 'box' is [1,2,3]"},
      {ours(R"({"name": "x", "box": [1, 2, 0, 4]})"),
       "image 1: object 0: the box [1,2,0,4] has no area"},
      {ours(R"({"name": "x", "box": [1, 2, -9, 4]})"), "has no area"},
      {ours(R"({"name": "x", "box": [90, 2, 30, 4]})"),
       "image 1: the box of 'x' [90, 2, 30, 4] leaves"},
      {ours(R"({"name": "x", "box": [1, 2, 30, 1e300]})"), "image 1: object 0"},
      {ours(R"({"name": "x", "box": [1, 2, 30, 4], "instance": 300})"),
       "'instance' is 300, expected a whole number from 0 to 255"},
      {ours(R"({"name": "x", "box": [1, 2, 30, 4], "pixels": 1e300})"), "'pixels' is 1e+300"},
      {ours(R"({"name": "x", "box": [1, 2, 30, 4], "pixels": 2.5})"), "'pixels' is 2.5"},
      {ours(R"({"name": "x", "box": [1, 2, 40000, 4]})"), "'box' is [1,2,40000,4]"},
      {ours(R"({"name": 5, "box": [1, 2, 30, 4]})"), "'name' is 5"},
      {R"({"images": [{"image": "none.png", "objects": []}]})", "image 0: cannot read"},
      {R"({"images": [{"image": "broken.png", "objects": []}]})", "broken.png"},
      {R"({"images": [{"image": "empty.png", "objects": []}]})", "empty.png"},
      {R"({"images": [{"image": "a.png", "mask": "none.png", "objects": []}]})", "none.png"},
  };
  for (const auto& [text, words] : cases)
  {
    write("labels.json", text);
    EXPECT_NE(problem().find(words), std::string::npos) << text << "\n  gives: " << problem();
  }
}

TEST_F(LabelledFolderTest, NamesEntriesOfCocoThatAreWrong)
{
  picture("a.png");
  const std::string head =
      R"({"images": [{"id": 1, "file_name": "a.png"}], "categories": [{"id": 1, "name": "x"}], "annotations": [)";
  const std::vector<std::pair<std::string, std::string>> cases{
      {R"({"image_id": 2, "category_id": 1, "bbox": [1, 1, 9, 9]})",
       "annotation 0: there is no image with the id 2"},
      {R"({"image_id": 1, "category_id": 5, "bbox": [1, 1, 9, 9]})",
       "annotation 0: there is no category with the id 5"},
      {R"({"image_id": 1, "category_id": 1})", "annotation 0: 'bbox' is missing"},
      {R"({"image_id": 1, "category_id": 1, "bbox": [1, 1, 0, 9]})", "has no area"},
      {R"({"image_id": 1, "category_id": 1, "bbox": [1, 70, 9, 90]})", "leaves the image"},
  };
  for (const auto& [annotation, words] : cases)
  {
    write("coco.json", head + annotation + "]}");
    EXPECT_NE(problem().find(words), std::string::npos) << annotation << "\n  gives: " << problem();
  }
}

TEST_F(LabelledFolderTest, NamesLinesOfYoloThatAreWrong)
{
  picture("a.png");
  write("classes.txt", "cup\n");
  for (const auto& [line, words] : std::vector<std::pair<std::string, std::string>>{
           {"0 0.5 0.5 0.1", "a.txt:1: found '0 0.5 0.5 0.1'"},
           {"cup 0.5 0.5 0.1 0.1", "a.txt:1"},
           {"4 0.5 0.5 0.1 0.1", "class 4 of 1"},
           {"0 0.5 0.5 0 0.1", "has no area"},
           {"0 0.9 0.5 0.5 0.1", "leaves the image"},
           {"0 120 80 30 40", "leaves the image"}})
  {
    write("a.txt", line + "\n");
    EXPECT_NE(problem().find(words), std::string::npos) << line << "\n  gives: " << problem();
  }
  write("classes.txt", "\n");
  EXPECT_NE(problem().find("expected one name a line"), std::string::npos);
}

TEST_F(LabelledFolderTest, NamesAFolderWithoutLabels)
{
  EXPECT_NE(problem().find("expected labels.json"), std::string::npos);
  EXPECT_THROW(LabelledFolder(folder_.path() + "/nowhere"), Unavailable);
}

TEST_F(LabelledFolderTest, SplitsIntoPartsThatTogetherAreTheWhole)
{
  const test::SyntheticWorld world(2);
  world.writeFolder(folder_.path(), 7, 1, false);
  const auto [most, some] = LabelledFolder(folder_.path()).split(3);
  EXPECT_EQ(most.size(), 5U);
  EXPECT_EQ(some.size(), 2U);
  EXPECT_THROW((void)some.split(3), InvalidArgument);
}

TEST_F(LabelledFolderTest, TrainsWithoutAnObjectsFileAndSaysWhatItDoesNotKnow)
{
  const test::SyntheticWorld world(3);
  world.writeFolder(folder_.path(), 30, 1, false);
  const auto [most, some] = LabelledFolder(folder_.path()).split(3);
  std::vector<ObjectDescription> objects = objectsOf({most});
  ASSERT_EQ(objects.size(), 3U);
  objects.pop_back();
  std::string said;
  TrainerOptions options;
  options.views_per_object = 3;
  const DetectorModel model =
      Trainer(objects, options).train({most}, {some}, [&](const std::string& line) {
        said += line + "\n";
      });
  EXPECT_NE(said.find("'object2' is no object to be learned"), std::string::npos) << said;
  EXPECT_EQ(model.objects.at(0).height_m, 0.0);
}

}  // namespace
}  // namespace kr3::perception
