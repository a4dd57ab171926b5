#pragma once

#include <map>
#include <string>
#include <vector>

#include "kr3_perception/detector.hpp"
#include "kr3_perception/labelled_folder.hpp"

namespace kr3::perception
{

/// Counts of one class.
struct ClassScore
{
  int right = 0;   ///< detections of a visible object at its place
  int wrong = 0;   ///< detections of anything else
  int missed = 0;  ///< visible objects that were not detected

  /// right / (right + wrong); 1 when nothing was detected.
  [[nodiscard]] double precision() const;
  /// right / (right + missed); 1 when there was nothing to see.
  [[nodiscard]] double recall() const;
};

/// Detections whose probability lies in [k/10, (k+1)/10).
struct ReliabilityBin
{
  int detections = 0;
  int right = 0;
  double probability_sum = 0.0;
};

/// Compares detections with labels. A detection is right when its name is labelled with a box that
/// overlaps it enough.
class Evaluation
{
public:
  /// @param threshold      detections below it do not count for precision and recall, (0, 1)
  /// @param min_pixels     objects with fewer visible pixels neither help nor hurt
  /// @param match_overlap  intersection over union, (0, 1)
  Evaluation(double threshold, int min_pixels, double match_overlap);

  /// @param class_of  class of every object name
  void add(const std::vector<Detection>& detections, const std::vector<Label>& labels,
           const std::map<std::string, std::string>& class_of);

  [[nodiscard]] const std::map<std::string, ClassScore>& classes() const { return classes_; }
  /// The same by the names of objects.
  [[nodiscard]] const std::map<std::string, ClassScore>& objects() const { return objects_; }
  [[nodiscard]] ClassScore total() const;
  [[nodiscard]] const std::vector<ReliabilityBin>& reliability() const { return bins_; }
  /// Mean squared difference between probability and truth over all detections; 0 when there are
  /// none.
  [[nodiscard]] double brier() const;

private:
  double threshold_;
  int min_pixels_;
  double match_overlap_;
  std::map<std::string, ClassScore> classes_;
  std::map<std::string, ClassScore> objects_;
  std::vector<ReliabilityBin> bins_;
  double squared_error_ = 0.0;
  int detections_ = 0;
};

/// Intersection over union of two boxes, [0, 1].
[[nodiscard]] double overlap(const cv::Rect& a, const cv::Rect& b);

}  // namespace kr3::perception
