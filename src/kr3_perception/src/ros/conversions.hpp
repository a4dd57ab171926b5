#pragma once

#include <optional>

#include <sensor_msgs/CameraInfo.h>

#include <kr3_msgs/Detection.h>

#include "kr3_perception/detector.hpp"
#include "kr3_perception/geometry.hpp"

namespace kr3::perception
{

/// @param position  m, camera optical frame
[[nodiscard]] kr3_msgs::Detection toMsg(const Detection& detection,
                                        const std::optional<cv::Point3d>& position);

/// A camera's calibration; nothing when the camera is not calibrated (K[0] = 0).
/// @throws InvalidArgument  distortion coefficients that are not finite or of no known model
[[nodiscard]] std::optional<Intrinsics> fromMsg(const sensor_msgs::CameraInfo& info);

}  // namespace kr3::perception
