#include "kr3_perception/drawing.hpp"

#include <cstdio>

#include <opencv2/imgproc.hpp>

namespace kr3::perception
{

void draw(cv::Mat& bgr, const std::vector<Detection>& detections)
{
  for (const Detection& detection : detections)
  {
    const cv::Scalar colour(0, 255.0 * detection.probability,
                            255.0 * (1.0 - detection.probability));
    cv::rectangle(bgr, detection.box, colour, 2);
    char probability[16];
    std::snprintf(probability, sizeof probability, " %.2f", detection.probability);
    const cv::Point corner(detection.box.x, std::max(12, detection.box.y - 4));
    cv::putText(bgr, detection.name + probability, corner, cv::FONT_HERSHEY_SIMPLEX, 0.45,
                cv::Scalar::all(0), 3, cv::LINE_AA);
    cv::putText(bgr, detection.name + probability, corner, cv::FONT_HERSHEY_SIMPLEX, 0.45, colour,
                1, cv::LINE_AA);
  }
}

}  // namespace kr3::perception
