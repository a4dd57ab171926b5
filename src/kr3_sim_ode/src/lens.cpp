#include "lens.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <kr3_common/error.hpp>

namespace kr3::sim
{

namespace
{
constexpr int kIterations = 50;
constexpr double kMaxError = 1e-4;  // pixels, of the inverse
constexpr double kMaxGrowth = 2.0;

/// The plumb-bob model: where the lens puts an ideal point, both in units of the focal length.
/// Source: Brown, "Close-range camera calibration" (1971), with OpenCV's order of coefficients.
cv::Point2d distorted(const std::array<double, 5>& d, const cv::Point2d& p)
{
  const auto& [k1, k2, p1, p2, k3] = d;
  const double r2 = p.x * p.x + p.y * p.y;
  const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  return {p.x * radial + 2.0 * p1 * p.x * p.y + p2 * (r2 + 2.0 * p.x * p.x),
          p.y * radial + p1 * (r2 + 2.0 * p.y * p.y) + 2.0 * p2 * p.x * p.y};
}

/// The ideal point that the lens puts at `target`, by fixed-point iteration.
cv::Point2d undistorted(const std::array<double, 5>& d, const cv::Point2d& target)
{
  cv::Point2d p = target;
  for (int i = 0; i < kIterations; ++i)
  {
    const cv::Point2d error = target - distorted(d, p);
    p += error;
    if (std::abs(error.x) + std::abs(error.y) < 1e-12)
    {
      break;
    }
  }
  return p;
}
}  // namespace

Lens::Lens(const CameraModel& camera) : source_width_(camera.width), source_height_(camera.height)
{
  const auto& d = camera.distortion;
  if (std::all_of(d.begin(), d.end(), [](double k) { return k == 0.0; }))
  {
    return;
  }
  const double f = camera.focalLengthPixels();
  const cv::Point2d center((camera.width - 1) / 2.0, (camera.height - 1) / 2.0);
  cv::Mat ideal(camera.height, camera.width, CV_64FC2);  // pixels off the principal point
  double half_width = center.x;
  double half_height = center.y;
  for (int v = 0; v < camera.height; ++v)
  {
    for (int u = 0; u < camera.width; ++u)
    {
      const cv::Point2d target((u - center.x) / f, (v - center.y) / f);
      const cv::Point2d p = undistorted(d, target);
      const cv::Point2d error = (distorted(d, p) - target) * f;
      if (!(std::abs(error.x) + std::abs(error.y) < kMaxError))
      {
        throw InvalidArgument("the lens distortion cannot be inverted at pixel (" +
                              std::to_string(u) + ", " + std::to_string(v) + ")");
      }
      ideal.at<cv::Vec2d>(v, u) = {f * p.x, f * p.y};
      half_width = std::max(half_width, std::abs(f * p.x));
      half_height = std::max(half_height, std::abs(f * p.y));
    }
  }
  if (half_width > kMaxGrowth * center.x || half_height > kMaxGrowth * center.y)
  {
    throw InvalidArgument("the lens distortion needs more than twice the picture");
  }
  source_width_ = 2 * static_cast<int>(std::ceil(half_width + 1.0));
  source_height_ = 2 * static_cast<int>(std::ceil(half_height + 1.0));
  const cv::Scalar source_center((source_width_ - 1) / 2.0, (source_height_ - 1) / 2.0);
  cv::Mat positions;
  cv::Mat(ideal + source_center).convertTo(positions, CV_32FC2);
  cv::convertMaps(positions, cv::noArray(), map_, map_fraction_, CV_16SC2);
  cv::convertMaps(positions, cv::noArray(), nearest_map_, cv::noArray(), CV_16SC2, true);
}

cv::Mat Lens::bent(const cv::Mat& image, int interpolation) const
{
  if (map_.empty())
  {
    return image;
  }
  cv::Mat result;
  if (interpolation == cv::INTER_NEAREST)
  {
    cv::remap(image, result, nearest_map_, cv::noArray(), interpolation, cv::BORDER_REPLICATE);
    return result;
  }
  cv::remap(image, result, map_, map_fraction_, interpolation, cv::BORDER_REPLICATE);
  return result;
}

}  // namespace kr3::sim
