#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include <kr3_common/testing/temporary_folder.hpp>

#include "kr3_perception/detector_model.hpp"
#include "kr3_perception/labelled_folder.hpp"

namespace kr3::perception::test
{

/// Objects with painted fronts that tests put before a wall: no files, no renderer.
class SyntheticWorld
{
public:
  /// @param num_objects  each with a front of its own
  explicit SyntheticWorld(int num_objects);

  [[nodiscard]] const std::vector<ObjectDescription>& objects() const { return objects_; }
  [[nodiscard]] const cv::Mat& front(int object) const
  {
    return fronts_[static_cast<std::size_t>(object)];
  }

  /// A picture of 320 x 240 px: every object with probability 1/2, scaled and a little tilted, none
  /// overlapping.
  [[nodiscard]] LabelledImage scene(std::uint64_t seed) const;

  /// Writes scenes as a labelled folder, with masks or with boxes only. Makes the folder.
  void writeFolder(const std::string& path, int num_images, std::uint64_t first_seed,
                   bool masks) const;

private:
  std::vector<ObjectDescription> objects_;
  std::vector<cv::Mat> fronts_;  ///< CV_8UC3
};

using kr3::test_support::TemporaryFolder;

}  // namespace kr3::perception::test
