#include "view_matcher.hpp"

#include <algorithm>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "synthetic_scenes.hpp"

namespace kr3::perception
{
namespace
{

/// A model that holds the front of each object as its only view.
DetectorModel frontsOnly(const test::SyntheticWorld& world)
{
  const int n = static_cast<int>(world.objects().size());
  DetectorModel model{world.objects(),
                      std::vector<ShapeModel>(world.objects().size(), {{}, {1.0, 1.0, 1.0, 1.0}}),
                      {},
                      cv::Mat(0, 128, CV_8U),
                      ForegroundModel(cv::Mat::zeros(2, ForegroundModel::kBins, CV_32F)),
                      ObjectColourModel(cv::Mat::zeros(n, ForegroundModel::kBins, CV_8U)),
                      {}};
  const FeatureExtractor extractor(200);
  for (int i = 0; i < n; ++i)
  {
    const cv::Mat& front = world.front(i);
    cv::Mat grey;
    cv::cvtColor(front, grey, cv::COLOR_BGR2GRAY);
    const Features features = extractor.extract(grey, {cv::Rect({}, grey.size())});
    ViewModel view{i,
                   front.size(),
                   cv::Mat::zeros(1, kHistogramBins, CV_32F),
                   cv::Mat(kThumbnailSide, kThumbnailSide, CV_8UC4, cv::Scalar::all(255)),
                   features.keypoints,
                   features.descriptors};
    for (cv::KeyPoint& keypoint : view.keypoints)
      keypoint.pt -=
          cv::Point2f(static_cast<float>(front.cols) / 2.0F, static_cast<float>(front.rows) / 2.0F);
    model.views.push_back(view);
  }
  return model;
}

TEST(ViewMatcher, FindsAKnownSimilarity)
{
  const test::SyntheticWorld world(3);
  const DetectorModel model = frontsOnly(world);
  const ViewMatcher matcher(model, 64);
  // Object 1, scaled by 0.8, turned by 10 degrees, with its centre at (200, 150).
  cv::Mat placed = cv::getRotationMatrix2D({60.0F, 80.0F}, 10.0, 0.8);
  placed.at<double>(0, 2) += 200.0 - 60.0;
  placed.at<double>(1, 2) += 150.0 - 80.0;
  cv::Mat image(300, 400, CV_8UC3, cv::Scalar(200, 200, 200));
  cv::warpAffine(world.front(1), image, placed, image.size(), cv::INTER_AREA,
                 cv::BORDER_TRANSPARENT);
  cv::Mat grey;
  cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  const MatchResult result =
      matcher.match(FeatureExtractor(300).extract(grey, {cv::Rect({}, grey.size())}));
  ASSERT_EQ(result.best.size(), 1U);
  const ViewMatch& match = result.best.front();
  EXPECT_EQ(match.object, 1);
  EXPECT_GE(match.inliers, 10);
  EXPECT_GT(match.inlier_ratio, 0.7);
  EXPECT_NEAR(match.box.x + match.box.width / 2.0, 200.0, 3.0);
  EXPECT_NEAR(match.box.y + match.box.height / 2.0, 150.0, 3.0);
  EXPECT_NEAR(match.box.width, 0.8 * 120.0, 5.0);
}

TEST(ViewMatcher, FindsAsManyInstancesAsThereMayBe)
{
  const test::SyntheticWorld world(2);
  DetectorModel model = frontsOnly(world);
  cv::Mat image(300, 500, CV_8UC3, cv::Scalar(200, 200, 200));
  for (const int x : {40, 320})
    world.front(0).copyTo(image(cv::Rect({x, 60}, world.front(0).size())));
  cv::Mat grey;
  cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  const Features features = FeatureExtractor(400).extract(grey, {cv::Rect({}, grey.size())});
  EXPECT_EQ(ViewMatcher(model, 64).match(features).best.size(), 1U);
  model.objects[0].max_in_image = 3;
  const std::vector<ViewMatch> both = ViewMatcher(model, 64).match(features).best;
  ASSERT_EQ(both.size(), 2U);
  EXPECT_NEAR(std::abs(both[0].box.x - both[1].box.x), 280.0, 6.0);
}

TEST(ViewMatcher, TellsOtherViewsThatGiveAnotherBox)
{
  const test::SyntheticWorld world(2);
  DetectorModel model = frontsOnly(world);
  // Seen over a corner: the front is the left half of the view, plain on the right.
  ViewModel corner = model.views[0];
  const int width = corner.size.width;
  corner.size.width = 2 * width;
  for (cv::KeyPoint& keypoint : corner.keypoints)
    keypoint.pt.x -= static_cast<float>(width) / 2.0F;
  model.views.push_back(corner);
  cv::Mat image(300, 500, CV_8UC3, cv::Scalar(200, 200, 200));
  world.front(0).copyTo(image(cv::Rect({40, 60}, world.front(0).size())));
  cv::Mat grey;
  cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  const MatchResult result = ViewMatcher(model, 64).match(
      FeatureExtractor(400).extract(grey, {cv::Rect({}, grey.size())}));
  ASSERT_EQ(result.best.size(), 1U);
  ASSERT_EQ(result.others.size(), 1U);
  std::vector<int> widths = {result.best[0].box.width, result.others[0].box.width};
  std::sort(widths.begin(), widths.end());
  EXPECT_NEAR(widths[0], width, 6);
  EXPECT_NEAR(widths[1], 2 * width, 12);
  EXPECT_NEAR(result.best[0].box.x, 40, 5);
  EXPECT_NEAR(result.others[0].box.x, 40, 5);
}

TEST(ViewMatcher, FindsNothingInAnEmptyImage)
{
  const test::SyntheticWorld world(2);
  const DetectorModel model = frontsOnly(world);
  const ViewMatcher matcher(model, 32);
  const MatchResult result = matcher.match(Features{{}, cv::Mat(0, 128, CV_8U)});
  EXPECT_TRUE(result.best.empty());
  EXPECT_TRUE(result.votes.empty());
}

TEST(FeatureExtractor, LooksOnlyInItsRegionsAndKeepsTheStrongest)
{
  const test::SyntheticWorld world(1);
  cv::Mat grey;
  cv::cvtColor(world.front(0), grey, cv::COLOR_BGR2GRAY);
  const cv::Rect region(20, 20, 60, 60);
  const Features features = FeatureExtractor(10).extract(grey, {region});
  ASSERT_FALSE(features.keypoints.empty());
  EXPECT_LE(features.keypoints.size(), 10U);
  EXPECT_EQ(static_cast<std::size_t>(features.descriptors.rows), features.keypoints.size());
  for (const cv::KeyPoint& keypoint : features.keypoints)
    EXPECT_TRUE(region.contains(keypoint.pt));
}

}  // namespace
}  // namespace kr3::perception
