#pragma once

#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "kr3_perception/detector_model.hpp"

namespace kr3::perception
{

/// A calibrated camera, in pixels.
struct Intrinsics
{
  double fx = 0.0;
  double fy = 0.0;
  double cx = 0.0;
  double cy = 0.0;
  cv::Size image_size;
  bool fisheye = false;  ///< `distortion` is of the equidistant model (4 values)
  /// Of the lens: k1 k2 p1 p2 [k3 [k4 k5 k6]] (Brown's model, as OpenCV orders it); empty = none.
  std::vector<double> distortion;
};

/// The ray through a pixel, the lens's distortion taken out.
///
/// @param pixel  px, in the image as taken
/// @return (x / z, y / z) in the camera optical frame (x right, y down, z forward)
/// @throws InvalidArgument  focal lengths are not positive, or a number of distortion coefficients
///                          that no model has
[[nodiscard]] cv::Point2d normalisedRay(const cv::Point2d& pixel, const Intrinsics& camera);

/// Centre of an object, from its apparent size.
///
/// The height of the box gives the range; where the image cuts the box off above or below, its
/// width does, and where it is cut off on both axes, or the object's size is not known, there is no
/// answer. The error grows with range: one pixel of a box h pixels high is a share 1/h of the
/// range. The sides of the box are measured along its middle lines, undistorted.
///
/// @param box  px, in the image as taken
/// @return m, camera optical frame (x right, y down, z forward), or nothing
/// @throws InvalidArgument  as normalisedRay()
[[nodiscard]] std::optional<cv::Point3d> positionFromBox(const cv::Rect& box,
                                                         const ObjectDescription& object,
                                                         const Intrinsics& camera);

}  // namespace kr3::perception
