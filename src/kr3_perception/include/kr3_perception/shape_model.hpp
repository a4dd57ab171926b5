#pragma once

#include <array>

#include <opencv2/core.hpp>

namespace kr3::perception
{

/// What a silhouette looks like: log aspect ratio (width / height), share of its box that it fills,
/// share of its convex hull, and log of the first Hu moment.
using Shape = std::array<double, 4>;

/// @param mask  CV_8UC1: the largest connected part that is not 0 is described
/// @throws InvalidArgument  the mask is empty
[[nodiscard]] Shape shapeOf(const cv::Mat& mask);

/// Distribution of an object's silhouette: independent normal distributions.
struct ShapeModel
{
  Shape mean{};
  Shape deviation{};  ///< standard deviations, > 0

  /// Root mean square of the standardised differences, each capped at 4: 0 = the mean shape.
  [[nodiscard]] double distance(const Shape& shape) const;
};

}  // namespace kr3::perception
