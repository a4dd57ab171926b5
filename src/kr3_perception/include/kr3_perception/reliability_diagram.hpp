#pragma once

#include <string>

#include <opencv2/core.hpp>

#include "kr3_perception/evaluation.hpp"

namespace kr3::perception
{

/// Share of right detections over the probability that was said for them, with 95 % Wilson
/// intervals and, below, how many detections there were. Well calibrated detections lie on the
/// diagonal.
/// @param title  printed above, ASCII
/// @return CV_8UC3
[[nodiscard]] cv::Mat reliabilityDiagram(const Evaluation& evaluation, const std::string& title);

/// An interval of a share.
struct ShareInterval
{
  double low = 0.0;
  double high = 1.0;
};

/// The 95 % interval of a share after `right` of `trials`. Source: Wilson (1927).
/// @param trials  >= 0; without one, [0, 1]
[[nodiscard]] ShareInterval wilsonInterval(int right, int trials);

}  // namespace kr3::perception
