#pragma once

#include <optional>

#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include <kr3_msgs/Detection.h>

#include "kr3_perception/detector.hpp"
#include "kr3_perception/geometry.hpp"

namespace kr3::perception
{

/// @param position  m, camera optical frame
[[nodiscard]] kr3_msgs::Detection toMsg(const Detection& detection,
                                        const std::optional<cv::Point3d>& position);

/// cv_bridge compares sizes in 32 bits, and reads beyond the data of an image that lies about its
/// own.
/// @throws InvalidArgument  an image without pixels, with a side of more than 16384, or with more
/// or fewer bytes than its numbers say
void checkSize(const sensor_msgs::Image& image);

/// A camera's calibration; nothing when the camera is not calibrated (K[0] = 0).
/// @throws InvalidArgument  numbers that are not finite, a side of more than 16384 pixels,
/// or distortion coefficients of no known model
[[nodiscard]] std::optional<Intrinsics> fromMsg(const sensor_msgs::CameraInfo& info);

}  // namespace kr3::perception
