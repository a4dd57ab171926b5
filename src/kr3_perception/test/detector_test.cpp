#include "kr3_perception/detector.hpp"

#include <map>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include <kr3_common/error.hpp>

#include "kr3_perception/evaluation.hpp"
#include "kr3_perception/trainer.hpp"
#include "synthetic_scenes.hpp"

namespace kr3::perception
{
namespace
{

const Progress kSilent = [](const std::string&) {};

TrainerOptions quickOptions()
{
  TrainerOptions options;
  options.views_per_object = 6;
  options.background_features = 100;
  return options;
}

/// Trained once for all tests of this file.
class DetectorTest : public testing::Test
{
protected:
  static void SetUpTestSuite()
  {
    const test::TemporaryFolder folder;
    world_ = std::make_unique<test::SyntheticWorld>(4);
    world_->writeFolder(folder.path() + "/looks", 40, 1, true);
    world_->writeFolder(folder.path() + "/boxes", 40, 1, false);
    world_->writeFolder(folder.path() + "/calibration", 40, 1000, true);
    const Trainer trainer(world_->objects(), quickOptions());
    const LabelledFolder calibration(folder.path() + "/calibration");
    model_ = std::make_unique<DetectorModel>(
        trainer.train({LabelledFolder(folder.path() + "/looks")}, {calibration}, kSilent));
    box_model_ = std::make_unique<DetectorModel>(
        trainer.train({LabelledFolder(folder.path() + "/boxes")}, {calibration}, kSilent));
  }
  static void TearDownTestSuite()
  {
    model_.reset();
    box_model_.reset();
    world_.reset();
  }

  static Evaluation evaluate(const DetectorModel& model)
  {
    std::map<std::string, std::string> class_of;
    for (const ObjectDescription& object : model.objects)
      class_of[object.name] = object.class_name;
    DetectorOptions options;
    options.min_probability = 0.05;
    const Detector detector(model, options);
    Evaluation evaluation(0.5, 250, 0.4);
    for (std::uint64_t seed = 5000; seed < 5050; ++seed)
    {
      const LabelledImage image = world_->scene(seed);
      evaluation.add(detector.detect(image.bgr), image.labels, class_of);
    }
    return evaluation;
  }

  static std::unique_ptr<test::SyntheticWorld> world_;
  static std::unique_ptr<DetectorModel> model_;
  static std::unique_ptr<DetectorModel> box_model_;
};

std::unique_ptr<test::SyntheticWorld> DetectorTest::world_;
std::unique_ptr<DetectorModel> DetectorTest::model_;
std::unique_ptr<DetectorModel> DetectorTest::box_model_;

TEST_F(DetectorTest, FindsWhatItLearnedInNewImages)
{
  const Evaluation evaluation = evaluate(*model_);
  EXPECT_GT(evaluation.total().precision(), 0.95);
  EXPECT_GT(evaluation.total().recall(), 0.9);
  EXPECT_LT(evaluation.brier(), 0.08);
}

TEST_F(DetectorTest, LearnsFromBoxesAlone)
{
  const Evaluation evaluation = evaluate(*box_model_);
  EXPECT_GT(evaluation.total().precision(), 0.9);
  EXPECT_GT(evaluation.total().recall(), 0.8);
}

TEST_F(DetectorTest, SeesNothingOnAnEmptyWall)
{
  const Detector detector(*model_, {});
  EXPECT_TRUE(detector.detect(cv::Mat(240, 320, CV_8UC3, cv::Scalar(205, 215, 220))).empty());
}

TEST_F(DetectorTest, GivesTheSameAnswerTwice)
{
  const LabelledImage image = world_->scene(77);
  const std::vector<Detection> first = Detector(*model_, {}).detect(image.bgr);
  const std::vector<Detection> second = Detector(*model_, {}).detect(image.bgr);
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i)
  {
    EXPECT_EQ(first[i].name, second[i].name);
    EXPECT_EQ(first[i].probability, second[i].probability);
    EXPECT_EQ(first[i].box, second[i].box);
  }
}

TEST_F(DetectorTest, ReportsEachObjectOnceInsideTheImageBestFirst)
{
  DetectorOptions options;
  options.min_probability = 0.0;
  const Detector detector(*model_, options);
  for (std::uint64_t seed = 0; seed < 10; ++seed)
  {
    const LabelledImage image = world_->scene(seed);
    std::map<std::string, int> count;
    double last = 1.0;
    for (const Detection& detection : detector.detect(image.bgr))
    {
      EXPECT_EQ(++count[detection.name], 1);
      EXPECT_LE(detection.probability, last);
      last = detection.probability;
      EXPECT_EQ(detection.box & cv::Rect({}, image.bgr.size()), detection.box);
    }
  }
}

TEST_F(DetectorTest, RejectsImagesItCannotRead)
{
  const Detector detector(*model_, {});
  EXPECT_THROW((void)detector.detect(cv::Mat()), InvalidArgument);
  EXPECT_THROW((void)detector.detect(cv::Mat::zeros(240, 320, CV_8U)), InvalidArgument);
  EXPECT_THROW((void)detector.detect(cv::Mat::zeros(4, 4, CV_8UC3)), InvalidArgument);
  EXPECT_THROW((void)detector.detect(cv::Mat::zeros(10001, 10000, CV_8UC3)), InvalidArgument);
}

TEST_F(DetectorTest, LooksAtLargeImagesSmaller)
{
  const LabelledImage image = world_->scene(5003);
  const Detector detector(*model_, {});
  const std::vector<Detection> small = detector.detect(image.bgr);
  cv::Mat large;
  cv::resize(image.bgr, large, {}, 8.0, 8.0, cv::INTER_LINEAR);
  ASSERT_FALSE(small.empty());
  for (const Detection& detection : detector.detect(large))
    EXPECT_EQ(detection.box & cv::Rect({}, large.size()), detection.box);
}

TEST_F(DetectorTest, ReportsEqualObjectsWhenToldThatThereMayBeSome)
{
  // Two pictures of the same scene beside each other hold every object twice.
  const LabelledImage image = world_->scene(5003);
  cv::Mat twice;
  cv::hconcat(image.bgr, image.bgr, twice);
  ASSERT_FALSE(image.labels.empty());
  DetectorOptions options;
  const auto most = [&] {
    std::map<std::string, int> count;
    for (const Detection& detection : Detector(*model_, options).detect(twice))
      ++count[detection.name];
    int result = 0;
    for (const auto& [name, n] : count)
      result = std::max(result, n);
    return result;
  };
  EXPECT_EQ(most(), 1);
  options.max_instances = 4;
  EXPECT_EQ(most(), 2);
}

TEST_F(DetectorTest, RejectsBadModelsAndOptions)
{
  DetectorOptions options;
  options.min_probability = 1.0;
  EXPECT_THROW(Detector(*model_, options), InvalidArgument);
  options = {};
  options.max_instances = -1;
  EXPECT_THROW(Detector(*model_, options), InvalidArgument);
  DetectorModel uncalibrated = *model_;
  uncalibrated.classifier = BoostedTrees();
  EXPECT_THROW(Detector(uncalibrated, {}), InvalidArgument);
  DetectorModel wrong = *model_;
  wrong.views.front().object = 99;
  EXPECT_THROW(Detector(wrong, {}), InvalidArgument);
}

TEST(Trainer, SaysWhichObjectItNeverSaw)
{
  const test::TemporaryFolder folder;
  const test::SyntheticWorld world(2);
  world.writeFolder(folder.path(), 6, 1, true);
  std::vector<ObjectDescription> objects = world.objects();
  objects.push_back({"unicorn", "animal", 1.0, 1.0});
  const LabelledFolder labelled(folder.path());
  try
  {
    (void)Trainer(objects, quickOptions()).train({labelled}, {labelled}, kSilent);
    FAIL() << "expected InvalidArgument";
  }
  catch (const InvalidArgument& e)
  {
    EXPECT_NE(std::string(e.what()).find("unicorn"), std::string::npos);
  }
}

TEST(Trainer, RejectsEmptyAndDoubledObjects)
{
  EXPECT_THROW(Trainer({}, {}), InvalidArgument);
  EXPECT_THROW(Trainer({{"a", "x", 1.0, 1.0}, {"a", "x", 1.0, 1.0}}, {}), InvalidArgument);
}

}  // namespace
}  // namespace kr3::perception
