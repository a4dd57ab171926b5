#include "conversions.hpp"

#include <cmath>

#include <kr3_common/error.hpp>

namespace kr3::perception
{

kr3_msgs::Detection toMsg(const Detection& detection, const std::optional<cv::Point3d>& position)
{
  kr3_msgs::Detection message;
  message.name = detection.name;
  message.class_name = detection.class_name;
  message.probability = detection.probability;
  message.region.x_offset = static_cast<std::uint32_t>(detection.box.x);
  message.region.y_offset = static_cast<std::uint32_t>(detection.box.y);
  message.region.width = static_cast<std::uint32_t>(detection.box.width);
  message.region.height = static_cast<std::uint32_t>(detection.box.height);
  message.has_position = position.has_value();
  if (position)
  {
    message.position.x = position->x;
    message.position.y = position->y;
    message.position.z = position->z;
  }
  return message;
}

std::optional<Intrinsics> fromMsg(const sensor_msgs::CameraInfo& info)
{
  if (!(info.K[0] > 0.0 && info.K[4] > 0.0))
    return std::nullopt;
  Intrinsics camera{info.K[0],
                    info.K[4],
                    info.K[2],
                    info.K[5],
                    {static_cast<int>(info.width), static_cast<int>(info.height)},
                    info.distortion_model == "equidistant" || info.distortion_model == "fisheye",
                    info.D};
  for (const double coefficient : info.D)
    if (!std::isfinite(coefficient))
      throw InvalidArgument("the camera's distortion has a coefficient that is not finite");
  (void)normalisedRay({camera.cx, camera.cy}, camera);
  return camera;
}

}  // namespace kr3::perception
