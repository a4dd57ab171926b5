#pragma once

#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>

namespace kr3::perception
{

/// Local gradient features of one image. Row i of `descriptors` belongs to `keypoints[i]`.
struct Features
{
  std::vector<cv::KeyPoint> keypoints;  ///< px, in the whole image (u right, v down)
  cv::Mat descriptors;                  ///< CV_8UC1, shape [keypoints, 128]
};

/// Finds SIFT features (Lowe 2004). Not thread-safe; one instance per thread.
class FeatureExtractor
{
public:
  /// @param max_features  per image, the strongest ones, > 0
  /// @throws InvalidArgument  max_features is not positive
  explicit FeatureExtractor(int max_features);

  /// Features inside `regions` only: the cost grows with their area, not with the image's.
  ///
  /// @param grey     CV_8UC1
  /// @param regions  px, clipped to the image; they should not overlap, or features come twice
  /// @param mask     empty, or CV_8UC1 of the image's size: features only where it is not 0
  [[nodiscard]] Features extract(const cv::Mat& grey, const std::vector<cv::Rect>& regions,
                                 const cv::Mat& mask = cv::Mat()) const;

private:
  int max_features_;
  cv::Ptr<cv::Feature2D> sift_;
};

}  // namespace kr3::perception
