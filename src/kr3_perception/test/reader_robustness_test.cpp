// Files that nobody should write: every reader either takes a damaged file or refuses it with an
// error of ours, and what it takes can be used. KR3_PERCEPTION_CASES (more cases) and
// KR3_PERCEPTION_SEED are for long runs, with sanitizers.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>
#include <string>
#include <vector>

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

namespace fs = std::filesystem;

std::size_t environment(const char* name, std::size_t otherwise)
{
  const char* value = std::getenv(name);
  return value == nullptr ? otherwise : std::strtoull(value, nullptr, 10);
}

std::size_t numCases(std::size_t quick)
{
  return quick * environment("KR3_PERCEPTION_CASES", 1);
}

std::string contentOf(const fs::path& path)
{
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void write(const fs::path& path, const std::string& content)
{
  std::ofstream(path, std::ios::binary) << content;
}

/// One to three damages: bytes, words, numbers, lines, ends.
std::string damaged(std::string text, std::mt19937_64& random)
{
  static const std::vector<std::string> kWords = {"-1",          "0",          "1e999",
                                                  "nan",         ".Nan",       ".Inf",
                                                  "99999999999", "2147483647", "-2147483648",
                                                  "65536",       "3.7",        "1e300",
                                                  "\"x\"",       "[",          "]",
                                                  "{",           "}",          ":",
                                                  ",",           "\"",         "null",
                                                  "~",           "u",          "d",
                                                  "f",           "%YAML",      "!!opencv-matrix",
                                                  "\n",          "\xff",       "...",
                                                  "---",         "&a *a",      "<<"};
  const std::size_t num_damages = 1 + random() % 3;
  for (std::size_t i = 0; i < num_damages && !text.empty(); ++i)
  {
    // Half of the damages go where names of values are, which are rare in files full of numbers.
    std::size_t at = random() % text.size();
    if (random() % 2 == 0)
      at = std::min(text.find(random() % 2 == 0 ? ':' : '"', at), text.size() - 1);
    const std::size_t length = std::min<std::size_t>(1 + random() % 8, text.size() - at);
    const std::string& word = kWords[random() % kWords.size()];
    switch (random() % 8)
    {
      case 0:
        text[at] = static_cast<char>(random());
        break;
      case 1:
        text.erase(at, length);
        break;
      case 2:
        text.insert(at, word);
        break;
      case 3:
        text.replace(at, length, word);
        break;
      case 4:
        if (random() % 4 == 0)
          text.resize(at);
        break;
      case 5:  // a part again
        text.insert(random() % text.size(), text.substr(at, 40));
        break;
      default:  // another number
      {
        const std::size_t begin = text.find_first_of("0123456789", at);
        if (begin == std::string::npos)
          break;
        const std::size_t end = text.find_first_not_of("0123456789.e+-", begin);
        text.replace(begin, (end == std::string::npos ? text.size() : end) - begin, word);
      }
    }
  }
  return text;
}

/// Runs `use`, which may throw an error of ours and nothing else. @return whether it went through
bool takes(const std::function<void()>& use, const std::string& what)
{
  try
  {
    use();
    return true;
  }
  catch (const Error& e)
  {
    EXPECT_GT(std::string(e.what()).size(), 10U) << what;
  }
  catch (const std::exception& e)
  {
    ADD_FAILURE() << what << ": " << e.what();
  }
  return false;
}

class Readers : public testing::Test
{
protected:
  /// Each damaged content of `file` once, then the file is as it was. At least one is taken, one
  /// refused.
  void damage(const fs::path& file, std::size_t cases, const std::function<void()>& use)
  {
    const std::string sound = contentOf(file);
    ASSERT_FALSE(sound.empty()) << file;
    ASSERT_TRUE(takes(use, "undamaged"));
    std::size_t taken = 0;
    const std::size_t first = environment("KR3_PERCEPTION_SEED", 1);
    for (std::size_t seed = first; seed < first + cases; ++seed)
    {
      std::mt19937_64 random(seed);
      write(file, damaged(sound, random));
      taken += takes(use, file.filename().string() + ", seed " + std::to_string(seed)) ? 1 : 0;
    }
    for (const std::string& content : {std::string(), sound.substr(0, sound.size() / 2)})
    {
      write(file, content);
      (void)takes(use,
                  file.filename().string() + " of " + std::to_string(content.size()) + " bytes");
    }
    write(file, sound);
    EXPECT_GT(taken, 0U);
    EXPECT_LT(taken, cases);
  }

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
  damage(file, numCases(60), [&] { (void)Detector(loadModel(file), {}).detect(image.bgr); });
}

TEST_F(Readers, OfOurLabels)
{
  world_.writeFolder(path_ / "set", 3, 1, true);
  damage(path_ / "set" / "labels.json", numCases(600), [&] { readAll(); });
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
  damage(path_ / "set" / "coco.json", numCases(600), [&] { readAll(); });
}

TEST_F(Readers, OfYoloLabels)
{
  world_.writeFolder(path_ / "set", 1, 1, false);
  fs::remove(path_ / "set" / "labels.json");
  const fs::path image = fs::directory_iterator(path_ / "set")->path();
  write(path_ / "set" / "classes.txt", "mug\npot\n");
  write(fs::path(image).replace_extension(".txt"), "0 0.5 0.5 0.25 0.25\n1 0.2 0.3 0.1 0.125\n");
  damage(fs::path(image).replace_extension(".txt"), numCases(600), [&] { readAll(); });
  damage(path_ / "set" / "classes.txt", numCases(100), [&] { readAll(); });
}

TEST_F(Readers, OfImages)
{
  world_.writeFolder(path_ / "set", 1, 1, true);
  for (const fs::directory_entry& entry : fs::directory_iterator(path_ / "set"))
    if (entry.path().extension() == ".png")
      damage(entry.path(), numCases(100), [&] { readAll(); });
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
  damage(path_ / "objects.yaml", numCases(1000),
         [&] { (void)loadObjectList(path_ / "objects.yaml"); });
}

TEST_F(Readers, WhatIsReadCanBeLearnedFrom)
{
  world_.writeFolder(path_ / "set", 6, 1, true);
  TrainerOptions options;
  options.views_per_object = 2;
  damage(path_ / "set" / "labels.json", numCases(40), [&] {
    const std::vector<LabelledFolder> folders = {LabelledFolder(path_ / "set")};
    (void)Trainer(objectsOf(folders), options).train(folders, folders, [](const std::string&) {});
  });
}

}  // namespace
}  // namespace kr3::perception
