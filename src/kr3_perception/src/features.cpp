#include "kr3_perception/features.hpp"

#include <algorithm>

#include "kr3_common/error.hpp"

namespace kr3::perception
{
namespace
{

constexpr int kLayersPerOctave = 3;
constexpr double kContrastThreshold = 0.03;
constexpr double kEdgeThreshold = 10.0;
constexpr double kSigma = 1.6;

}  // namespace

FeatureExtractor::FeatureExtractor(int max_features) : max_features_(max_features)
{
  if (max_features <= 0)
    throw InvalidArgument("max_features is " + std::to_string(max_features) + ", expected > 0");
  sift_ = cv::SIFT::create(max_features, kLayersPerOctave, kContrastThreshold, kEdgeThreshold,
                           kSigma, CV_8U);
}

Features FeatureExtractor::extract(const cv::Mat& grey, const std::vector<cv::Rect>& regions,
                                   const cv::Mat& mask) const
{
  Features all;
  all.descriptors.create(0, sift_->descriptorSize(), CV_8U);
  const cv::Rect image(0, 0, grey.cols, grey.rows);
  for (const cv::Rect& region : regions)
  {
    const cv::Rect part = region & image;
    if (part.width < 8 || part.height < 8)
      continue;
    std::vector<cv::KeyPoint> keypoints;
    cv::Mat descriptors;
    sift_->detectAndCompute(grey(part), mask.empty() ? cv::Mat() : mask(part), keypoints,
                            descriptors);
    for (cv::KeyPoint& keypoint : keypoints)
      keypoint.pt += cv::Point2f(part.tl());
    all.keypoints.insert(all.keypoints.end(), keypoints.begin(), keypoints.end());
    if (!descriptors.empty())
      all.descriptors.push_back(descriptors);
  }
  const std::size_t limit = static_cast<std::size_t>(max_features_);
  if (all.keypoints.size() <= limit)
    return all;
  std::vector<int> order(all.keypoints.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    order[i] = static_cast<int>(i);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return all.keypoints[static_cast<std::size_t>(a)].response >
           all.keypoints[static_cast<std::size_t>(b)].response;
  });
  Features strongest;
  strongest.descriptors.create(0, all.descriptors.cols, CV_8U);
  for (std::size_t i = 0; i < limit; ++i)
  {
    strongest.keypoints.push_back(all.keypoints[static_cast<std::size_t>(order[i])]);
    strongest.descriptors.push_back(all.descriptors.row(order[i]));
  }
  return strongest;
}

}  // namespace kr3::perception
