#pragma once

#include <opencv2/core/mat.hpp>

#include "kr3_sim_ode/camera.hpp"

namespace kr3::sim
{

/// Bends pictures of an ideal pinhole camera as the lens of a camera model does.
class Lens
{
public:
  /// @throws InvalidArgument  a coefficient is not finite, or the lens folds the picture or bends
  /// it
  ///                          so much that the pinhole picture would need twice the width or height
  explicit Lens(const CameraModel& camera);

  /// The pinhole picture to draw: its size, with the focal length of the camera model and the
  /// principal point in the middle. As large as the camera's without distortion.
  [[nodiscard]] int sourceWidth() const { return source_width_; }
  [[nodiscard]] int sourceHeight() const { return source_height_; }

  /// @param image          sourceHeight() x sourceWidth()
  /// @param interpolation  of OpenCV: nearest for masks, else linear
  /// @return  height x width of the camera
  [[nodiscard]] cv::Mat bent(const cv::Mat& image, int interpolation) const;

private:
  int source_width_;
  int source_height_;
  cv::Mat map_;           // CV_16SC2; empty without distortion
  cv::Mat map_fraction_;  // CV_16UC1
  cv::Mat nearest_map_;   // CV_16SC2, rounded
};

}  // namespace kr3::sim
