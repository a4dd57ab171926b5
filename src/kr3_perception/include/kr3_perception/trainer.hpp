#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "kr3_perception/detector.hpp"
#include "kr3_perception/detector_model.hpp"
#include "kr3_perception/labelled_folder.hpp"

namespace kr3::perception
{

struct TrainerOptions
{
  int views_per_object = 14;       ///< > 0
  int keypoints_per_view = 60;     ///< > 0
  int background_features = 1500;  ///< features of the building that are kept, >= 0
  int min_pixels = 250;            ///< smaller views teach nothing
  double match_overlap = 0.4;      ///< intersection over union that makes a proposal right, (0, 1)
  DetectorOptions detector;        ///< with which it will be used
};

/// Called now and then with a line of progress for people.
using Progress = std::function<void(const std::string&)>;

/// Learns object models from labelled images. Deterministic: the same images in the same order give
/// the same model.
class Trainer
{
public:
  /// @param objects  what is to be learned; labels of other names are treated as part of the
  /// building
  /// @throws InvalidArgument  no objects, a name twice, or options out of range
  Trainer(std::vector<ObjectDescription> objects, const TrainerOptions& options);

  /// Learns looks from `looks`, and how far to trust them from `calibration`, which should be other
  /// images.
  /// @throws InvalidArgument  an object that no image in `looks` shows well enough, or no usable
  /// calibration image
  [[nodiscard]] DetectorModel train(const std::vector<LabelledFolder>& looks,
                                    const std::vector<LabelledFolder>& calibration,
                                    const Progress& progress) const;

private:
  [[nodiscard]] DetectorModel learnLooks(const std::vector<LabelledFolder>& folders,
                                         const Progress& progress) const;
  [[nodiscard]] BoostedTrees learnClassifier(const DetectorModel& model,
                                             const std::vector<LabelledFolder>& folders,
                                             const Progress& progress) const;

  std::vector<ObjectDescription> objects_;
  TrainerOptions options_;
};

}  // namespace kr3::perception
