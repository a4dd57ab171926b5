#include "kr3_perception/thumbnail.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace kr3::perception
{
namespace
{

constexpr int kCovered = 128;        // of 255: then a cell shows the object
constexpr double kCap = 60.0;        // grey levels: a hidden cell costs no more
constexpr double kBrightness = 0.6;  // weight of L* beside a* and b*: light varies more than hue

}  // namespace

cv::Mat thumbnailOf(const cv::Mat& lab, const cv::Mat& mask)
{
  const cv::Size size(kThumbnailSide, kThumbnailSide);
  cv::Mat colours;
  cv::resize(lab, colours, size, 0.0, 0.0, cv::INTER_AREA);
  cv::Mat coverage(size, CV_8U, cv::Scalar(255));
  if (!mask.empty())
    cv::resize(mask, coverage, size, 0.0, 0.0, cv::INTER_AREA);
  cv::Mat result(size, CV_8UC4);
  const std::vector<cv::Mat> from{colours, coverage};
  cv::mixChannels(from, {result}, {0, 0, 1, 1, 2, 2, 3, 3});
  return result;
}

double thumbnailDistance(const cv::Mat& picture, const cv::Mat& view)
{
  CV_Assert(picture.type() == CV_8UC4 && view.type() == CV_8UC4 && picture.size() == view.size() &&
            picture.isContinuous() && view.isContinuous());
  const cv::Vec4b* a = picture.ptr<cv::Vec4b>();
  const cv::Vec4b* b = view.ptr<cv::Vec4b>();
  const std::size_t cells = picture.total();
  int covered = 0;
  int brighter = 0;
  for (std::size_t i = 0; i < cells; ++i)
    if (b[i][3] >= kCovered)
    {
      ++covered;
      brighter += a[i][0] - b[i][0];
    }
  if (covered == 0)
    return 1.0;
  const double shift = static_cast<double>(brighter) / covered;
  double sum = 0.0;
  for (std::size_t i = 0; i < cells; ++i)
    if (b[i][3] >= kCovered)
      sum += std::min(kCap, kBrightness * std::abs(a[i][0] - b[i][0] - shift) +
                                std::abs(a[i][1] - b[i][1]) + std::abs(a[i][2] - b[i][2]));
  return sum / (kCap * covered);
}

}  // namespace kr3::perception
