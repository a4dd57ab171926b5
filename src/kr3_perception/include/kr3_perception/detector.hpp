#pragma once

#include <memory>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "kr3_perception/detector_model.hpp"

namespace kr3::perception
{

/// One object found in an image.
struct Detection
{
  std::string name;
  std::string class_name;
  double probability = 0.0;  ///< calibrated: of all detections with p, a share p is right
  cv::Rect box;              ///< px, inside the image
};

struct DetectorOptions
{
  double min_probability = 0.3;  ///< detections below are not reported, [0, 1)
  int max_features = 600;        ///< per image, > 0
  int search_checks = 32;        ///< leaves visited in the nearest-neighbour trees per feature, > 0
  int max_instances = 0;         ///< of one object an image; 0 = as many as training showed
};

/// Finds learned objects in images. Not thread-safe; one instance per thread.
class Detector
{
public:
  /// @throws InvalidArgument  inconsistent model, not calibrated, or options out of range
  Detector(DetectorModel model, const DetectorOptions& options);
  ~Detector();
  Detector(Detector&&) noexcept;
  Detector& operator=(Detector&&) noexcept;

  /// An image with a side above kMaxImageSide is looked at that large, so that the cost is bounded.
  ///
  /// @param bgr  CV_8UC3, BGR, rows x columns, at least 16 x 16 px, at most 100 megapixels
  /// @return best first; empty when nothing is seen
  /// @throws InvalidArgument  another type, too small or too large
  [[nodiscard]] std::vector<Detection> detect(const cv::Mat& bgr) const;

  [[nodiscard]] const DetectorModel& model() const;

private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kr3::perception
