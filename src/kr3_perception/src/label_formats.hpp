#pragma once

#include <string>
#include <vector>

#include "kr3_perception/labelled_folder.hpp"

namespace kr3::perception
{

/// One image of a labelled folder as its label file describes it.
struct LabelledEntry
{
  std::string where;  ///< "FILE: image N", for messages
  std::string image;  ///< path
  std::string mask;   ///< path, or empty
  std::vector<Label> labels;
  std::vector<cv::Rect2d> shares;  ///< boxes as shares of the image, in place of the labels' boxes
};

/// Reads the labels of a folder in whichever format it has: ours (`labels.json`), COCO (another
/// `*.json` with `images`, `annotations` and `categories`) or YOLO (`classes.txt` and one text file
/// an image, beside the images or in `labels/` with the images in `images/`).
///
/// @throws Unavailable      no such folder, or no label file in it
/// @throws InvalidArgument  "FILE: entry: what was found, what was expected"
[[nodiscard]] std::vector<LabelledEntry> readLabels(const std::string& folder);

}  // namespace kr3::perception
