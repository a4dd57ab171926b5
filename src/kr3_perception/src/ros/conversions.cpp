#include "conversions.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include <kr3_common/error.hpp>

namespace kr3::perception
{
namespace
{

constexpr std::uint32_t kMaxSide = 16384;  // pixels

}  // namespace

void checkSize(const sensor_msgs::Image& image)
{
  if (image.width == 0 || image.height == 0 || image.width > kMaxSide || image.height > kMaxSide)
    throw InvalidArgument("it has " + std::to_string(image.width) + " x " +
                          std::to_string(image.height) + " px, expected sides of 1 to " +
                          std::to_string(kMaxSide));
  const std::uint64_t bytes = std::uint64_t{image.step} * image.height;
  if (image.data.size() != bytes)
    throw InvalidArgument("it has " + std::to_string(image.data.size()) + " bytes, expected " +
                          std::to_string(bytes) + " for " + std::to_string(image.height) +
                          " rows of " + std::to_string(image.step));
}

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
  if (!std::all_of(info.K.begin(), info.K.end(), [](double k) { return std::isfinite(k); }))
    throw InvalidArgument("the camera matrix K has a number that is not finite");
  if (info.width > kMaxSide || info.height > kMaxSide)
    throw InvalidArgument("the camera has " + std::to_string(info.width) + " x " +
                          std::to_string(info.height) + " px, expected sides up to " +
                          std::to_string(kMaxSide));
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
