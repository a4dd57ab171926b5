#pragma once

#include <opencv2/core.hpp>

namespace kr3::perception
{

inline constexpr int kThumbnailSide = 10;

/// What a part of an image looks like from afar: 10 x 10 means of L*, a*, b* and of coverage.
///
/// @param lab   CV_8UC3, OpenCV's Lab, not empty
/// @param mask  empty: all of it; or CV_8UC1 of the same size: 0 = not the object
/// @return CV_8UC4, kThumbnailSide x kThumbnailSide: Lab, then 255 times the share of the cell that
///         the object covers
[[nodiscard]] cv::Mat thumbnailOf(const cv::Mat& lab, const cv::Mat& mask = cv::Mat());

/// How unlike a picture is to a view, over the cells that the view covers: mean of the colour
/// differences, each capped, after the brightness of both was made equal.
///
/// @param picture, view  see thumbnailOf(); of `picture` the coverage is not used
/// @return [0, 1]; 1 when the view covers nothing
[[nodiscard]] double thumbnailDistance(const cv::Mat& picture, const cv::Mat& view);

}  // namespace kr3::perception
