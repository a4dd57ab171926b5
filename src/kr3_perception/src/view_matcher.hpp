#pragma once

#include <map>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/flann.hpp>

#include "kr3_perception/detector_model.hpp"
#include "kr3_perception/features.hpp"

namespace kr3::perception
{

/// A feature of the image that looks like one object's and unlike everything else's.
struct FeatureVote
{
  cv::Point2f point;  ///< px
  int object = 0;
};

/// A learned view laid over the image by a rotation, scaling and shift that several features agree
/// on.
struct ViewMatch
{
  int object = 0;
  int view = 0;
  cv::Rect box;               ///< px
  int inliers = 0;            ///< features that agree
  double inlier_ratio = 0.0;  ///< of the features that matched this view
};

struct MatchResult
{
  std::vector<FeatureVote> votes;
  std::vector<ViewMatch> best;  ///< per object at most max_in_image, apart from each other
  /// Other views that agree nearly as well with those features, where they give another box: of an
  /// object that is seen over a corner, the front's features also fit a view from the front.
  std::vector<ViewMatch> others;
};

/// Finds learned views in the features of an image (Lowe 2004: ratio test, here with the building
/// as one more class; then the best similarity transform over all pairs of matches). Not
/// thread-safe.
class ViewMatcher
{
public:
  /// @param model   outlives the matcher
  /// @param checks  leaves visited in the trees per feature
  ViewMatcher(const DetectorModel& model, int checks);

  [[nodiscard]] MatchResult match(const Features& features) const;

private:
  /// A feature of the image beside one of a view.
  struct Pair
  {
    int feature = 0;
    int keypoint = 0;  ///< in the view
  };

  /// @param pairs_of_view  of one object
  /// @return the views that features agree on, most features first
  [[nodiscard]] std::vector<ViewMatch> fittingViews(
      const std::map<int, std::vector<Pair>>& pairs_of_view, const Features& features) const;
  [[nodiscard]] ViewMatch fit(int view, const std::vector<Pair>& pairs,
                              const Features& features) const;

  const DetectorModel& model_;
  cv::flann::SearchParams search_;
  cv::Mat descriptors_;             ///< CV_32F, all views', then the building's
  std::vector<int> view_of_;        ///< shape [descriptors]; -1 = building
  std::vector<int> first_row_;      ///< shape [views]
  mutable cv::flann::Index index_;  ///< its search is not const
};

}  // namespace kr3::perception
