#pragma once

#include <array>
#include <vector>

#include <opencv2/core.hpp>

#include "kr3_perception/detector.hpp"
#include "kr3_perception/detector_model.hpp"
#include "kr3_perception/features.hpp"
#include "view_matcher.hpp"

namespace kr3::perception
{

/// What speaks for and against a proposal, in the order that the classifier expects.
enum class Evidence
{
  kInliers,  // log(1 + features that agree on a view), at most 3.5
  kInlierRatio,
  kVotes,             // log(1 + features of this object in the box)
  kOtherVotes,        // log(1 + features of other objects in the box)
  kColour,            // Bhattacharyya distance to this object's nearest views
  kColourMargin,      // that minus the least distance to another object
  kAppearance,        // thumbnailDistance() to this object's nearest view
  kAppearanceMargin,  // that minus the least distance to another object
  kRivalAppearance,   // that minus the least of another proposal for this object; 0 without one
  kRivalVotes,        // log(1 + most votes for another proposal for this object)
  kShape,             // ShapeModel::distance()
  kRegion,            // 1 when the box is that of one coloured region
  kPart,              // 1 when it is that of the part of a region in this object's colours
  kRegionInliers,     // 1 when it is, and features agree as well
  kArea,              // log of the area in px
  kAspect,            // log of width / height
  kFill,              // share of the box in colours of objects
  kBorder,            // 1 when the image cuts it off
  kCount,
};
inline constexpr std::size_t kEvidenceCount = static_cast<std::size_t>(Evidence::kCount);

/// "This object may be here".
struct Proposal
{
  int object = 0;
  cv::Rect box;                  ///< px, inside the image
  std::vector<double> evidence;  ///< shape [kEvidenceCount]
};

/// Makes proposals from local features and from coloured regions. Not thread-safe.
class ProposalMaker
{
public:
  /// @param model  outlives the maker; its classifier is not used
  ProposalMaker(const DetectorModel& model, const DetectorOptions& options);

  /// @param bgr  CV_8UC3
  [[nodiscard]] std::vector<Proposal> propose(const cv::Mat& bgr) const;

private:
  /// A connected part of the image in colours that objects have.
  struct Region
  {
    cv::Rect box;
    cv::Mat mask;     ///< CV_8UC1 of the box's size
    int object = -1;  ///< whose colours it has; -1 = any
  };
  struct Draft
  {
    int object = 0;
    cv::Rect box;
    int inliers = 0;
    double inlier_ratio = 0.0;
    int region = -1;
  };

  [[nodiscard]] std::vector<Region> partsOf(const std::vector<Region>& regions,
                                            const cv::Mat& lab) const;
  void addViewDrafts(const ViewMatch& match, const cv::Mat& foreground,
                     std::vector<Draft>& drafts) const;
  void addRegionDrafts(const std::vector<Region>& regions, const cv::Mat& bgr,
                       std::vector<Draft>& drafts) const;
  [[nodiscard]] std::vector<int> likelyObjects(const Region& region, const cv::Mat& bgr) const;
  [[nodiscard]] std::vector<double> colourDistances(const cv::Mat& hsv, const cv::Mat& mask) const;
  [[nodiscard]] std::vector<double> weigh(const Draft& draft, const std::vector<Region>& regions,
                                          const std::vector<FeatureVote>& votes, const cv::Mat& bgr,
                                          const cv::Mat& lab, const cv::Mat& foreground) const;
  void compareRivals(std::vector<Proposal>& proposals) const;

  const DetectorModel& model_;
  FeatureExtractor extractor_;
  ViewMatcher matcher_;
};

}  // namespace kr3::perception
