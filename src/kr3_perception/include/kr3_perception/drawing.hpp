#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "kr3_perception/detector.hpp"

namespace kr3::perception
{

/// Draws boxes with name and probability into `bgr` (CV_8UC3).
void draw(cv::Mat& bgr, const std::vector<Detection>& detections);

}  // namespace kr3::perception
