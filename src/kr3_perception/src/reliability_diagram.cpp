#include "kr3_perception/reliability_diagram.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <opencv2/imgproc.hpp>

namespace kr3::perception
{
namespace
{

constexpr int kSide = 400;   // px, of the diagram
constexpr int kCounts = 90;  // px, height of the bars below
constexpr int kMargin = 60;
constexpr int kGap = 50;  // between both
const cv::Scalar kInk(40, 40, 40);
const cv::Scalar kPale(210, 210, 210);
const cv::Scalar kBlue(170, 90, 20);

void write(cv::Mat& picture, const std::string& text, const cv::Point& at, double size = 0.45)
{
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, size, kInk, 1, cv::LINE_AA);
}

cv::Point pointOf(double probability, double share)
{
  return {kMargin + cvRound(kSide * probability), kMargin + cvRound(kSide * (1.0 - share))};
}

}  // namespace

ShareInterval wilsonInterval(int right, int trials)
{
  if (trials <= 0)
    return {};
  constexpr double kZ = 1.959964;  // of 95 %
  const double n = trials;
  const double share = right / n;
  const double middle = (share + kZ * kZ / (2 * n)) / (1 + kZ * kZ / n);
  const double half =
      kZ / (1 + kZ * kZ / n) * std::sqrt(share * (1 - share) / n + kZ * kZ / (4 * n * n));
  return {std::max(0.0, middle - half), std::min(1.0, middle + half)};
}

cv::Mat reliabilityDiagram(const Evaluation& evaluation, const std::string& title)
{
  cv::Mat picture(kMargin + kSide + kGap + kCounts + kMargin, kSide + 2 * kMargin, CV_8UC3,
                  cv::Scalar::all(255));
  for (int k = 0; k <= 10; ++k)
  {
    const double value = k / 10.0;
    cv::line(picture, pointOf(value, 0), pointOf(value, 1), kPale);
    cv::line(picture, pointOf(0, value), pointOf(1, value), kPale);
    if (k % 2 != 0)
      continue;
    char text[8];
    std::snprintf(text, sizeof text, "%.1f", value);
    write(picture, text, pointOf(value, 0) + cv::Point(-10, 18));
    write(picture, text, pointOf(0, value) + cv::Point(-32, 5));
  }
  cv::line(picture, pointOf(0, 0), pointOf(1, 1), kInk, 1, cv::LINE_AA);
  write(picture, title, {kMargin, 24}, 0.5);
  char brier[64];
  std::snprintf(brier, sizeof brier, "share right over probability said; Brier %.4f",
                evaluation.brier());
  write(picture, brier, {kMargin, 46});
  int most = 1;
  for (const ReliabilityBin& bin : evaluation.reliability())
    most = std::max(most, bin.detections);
  const int base = kMargin + kSide + kGap + kCounts;
  for (std::size_t k = 0; k < evaluation.reliability().size(); ++k)
  {
    const ReliabilityBin& bin = evaluation.reliability()[k];
    const double bins = static_cast<double>(evaluation.reliability().size());
    const int left = kMargin + cvRound(kSide * static_cast<double>(k) / bins);
    const int height = cvRound(static_cast<double>(kCounts) * bin.detections / most);
    cv::rectangle(picture, cv::Rect(left + 4, base - height, kSide / 10 - 8, height), kBlue,
                  cv::FILLED);
    write(picture, std::to_string(bin.detections), {left + 6, base + 16}, 0.4);
    if (bin.detections == 0)
      continue;
    const double said = bin.probability_sum / bin.detections;
    const ShareInterval interval = wilsonInterval(bin.right, bin.detections);
    cv::line(picture, pointOf(said, interval.low), pointOf(said, interval.high), kBlue, 2);
    cv::circle(picture, pointOf(said, static_cast<double>(bin.right) / bin.detections), 5, kBlue,
               cv::FILLED, cv::LINE_AA);
  }
  write(picture, "detections", {kMargin, base + 36});
  return picture;
}

}  // namespace kr3::perception
