#pragma once

#include <optional>

#include <opencv2/core.hpp>

#include "kr3_perception/detector_model.hpp"

namespace kr3::perception
{

/// A pinhole camera without distortion, in pixels.
struct Intrinsics
{
  double fx = 0.0;
  double fy = 0.0;
  double cx = 0.0;
  double cy = 0.0;
  cv::Size image_size;
};

/// Centre of an object, from its apparent size.
///
/// The height of the box gives the range; where the image cuts the box off above or below, its
/// width does, and where it is cut off on both axes there is no answer. The error grows with range:
/// one pixel of a box h pixels high is a share 1/h of the range.
///
/// @param box  px, in an undistorted image
/// @return m, camera optical frame (x right, y down, z forward), or nothing
/// @throws InvalidArgument  focal lengths or physical size are not positive
[[nodiscard]] std::optional<cv::Point3d> positionFromBox(const cv::Rect& box,
                                                         const ObjectDescription& object,
                                                         const Intrinsics& camera);

}  // namespace kr3::perception
