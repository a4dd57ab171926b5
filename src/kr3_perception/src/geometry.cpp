#include "kr3_perception/geometry.hpp"

#include "kr3_common/error.hpp"

namespace kr3::perception
{

std::optional<cv::Point3d> positionFromBox(const cv::Rect& box, const ObjectDescription& object,
                                           const Intrinsics& camera)
{
  if (!(camera.fx > 0.0 && camera.fy > 0.0))
    throw InvalidArgument("focal lengths are " + std::to_string(camera.fx) + " and " +
                          std::to_string(camera.fy) + " px, expected > 0");
  if (!(object.width_m > 0.0 && object.height_m > 0.0))
    throw InvalidArgument("object '" + object.name + "' has no positive size");
  const bool cut_across = box.x <= 1 || box.br().x >= camera.image_size.width - 1;
  const bool cut_down = box.y <= 1 || box.br().y >= camera.image_size.height - 1;
  if (box.area() <= 0 || (cut_across && cut_down))
    return std::nullopt;
  const double range =
      cut_down ? camera.fx * object.width_m / box.width : camera.fy * object.height_m / box.height;
  const double u = box.x + box.width / 2.0;
  const double v = box.y + box.height / 2.0;
  return cv::Point3d((u - camera.cx) / camera.fx * range, (v - camera.cy) / camera.fy * range,
                     range);
}

}  // namespace kr3::perception
