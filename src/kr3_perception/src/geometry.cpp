#include "kr3_perception/geometry.hpp"

#include <opencv2/calib3d.hpp>

#include "kr3_common/error.hpp"

namespace kr3::perception
{

cv::Point2d normalisedRay(const cv::Point2d& pixel, const Intrinsics& camera)
{
  if (!(camera.fx > 0.0 && camera.fy > 0.0))
    throw InvalidArgument("focal lengths are " + std::to_string(camera.fx) + " and " +
                          std::to_string(camera.fy) + " px, expected > 0");
  const std::size_t n = camera.distortion.size();
  const bool known = camera.fisheye ? n == 4 : n == 4 || n == 5 || n == 8 || n == 12 || n == 14;
  if (n > 0 && !known)
    throw InvalidArgument("found " + std::to_string(n) + " distortion coefficients, expected " +
                          (camera.fisheye ? "4" : "4, 5, 8, 12 or 14"));
  if (n == 0)
    return {(pixel.x - camera.cx) / camera.fx, (pixel.y - camera.cy) / camera.fy};
  const cv::Matx33d K(camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0);
  const std::vector<cv::Point2d> from{pixel};
  std::vector<cv::Point2d> to;
  if (camera.fisheye)
    cv::fisheye::undistortPoints(from, to, K, camera.distortion);
  else
    cv::undistortPoints(
        from, to, K, camera.distortion, cv::noArray(), cv::noArray(),
        cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 50, 1e-9));
  return to.front();
}

std::optional<cv::Point3d> positionFromBox(const cv::Rect& box, const ObjectDescription& object,
                                           const Intrinsics& camera)
{
  const double u = box.x + box.width / 2.0;
  const double v = box.y + box.height / 2.0;
  const cv::Point2d centre = normalisedRay({u, v}, camera);
  const bool cut_across = box.x <= 1 || box.br().x >= camera.image_size.width - 1;
  const bool cut_down = box.y <= 1 || box.br().y >= camera.image_size.height - 1;
  const double size_m = cut_down ? object.width_m : object.height_m;
  if (box.area() <= 0 || (cut_across && cut_down) || !(size_m > 0.0))
    return std::nullopt;
  const double apparent = cut_down ? normalisedRay({static_cast<double>(box.br().x), v}, camera).x -
                                         normalisedRay({static_cast<double>(box.x), v}, camera).x
                                   : normalisedRay({u, static_cast<double>(box.br().y)}, camera).y -
                                         normalisedRay({u, static_cast<double>(box.y)}, camera).y;
  if (!(apparent > 0.0))
    return std::nullopt;
  const double range = size_m / apparent;
  return cv::Point3d(centre.x * range, centre.y * range, range);
}

}  // namespace kr3::perception
