#include "kr3_perception/shape_model.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "kr3_common/error.hpp"

namespace kr3::perception
{

Shape shapeOf(const cv::Mat& mask)
{
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(mask, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  if (contours.empty())
    throw InvalidArgument("the silhouette is empty");
  const auto largest = std::max_element(
      contours.begin(), contours.end(),
      [](const auto& a, const auto& b) { return cv::contourArea(a) < cv::contourArea(b); });
  const cv::Rect box = cv::boundingRect(*largest);
  const double area = cv::contourArea(*largest) + 1.0;
  std::vector<cv::Point> hull;
  cv::convexHull(*largest, hull);
  std::array<double, 7> hu{};
  cv::HuMoments(cv::moments(*largest), hu.data());
  return {std::log(static_cast<double>(box.width) / box.height), area / box.area(),
          area / (cv::contourArea(hull) + 1.0), std::log(hu[0] + 1e-9)};
}

double ShapeModel::distance(const Shape& shape) const
{
  constexpr double kCap = 4.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < shape.size(); ++i)
    sum += std::pow(std::min(kCap, std::abs(shape[i] - mean[i]) / deviation[i]), 2);
  return std::sqrt(sum / static_cast<double>(shape.size()));
}

}  // namespace kr3::perception
