#include "proposals.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <opencv2/imgproc.hpp>

#include "kr3_perception/evaluation.hpp"

namespace kr3::perception
{
namespace
{

constexpr int kMinRegionPixels = 100;
constexpr int kRegionPadding = 12;            // px around a region in which features are sought
constexpr double kWholeImageShare = 0.7;      // of the image in regions: then look everywhere
constexpr std::size_t kColourCandidates = 2;  // objects proposed per region by colour alone
constexpr int kMinPartPixels = 80;
constexpr std::size_t kPartsPerObject = 2;  // and region, the largest
constexpr double kSomeOverlap = 0.2;        // of region and view that may be of one object
constexpr double kSilhouette = 0.5;         // of region and view that are of one object
constexpr double kSameBox = 0.7;            // overlap from which a part is the whole region
constexpr int kMinSide = 4;

/// Padded boxes, merged until none overlap.
std::vector<cv::Rect> disjoint(std::vector<cv::Rect> boxes, const cv::Rect& image)
{
  for (cv::Rect& box : boxes)
    box = cv::Rect(box.x - kRegionPadding, box.y - kRegionPadding, box.width + 2 * kRegionPadding,
                   box.height + 2 * kRegionPadding) &
          image;
  for (std::size_t i = 0; i < boxes.size();)
  {
    bool merged = false;
    for (std::size_t j = i + 1; j < boxes.size() && !merged; ++j)
      if ((boxes[i] & boxes[j]).area() > 0)
      {
        boxes[i] |= boxes[j];
        boxes.erase(boxes.begin() + static_cast<std::ptrdiff_t>(j));
        merged = true;
      }
    if (merged)
      i = 0;
    else
      ++i;
  }
  const int covered = std::accumulate(
      boxes.begin(), boxes.end(), 0, [](int sum, const cv::Rect& box) { return sum + box.area(); });
  if (covered > kWholeImageShare * image.area())
    return {image};
  return boxes;
}

/// The connected parts of a mask, with their holes filled: those are in a colour of the building.
template <typename Region>
std::vector<Region> components(const cv::Mat& mask, int min_pixels)
{
  cv::Mat labels;
  cv::Mat statistics;
  cv::Mat centres;
  const int n = cv::connectedComponentsWithStats(mask, labels, statistics, centres, 8, CV_32S);
  std::vector<Region> regions;
  for (int i = 1; i < n; ++i)
  {
    const int* row = statistics.ptr<int>(i);
    if (row[cv::CC_STAT_AREA] < min_pixels)
      continue;
    Region region;
    region.box = {row[cv::CC_STAT_LEFT], row[cv::CC_STAT_TOP], row[cv::CC_STAT_WIDTH],
                  row[cv::CC_STAT_HEIGHT]};
    region.mask = labels(region.box) == i;
    std::vector<std::vector<cv::Point>> contours;
    cv::findContours(region.mask, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
    cv::drawContours(region.mask, contours, -1, 255, cv::FILLED);
    regions.push_back(region);
  }
  return regions;
}

/// Boxes around parts of the image that are full of strong edges, as prints and labels are: there
/// local features may find what has no colour of its own.
std::vector<cv::Rect> busyBoxes(const cv::Mat& grey)
{
  constexpr int kStep = 2;           // the search works on an image this much smaller
  constexpr double kEdge = 45.0;     // grey levels, across three pixels
  constexpr int kWindow = 11;        // px: a single straight edge does not fill it
  constexpr double kDensity = 0.30;  // of edge pixels in the window
  constexpr int kMinArea = 30;       // px
  cv::Mat small;
  cv::resize(grey, small, {}, 1.0 / kStep, 1.0 / kStep, cv::INTER_AREA);
  cv::Mat edges;
  cv::morphologyEx(small, edges, cv::MORPH_GRADIENT, cv::Mat::ones(3, 3, CV_8U));
  edges = edges > kEdge;
  cv::Mat density;
  cv::boxFilter(edges, density, CV_8U, {kWindow, kWindow});
  const cv::Mat busy = density > 255.0 * kDensity;
  cv::Mat labels;
  cv::Mat statistics;
  cv::Mat centres;
  const int n = cv::connectedComponentsWithStats(busy, labels, statistics, centres, 8, CV_32S);
  std::vector<cv::Rect> boxes;
  for (int i = 1; i < n; ++i)
  {
    const int* row = statistics.ptr<int>(i);
    if (row[cv::CC_STAT_AREA] >= kMinArea)
      boxes.emplace_back(kStep * row[cv::CC_STAT_LEFT], kStep * row[cv::CC_STAT_TOP],
                         kStep * row[cv::CC_STAT_WIDTH], kStep * row[cv::CC_STAT_HEIGHT]);
  }
  return boxes;
}

bool touchesBorder(const cv::Rect& box, const cv::Mat& image)
{
  return box.x <= 1 || box.y <= 1 || box.br().x >= image.cols - 1 || box.br().y >= image.rows - 1;
}

}  // namespace

ProposalMaker::ProposalMaker(const DetectorModel& model, const DetectorOptions& options)
  : model_(model), extractor_(options.max_features), matcher_(model, options.search_checks)
{
}

std::vector<ProposalMaker::Region> ProposalMaker::partsOf(const std::vector<Region>& regions,
                                                          const cv::Mat& lab) const
{
  std::vector<Region> parts;
  for (const Region& region : regions)
  {
    const std::vector<cv::Mat> masks = model_.object_colours.segment(lab(region.box), region.mask);
    for (std::size_t object = 0; object < masks.size(); ++object)
    {
      if (cv::countNonZero(masks[object]) < kMinPartPixels)
        continue;
      cv::Mat closed;
      cv::morphologyEx(masks[object], closed, cv::MORPH_CLOSE, cv::Mat::ones(5, 5, CV_8U));
      std::vector<Region> found = components<Region>(closed, kMinPartPixels);
      std::stable_sort(found.begin(), found.end(), [](const Region& a, const Region& b) {
        return a.box.area() > b.box.area();
      });
      for (std::size_t i = 0; i < found.size() && i < kPartsPerObject; ++i)
      {
        found[i].box += region.box.tl();
        found[i].object = static_cast<int>(object);
        if (overlap(found[i].box, region.box) < kSameBox)
          parts.push_back(found[i]);
      }
    }
  }
  return parts;
}

std::vector<double> ProposalMaker::colourDistances(const cv::Mat& hsv, const cv::Mat& mask) const
{
  const cv::Mat histogram = colourHistogram(hsv, mask);
  // Mean of the two nearest views: one alone may resemble by chance.
  std::vector<double> first(model_.objects.size(), 1.0);
  std::vector<double> second(model_.objects.size(), 1.0);
  for (const ViewModel& view : model_.views)
  {
    const double distance = bhattacharyya(histogram, view.histogram);
    const std::size_t object = static_cast<std::size_t>(view.object);
    if (distance < first[object])
    {
      second[object] = first[object];
      first[object] = distance;
    }
    else
      second[object] = std::min(second[object], distance);
  }
  for (std::size_t i = 0; i < first.size(); ++i)
    first[i] = 0.5 * (first[i] + second[i]);
  return first;
}

std::vector<Proposal> ProposalMaker::propose(const cv::Mat& bgr) const
{
  const cv::Rect image(0, 0, bgr.cols, bgr.rows);
  cv::Mat grey;
  cv::Mat lab;
  cv::cvtColor(bgr, grey, cv::COLOR_BGR2GRAY);
  cv::cvtColor(bgr, lab, cv::COLOR_BGR2Lab);
  cv::Mat foreground = model_.foreground.segment(lab);
  cv::morphologyEx(foreground, foreground, cv::MORPH_OPEN, cv::Mat::ones(3, 3, CV_8U));
  cv::morphologyEx(foreground, foreground, cv::MORPH_CLOSE, cv::Mat::ones(7, 7, CV_8U));
  std::vector<Region> regions = components<Region>(foreground, kMinRegionPixels);
  std::vector<cv::Rect> boxes = busyBoxes(grey);
  for (const Region& region : regions)
    boxes.push_back(region.box);
  const MatchResult matches = matcher_.match(extractor_.extract(grey, disjoint(boxes, image)));

  std::vector<Draft> drafts;
  for (const std::vector<ViewMatch>* views : {&matches.best, &matches.others})
    for (const ViewMatch& match : *views)
      addViewDrafts(match, foreground, drafts);
  const std::vector<Region> parts = partsOf(regions, lab);
  regions.insert(regions.end(), parts.begin(), parts.end());
  addRegionDrafts(regions, bgr, drafts);

  std::vector<Proposal> proposals;
  for (const Draft& draft : drafts)
    proposals.push_back(
        {draft.object, draft.box, weigh(draft, regions, matches.votes, bgr, lab, foreground)});
  compareRivals(proposals);
  return proposals;
}

void ProposalMaker::compareRivals(std::vector<Proposal>& proposals) const
{
  const auto at = [](const Proposal& proposal, Evidence which) {
    return proposal.evidence[static_cast<std::size_t>(which)];
  };
  for (Proposal& mine : proposals)
  {
    double votes = 0.0;
    double appearance = at(mine, Evidence::kAppearance);
    bool alone = true;
    for (const Proposal& other : proposals)
    {
      if (&other == &mine || other.object != mine.object || overlap(other.box, mine.box) > kSameBox)
        continue;
      votes = std::max(votes, at(other, Evidence::kVotes));
      const double theirs = at(other, Evidence::kAppearance);
      appearance = alone ? theirs : std::min(appearance, theirs);
      alone = false;
    }
    mine.evidence[static_cast<std::size_t>(Evidence::kRivalVotes)] = votes;
    mine.evidence[static_cast<std::size_t>(Evidence::kRivalAppearance)] =
        alone ? 0.0 : at(mine, Evidence::kAppearance) - appearance;
  }
}

void ProposalMaker::addViewDrafts(const ViewMatch& match, const cv::Mat& foreground,
                                  std::vector<Draft>& drafts) const
{
  const cv::Rect box = match.box & cv::Rect({}, foreground.size());
  if (box.width < kMinSide || box.height < kMinSide)
    return;
  drafts.push_back({match.object, box, match.inliers, match.inlier_ratio, -1});
  // A view from the front that is laid over a side reaches beyond the object.
  const cv::Rect coloured = cv::boundingRect(foreground(box)) + box.tl();
  if (coloured.width >= kMinSide && coloured.height >= kMinSide &&
      coloured.area() >= kMinRegionPixels && overlap(coloured, box) < kSameBox)
    drafts.push_back({match.object, coloured, match.inliers, match.inlier_ratio, -1});
}

void ProposalMaker::addRegionDrafts(const std::vector<Region>& regions, const cv::Mat& bgr,
                                    std::vector<Draft>& drafts) const
{
  for (std::size_t r = 0; r < regions.size(); ++r)
  {
    const Region& region = regions[r];
    for (const int object : likelyObjects(region, bgr))
    {
      Draft* nearest = nullptr;
      double common = kSomeOverlap;
      for (Draft& draft : drafts)
        if (draft.object == object && draft.region < 0)
          if (const double both = overlap(draft.box, region.box); both > common)
          {
            nearest = &draft;
            common = both;
          }
      if (nearest != nullptr && common > kSilhouette)
      {
        nearest->box = region.box;  // the silhouette is the better box
        nearest->region = static_cast<int>(r);
      }
      else if (nearest != nullptr)  // which of the two boxes is right is for the evidence to say
        drafts.push_back(
            {object, region.box, nearest->inliers, nearest->inlier_ratio, static_cast<int>(r)});
      else
        drafts.push_back({object, region.box, 0, 0.0, static_cast<int>(r)});
    }
  }
}

std::vector<int> ProposalMaker::likelyObjects(const Region& region, const cv::Mat& bgr) const
{
  if (region.object >= 0)
    return {region.object};
  cv::Mat hsv;
  cv::cvtColor(bgr(region.box), hsv, cv::COLOR_BGR2HSV);
  const std::vector<double> distances = colourDistances(hsv, region.mask);
  std::vector<int> order(distances.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return distances[static_cast<std::size_t>(a)] < distances[static_cast<std::size_t>(b)];
  });
  order.resize(std::min(order.size(), kColourCandidates));
  return order;
}

std::vector<double> ProposalMaker::weigh(const Draft& draft, const std::vector<Region>& regions,
                                         const std::vector<FeatureVote>& votes, const cv::Mat& bgr,
                                         const cv::Mat& lab, const cv::Mat& foreground) const
{
  const std::size_t object = static_cast<std::size_t>(draft.object);
  int own_votes = 0;
  int other_votes = 0;
  for (const FeatureVote& vote : votes)
    if (draft.box.contains(vote.point))
      ++(vote.object == draft.object ? own_votes : other_votes);

  const bool is_region =
      draft.region >= 0 && draft.box == regions[static_cast<std::size_t>(draft.region)].box;
  const cv::Mat mask =
      is_region ? regions[static_cast<std::size_t>(draft.region)].mask : foreground(draft.box);
  cv::Mat hsv;
  cv::cvtColor(bgr(draft.box), hsv, cv::COLOR_BGR2HSV);
  const std::vector<double> distances = colourDistances(hsv, mask);
  double rival = 1.0;
  for (std::size_t i = 0; i < distances.size(); ++i)
    if (i != object)
      rival = std::min(rival, distances[i]);
  const cv::Mat thumbnail = thumbnailOf(lab(draft.box));
  double appearance = 1.0;
  double other_appearance = 1.0;
  for (const ViewModel& view : model_.views)
  {
    double& least = view.object == draft.object ? appearance : other_appearance;
    least = std::min(least, thumbnailDistance(thumbnail, view.thumbnail));
  }
  // Without a silhouette of its own only the box's aspect is known.
  const ShapeModel& shape_model = model_.shapes[object];
  Shape shape = shape_model.mean;
  if (is_region)
    shape = shapeOf(mask);
  else
    shape[0] = std::log(static_cast<double>(draft.box.width) / draft.box.height);

  std::vector<double> evidence(kEvidenceCount, 0.0);
  const auto set = [&](Evidence which, double value) {
    evidence[static_cast<std::size_t>(which)] = value;
  };
  set(Evidence::kInliers, std::min(3.5, std::log1p(draft.inliers)));
  set(Evidence::kInlierRatio, draft.inlier_ratio);
  set(Evidence::kVotes, std::min(3.5, std::log1p(own_votes)));
  set(Evidence::kOtherVotes, std::min(3.5, std::log1p(other_votes)));
  set(Evidence::kColour, distances[object]);
  set(Evidence::kColourMargin, distances[object] - rival);
  set(Evidence::kAppearance, appearance);
  set(Evidence::kAppearanceMargin, appearance - other_appearance);
  set(Evidence::kShape, shape_model.distance(shape));
  const bool is_part = is_region && regions[static_cast<std::size_t>(draft.region)].object >= 0;
  set(Evidence::kRegion, is_region && !is_part ? 1.0 : 0.0);
  set(Evidence::kPart, is_part ? 1.0 : 0.0);
  set(Evidence::kRegionInliers, is_region && draft.inliers > 0 ? 1.0 : 0.0);
  set(Evidence::kArea, std::log(draft.box.area()) - 7.0);
  set(Evidence::kAspect, std::log(static_cast<double>(draft.box.width) / draft.box.height));
  set(Evidence::kFill, static_cast<double>(cv::countNonZero(mask)) / draft.box.area());
  set(Evidence::kBorder, touchesBorder(draft.box, bgr) ? 1.0 : 0.0);
  return evidence;
}

}  // namespace kr3::perception
