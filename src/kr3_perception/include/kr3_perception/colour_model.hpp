#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

namespace kr3::perception
{

/// Normalised hue-saturation-value histogram: CV_32FC1, 1 x kHistogramBins, sums to 1.
inline constexpr int kHistogramBins = 12 * 6 * 4;

/// @param hsv   CV_8UC3, OpenCV's HSV
/// @param mask  empty, or CV_8UC1 of the same size
/// @return the histogram of the masked pixels; all 0 when there is none
[[nodiscard]] cv::Mat colourHistogram(const cv::Mat& hsv, const cv::Mat& mask = cv::Mat());

/// Bhattacharyya distance sqrt(1 - sum sqrt(a b)) of two histograms of the same shape, in [0, 1].
[[nodiscard]] double bhattacharyya(const cv::Mat& a, const cv::Mat& b);

/// Tells pixels in colours of the objects from the rest: densities over CIE L*a*b* space in 32 x 32
/// x 32 bins. What the building looks like is known half from training and half from the image
/// itself, most of which is building: so rooms in colours that were never seen work, too.
class ForegroundModel
{
public:
  static constexpr int kBinsPerAxis = 32;
  static constexpr int kBins = kBinsPerAxis * kBinsPerAxis * kBinsPerAxis;

  /// @param densities  CV_32FC1, 2 x kBins, L slowest, b fastest, not negative: P(colour | the
  ///                   object that has most of it), and P(colour | building)
  /// @throws InvalidArgument  wrong type or shape
  explicit ForegroundModel(cv::Mat densities);

  [[nodiscard]] const cv::Mat& densities() const { return densities_; }

  /// @param lab  CV_8UC3, OpenCV's Lab
  /// @return CV_8UC1: 255 where an object is likelier than the building by colour, else 0
  [[nodiscard]] cv::Mat segment(const cv::Mat& lab) const;

private:
  cv::Mat densities_;
};

/// Probability of each object given a colour of the foreground: tells touching objects apart.
class ObjectColourModel
{
public:
  /// @param probabilities  CV_8UC1, shape [objects, ForegroundModel::kBins]: 255 P(object |
  /// colour), bins as there
  /// @throws InvalidArgument  wrong type or shape
  explicit ObjectColourModel(cv::Mat probabilities);

  [[nodiscard]] const cv::Mat& probabilities() const { return probabilities_; }
  [[nodiscard]] int numObjects() const { return probabilities_.rows; }

  /// @param lab   CV_8UC3, OpenCV's Lab
  /// @param mask  CV_8UC1 of the same size: what to look at
  /// @return per object a CV_8UC1 image: 255 where the object is likely by colour, else 0
  [[nodiscard]] std::vector<cv::Mat> segment(const cv::Mat& lab, const cv::Mat& mask) const;

private:
  cv::Mat probabilities_;
};

/// Counts pixels of objects and of the building, and makes the colour models of them.
class ColourCounter
{
public:
  /// @param num_objects  > 0
  explicit ColourCounter(int num_objects);

  /// @param lab  CV_8UC3, OpenCV's Lab
  /// @param who  CV_32SC1 of the same size: index of the object at each pixel, -1 = building
  /// @throws InvalidArgument  an index that is no object's
  void add(const cv::Mat& lab, const cv::Mat& who);

  /// @throws FailedPrecondition  no pixel of the building has been counted
  [[nodiscard]] ForegroundModel foreground() const;
  [[nodiscard]] ObjectColourModel objects() const;

private:
  using Counts = std::vector<std::uint32_t>;  // shape [ForegroundModel::kBins]

  std::vector<Counts> objects_;
  Counts building_;
};

}  // namespace kr3::perception
