#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace kr3::perception
{

/// Where an object is in a labelled image.
struct Label
{
  std::string name;
  int instance = 0;  ///< value of its pixels in the mask, 1..255; 0 when there is no mask
  cv::Rect box;      ///< px
  int pixels = 0;    ///< that are visible; the box's area when nothing better is known
};

struct LabelledImage
{
  std::string name;  ///< file name, for messages
  cv::Mat bgr;       ///< CV_8UC3
  cv::Mat mask;      ///< CV_8UC1, 0 = no object; empty when the folder has boxes only
  std::vector<Label> labels;
};

/// A folder of labelled images: `labels.json` (see the README) beside the images and, optionally,
/// their masks.
class LabelledFolder
{
public:
  /// Reads the labels, not yet the images.
  /// @throws Unavailable      no such folder or file
  /// @throws InvalidArgument  labels that are malformed
  explicit LabelledFolder(std::string path);

  [[nodiscard]] std::size_t size() const { return entries_.size(); }

  /// Reads one image.
  /// @throws InvalidArgument  index out of range, or a box outside the image
  /// @throws Unavailable      the image cannot be read
  [[nodiscard]] LabelledImage image(std::size_t index) const;

private:
  struct Entry
  {
    std::string image;
    std::string mask;
    std::vector<Label> labels;
  };

  std::string path_;
  std::vector<Entry> entries_;
};

/// The pixels of one label: from the mask where there is one, else the ellipse that its box
/// contains.
/// @return CV_8UC1 of the image's size, 255 on the object
[[nodiscard]] cv::Mat maskOf(const LabelledImage& image, const Label& label);

}  // namespace kr3::perception
