#pragma once

#include <memory>
#include <string>
#include <utility>
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

/// Larger images are made this large when they are read, their labels with them, px.
inline constexpr int kMaxImageSide = 1280;

/// A folder of labelled images in our own format, COCO's or YOLO's (see the README).
class LabelledFolder
{
public:
  /// Reads the labels, not yet the images.
  /// @throws Unavailable      no such folder, or no labels in it
  /// @throws InvalidArgument  labels that are malformed; the message names file and entry
  explicit LabelledFolder(const std::string& path);

  [[nodiscard]] std::size_t size() const { return entries_.size(); }

  /// The labels as read; boxes of YOLO's format are known only by image().
  /// @throws InvalidArgument  index out of range
  [[nodiscard]] const std::vector<Label>& labels(std::size_t index) const;

  /// Reads one image.
  /// @throws InvalidArgument  index out of range, a box outside the image, more than 100 megapixels
  /// @throws Unavailable      the image or its mask cannot be read
  [[nodiscard]] LabelledImage image(std::size_t index) const;

  /// The images without every `every`-th one, and those.
  /// @throws InvalidArgument  every < 2, or fewer images than that
  [[nodiscard]] std::pair<LabelledFolder, LabelledFolder> split(std::size_t every) const;

private:
  struct Entry;

  explicit LabelledFolder(std::vector<std::shared_ptr<const Entry>> entries);
  [[nodiscard]] const Entry& entry(std::size_t index) const;

  std::vector<std::shared_ptr<const Entry>> entries_;  ///< shared by the parts of a split
};

/// The pixels of one label: from the mask where there is one, else the ellipse that its box
/// contains.
/// @return CV_8UC1 of the image's size, 255 on the object
[[nodiscard]] cv::Mat maskOf(const LabelledImage& image, const Label& label);

}  // namespace kr3::perception
