#include "kr3_perception/colour_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include <opencv2/imgproc.hpp>

#include "kr3_common/error.hpp"

namespace kr3::perception
{
namespace
{

constexpr int kShift = 3;              // 256 values to 32 bins
constexpr double kObjectShare = 0.25;  // of an image that one object may fill

std::size_t binOf(const cv::Vec3b& lab)
{
  return (static_cast<std::size_t>(lab[0] >> kShift) * ForegroundModel::kBinsPerAxis +
          static_cast<std::size_t>(lab[1] >> kShift)) *
             ForegroundModel::kBinsPerAxis +
         static_cast<std::size_t>(lab[2] >> kShift);
}

// Spreads counts over neighbouring bins by (1, 2, 1) / 4 along each axis: lighting shifts colours.
std::vector<double> smoothed(const std::vector<std::uint32_t>& counts)
{
  constexpr std::size_t n = ForegroundModel::kBinsPerAxis;
  std::vector<double> from(counts.begin(), counts.end());
  for (const std::size_t stride : {std::size_t{1}, n, n * n})
  {
    std::vector<double> to(from.size());
    for (std::size_t i = 0; i < from.size(); ++i)
    {
      const std::size_t k = (i / stride) % n;
      const double before = k > 0 ? from[i - stride] : 0.0;
      const double after = k + 1 < n ? from[i + stride] : 0.0;
      to[i] = 0.25 * before + 0.5 * from[i] + 0.25 * after;
    }
    from = std::move(to);
  }
  return from;
}

}  // namespace

cv::Mat colourHistogram(const cv::Mat& hsv, const cv::Mat& mask)
{
  const std::array<int, 3> channels{0, 1, 2};
  const std::array<int, 3> sizes{12, 6, 4};
  const std::array<float, 2> hue{0.0F, 180.0F};
  const std::array<float, 2> byte{0.0F, 256.0F};
  std::array<const float*, 3> ranges{hue.data(), byte.data(), byte.data()};
  cv::Mat histogram;
  cv::calcHist(&hsv, 1, channels.data(), mask, histogram, 3, sizes.data(), ranges.data());
  cv::Mat flat(1, kHistogramBins, CV_32F, histogram.ptr<float>());
  const double sum = cv::sum(flat)[0];
  return sum > 0.0 ? cv::Mat(flat / sum) : cv::Mat::zeros(1, kHistogramBins, CV_32F);
}

double bhattacharyya(const cv::Mat& a, const cv::Mat& b)
{
  CV_Assert(a.type() == CV_32F && b.type() == CV_32F && a.size() == b.size());
  double coefficient = 0.0;
  const float* pa = a.ptr<float>();
  const float* pb = b.ptr<float>();
  for (int i = 0; i < a.cols; ++i)
    coefficient += std::sqrt(static_cast<double>(pa[i]) * static_cast<double>(pb[i]));
  return std::sqrt(std::max(0.0, 1.0 - coefficient));
}

ForegroundModel::ForegroundModel(cv::Mat densities) : densities_(std::move(densities))
{
  if (densities_.type() != CV_32FC1 || densities_.rows != 2 || densities_.cols != kBins)
    throw InvalidArgument("colour table has " + std::to_string(densities_.rows) + " x " +
                          std::to_string(densities_.cols) + " entries, expected 2 x " +
                          std::to_string(kBins) + " floating-point numbers");
}

cv::Mat ForegroundModel::segment(const cv::Mat& lab) const
{
  std::vector<std::uint32_t> counts(kBins, 0);
  for (int y = 0; y < lab.rows; ++y)
  {
    const cv::Vec3b* row = lab.ptr<cv::Vec3b>(y);
    for (int x = 0; x < lab.cols; ++x)
      ++counts[binOf(row[x])];
  }
  std::vector<std::uint8_t> decision(kBins, 0);
  const float* object = densities_.ptr<float>(0);
  const float* building = densities_.ptr<float>(1);
  const double pixels = static_cast<double>(lab.total());
  for (std::size_t i = 0; i < counts.size(); ++i)
  {
    const double rest = 0.5 * static_cast<double>(building[i]) + 0.5 * counts[i] / pixels;
    decision[i] = counts[i] > 0 && kObjectShare * static_cast<double>(object[i]) > rest ? 255 : 0;
  }
  cv::Mat result(lab.size(), CV_8U);
  for (int y = 0; y < lab.rows; ++y)
  {
    const cv::Vec3b* from = lab.ptr<cv::Vec3b>(y);
    std::uint8_t* to = result.ptr<std::uint8_t>(y);
    for (int x = 0; x < lab.cols; ++x)
      to[x] = decision[binOf(from[x])];
  }
  return result;
}

ObjectColourModel::ObjectColourModel(cv::Mat probabilities)
  : probabilities_(std::move(probabilities))
{
  if (probabilities_.type() != CV_8UC1 || probabilities_.cols != ForegroundModel::kBins)
    throw InvalidArgument("objects' colour table has rows of " +
                          std::to_string(probabilities_.cols) + " entries, expected " +
                          std::to_string(ForegroundModel::kBins) + " bytes");
}

std::vector<cv::Mat> ObjectColourModel::segment(const cv::Mat& lab, const cv::Mat& mask) const
{
  constexpr std::uint8_t kLikely = 90;  // of 255; several objects may share a colour
  std::vector<cv::Mat> result;
  for (int object = 0; object < probabilities_.rows; ++object)
    result.push_back(cv::Mat::zeros(lab.size(), CV_8U));
  for (int y = 0; y < lab.rows; ++y)
  {
    const cv::Vec3b* colours = lab.ptr<cv::Vec3b>(y);
    const std::uint8_t* inside = mask.ptr<std::uint8_t>(y);
    for (int x = 0; x < lab.cols; ++x)
    {
      if (inside[x] == 0)
        continue;
      const int bin = static_cast<int>(binOf(colours[x]));
      for (int object = 0; object < probabilities_.rows; ++object)
        if (probabilities_.at<std::uint8_t>(object, bin) > kLikely)
          result[static_cast<std::size_t>(object)].at<std::uint8_t>(y, x) = 255;
    }
  }
  return result;
}

ColourCounter::ColourCounter(int num_objects)
  : objects_(static_cast<std::size_t>(num_objects), Counts(ForegroundModel::kBins, 0))
  , building_(ForegroundModel::kBins, 0)
{
}

void ColourCounter::add(const cv::Mat& lab, const cv::Mat& who)
{
  for (int y = 0; y < lab.rows; ++y)
  {
    const cv::Vec3b* colours = lab.ptr<cv::Vec3b>(y);
    const int* owner = who.ptr<int>(y);
    for (int x = 0; x < lab.cols; ++x)
    {
      if (owner[x] >= static_cast<int>(objects_.size()))
        throw InvalidArgument("object " + std::to_string(owner[x]) + " of " +
                              std::to_string(objects_.size()));
      Counts& counts = owner[x] < 0 ? building_ : objects_[static_cast<std::size_t>(owner[x])];
      ++counts[binOf(colours[x])];
    }
  }
}

ForegroundModel ColourCounter::foreground() const
{
  const std::vector<double> building = smoothed(building_);
  const double num_building = std::accumulate(building.begin(), building.end(), 0.0);
  if (num_building <= 0.0)
    throw FailedPrecondition(
        "no pixel of the building was seen, so that objects cannot be told from it");
  cv::Mat densities = cv::Mat::zeros(2, ForegroundModel::kBins, CV_32F);
  float* object = densities.ptr<float>(0);
  for (const Counts& counts : objects_)
  {
    const std::vector<double> mine = smoothed(counts);
    const double total = std::max(1.0, std::accumulate(mine.begin(), mine.end(), 0.0));
    for (std::size_t i = 0; i < mine.size(); ++i)
      object[i] = std::max(object[i], static_cast<float>(mine[i] / total));
  }
  for (std::size_t i = 0; i < building.size(); ++i)
    densities.ptr<float>(1)[i] = static_cast<float>(building[i] / num_building);
  return ForegroundModel(densities);
}

ObjectColourModel ColourCounter::objects() const
{
  cv::Mat shares(static_cast<int>(objects_.size()), ForegroundModel::kBins, CV_64F);
  for (std::size_t k = 0; k < objects_.size(); ++k)
  {
    const std::vector<double> counts = smoothed(objects_[k]);
    const double total = std::max(1.0, std::accumulate(counts.begin(), counts.end(), 0.0));
    for (std::size_t i = 0; i < counts.size(); ++i)
      shares.at<double>(static_cast<int>(k), static_cast<int>(i)) = counts[i] / total;
  }
  cv::Mat table = cv::Mat::zeros(shares.size(), CV_8U);
  for (int i = 0; i < shares.cols; ++i)
  {
    const double sum = cv::sum(shares.col(i))[0];
    for (int k = 0; k < shares.rows && sum > 0.0; ++k)
      table.at<std::uint8_t>(k, i) =
          cv::saturate_cast<std::uint8_t>(255.0 * shares.at<double>(k, i) / sum);
  }
  return ObjectColourModel(table);
}

}  // namespace kr3::perception
