#include "view_matcher.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "kr3_perception/evaluation.hpp"

namespace kr3::perception
{
namespace
{

constexpr int kNeighbours = 6;
constexpr float kRatio = 0.85F;  // of distances to the best and to the next class
constexpr int kTrees = 4;
constexpr std::size_t kViewsTried = 4;  // per object, those with most matches
constexpr double kOtherBox = 0.7;       // overlap below which a further view says something else
constexpr int kMaxPairs = 40;           // per view, in hypotheses
constexpr int kMinInliers = 3;
constexpr double kMinScale = 0.12;
constexpr double kMaxScale = 6.0;
constexpr double kMaxTilt = 35.0 * CV_PI / 180.0;  // objects stand upright

/// q = (a, b; -b, a) p + shift
struct Similarity
{
  double a = 1.0;
  double b = 0.0;
  cv::Point2d shift;

  [[nodiscard]] cv::Point2d operator()(const cv::Point2d& p) const
  {
    return {a * p.x - b * p.y + shift.x, b * p.x + a * p.y + shift.y};
  }
  [[nodiscard]] double scale() const { return std::hypot(a, b); }
  [[nodiscard]] bool plausible() const
  {
    return scale() >= kMinScale && scale() <= kMaxScale && std::abs(std::atan2(b, a)) <= kMaxTilt;
  }
};

/// Least squares over the listed points.
Similarity fitSimilarity(const std::vector<cv::Point2d>& from, const std::vector<cv::Point2d>& to,
                         const std::vector<int>& which)
{
  cv::Point2d mean_from;
  cv::Point2d mean_to;
  for (const int i : which)
  {
    mean_from += from[static_cast<std::size_t>(i)];
    mean_to += to[static_cast<std::size_t>(i)];
  }
  mean_from /= static_cast<double>(which.size());
  mean_to /= static_cast<double>(which.size());
  double dot = 0.0;
  double cross = 0.0;
  double norm = 0.0;
  for (const int i : which)
  {
    const cv::Point2d p = from[static_cast<std::size_t>(i)] - mean_from;
    const cv::Point2d q = to[static_cast<std::size_t>(i)] - mean_to;
    dot += p.dot(q);
    cross += p.x * q.y - p.y * q.x;
    norm += p.dot(p);
  }
  Similarity result;
  if (norm < 1.0)
    return {0.0, 0.0, {}};  // all in one place: implausible
  result.a = dot / norm;
  result.b = cross / norm;
  result.shift = mean_to - cv::Point2d(result.a * mean_from.x - result.b * mean_from.y,
                                       result.b * mean_from.x + result.a * mean_from.y);
  return result;
}

}  // namespace

ViewMatcher::ViewMatcher(const DetectorModel& model, int checks)
  : model_(model), search_(checks, 0.0F, false)
{
  cv::Mat all(0, 128, CV_8U);
  for (std::size_t view = 0; view < model.views.size(); ++view)
  {
    first_row_.push_back(all.rows);
    all.push_back(model.views[view].descriptors);
    view_of_.resize(static_cast<std::size_t>(all.rows), static_cast<int>(view));
  }
  if (!model.background_descriptors.empty())
    all.push_back(model.background_descriptors);
  view_of_.resize(static_cast<std::size_t>(all.rows), -1);
  all.convertTo(descriptors_, CV_32F);
  cvflann::seed_random(1);  // the trees are random: make every run the same
  if (descriptors_.rows > 0)
    index_.build(descriptors_, cv::flann::KDTreeIndexParams(kTrees));
}

MatchResult ViewMatcher::match(const Features& features) const
{
  MatchResult result;
  const int neighbours = std::min(kNeighbours, descriptors_.rows);
  if (features.keypoints.empty() || neighbours == 0)
    return result;
  cv::Mat queries;
  features.descriptors.convertTo(queries, CV_32F);
  cv::Mat rows(queries.rows, neighbours, CV_32S);
  cv::Mat squared(queries.rows, neighbours, CV_32F);
  index_.knnSearch(queries, rows, squared, neighbours, search_);

  const auto objectOf = [&](int row) {
    const int view = view_of_[static_cast<std::size_t>(row)];
    return view < 0 ? -1 : model_.views[static_cast<std::size_t>(view)].object;
  };
  std::map<int, std::vector<Pair>> pairs_of_view;
  for (int i = 0; i < rows.rows; ++i)
  {
    const int* row = rows.ptr<int>(i);
    const float* distance = squared.ptr<float>(i);
    const int object = objectOf(row[0]);
    if (object < 0)
      continue;
    int rival = 1;
    while (rival < neighbours && row[rival] >= 0 && objectOf(row[rival]) == object)
      ++rival;
    if (rival < neighbours && row[rival] >= 0 && distance[0] > kRatio * kRatio * distance[rival])
      continue;
    result.votes.push_back({features.keypoints[static_cast<std::size_t>(i)].pt, object});
    for (int k = 0; k < rival; ++k)
    {
      const int view = view_of_[static_cast<std::size_t>(row[k])];
      pairs_of_view[view].push_back({i, row[k] - first_row_[static_cast<std::size_t>(view)]});
    }
  }

  std::map<int, std::map<int, std::vector<Pair>>> of_object;
  for (auto& [view, pairs] : pairs_of_view)
    of_object[model_.views[static_cast<std::size_t>(view)].object][view] = std::move(pairs);
  for (auto& [object, views] : of_object)
    for (int i = 0; i < model_.objects[static_cast<std::size_t>(object)].max_in_image; ++i)
    {
      const std::vector<ViewMatch> fits = fittingViews(views, features);
      if (fits.empty())
        break;
      const ViewMatch& best = fits.front();
      result.best.push_back(best);
      for (const ViewMatch& other : fits)
        if (overlap(other.box, best.box) < kOtherBox)
          result.others.push_back(other);
      // The next instance is made of other features.
      for (auto& [view, pairs] : views)
        pairs.erase(std::remove_if(
                        pairs.begin(), pairs.end(),
                        [&](const Pair& pair) {
          return best.box.contains(features.keypoints[static_cast<std::size_t>(pair.feature)].pt);
                        }),
                    pairs.end());
    }
  return result;
}

std::vector<ViewMatch> ViewMatcher::fittingViews(
    const std::map<int, std::vector<Pair>>& pairs_of_view, const Features& features) const
{
  std::vector<int> order;
  for (const auto& [view, pairs] : pairs_of_view)
    if (static_cast<int>(pairs.size()) >= kMinInliers)
      order.push_back(view);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return pairs_of_view.at(a).size() > pairs_of_view.at(b).size();
  });
  order.resize(std::min(order.size(), kViewsTried));
  std::vector<ViewMatch> fits;
  for (const int view : order)
    if (const ViewMatch match = fit(view, pairs_of_view.at(view), features);
        match.inliers >= kMinInliers)
      fits.push_back(match);
  std::stable_sort(fits.begin(), fits.end(),
                   [](const ViewMatch& a, const ViewMatch& b) { return a.inliers > b.inliers; });
  return fits;
}

ViewMatch ViewMatcher::fit(int view_index, const std::vector<Pair>& pairs,
                           const Features& features) const
{
  const ViewModel& view = model_.views[static_cast<std::size_t>(view_index)];
  std::vector<cv::Point2d> from;
  std::vector<cv::Point2d> to;
  for (const Pair& pair : pairs)
  {
    from.emplace_back(view.keypoints[static_cast<std::size_t>(pair.keypoint)].pt);
    to.emplace_back(features.keypoints[static_cast<std::size_t>(pair.feature)].pt);
  }
  const int n = static_cast<int>(pairs.size());
  const auto inliersOf = [&](const Similarity& similarity) {
    const double tolerance =
        std::max(4.0, 0.08 * similarity.scale() * std::hypot(view.size.width, view.size.height));
    std::vector<int> inliers;
    std::set<int> used;  // a feature may have matched several keypoints: it counts once
    for (int i = 0; i < n; ++i)
    {
      const cv::Point2d error =
          similarity(from[static_cast<std::size_t>(i)]) - to[static_cast<std::size_t>(i)];
      if (error.dot(error) < tolerance * tolerance &&
          used.insert(pairs[static_cast<std::size_t>(i)].feature).second)
        inliers.push_back(i);
    }
    return inliers;
  };

  std::vector<int> best;
  for (int i = 0; i < std::min(n, kMaxPairs); ++i)
    for (int j = i + 1; j < std::min(n, kMaxPairs); ++j)
    {
      const Similarity similarity = fitSimilarity(from, to, {i, j});
      if (!similarity.plausible())
        continue;
      std::vector<int> inliers = inliersOf(similarity);
      if (inliers.size() > best.size())
        best = std::move(inliers);
    }
  ViewMatch result;
  result.object = view.object;
  result.view = view_index;
  if (static_cast<int>(best.size()) < kMinInliers)
    return result;
  const Similarity similarity = fitSimilarity(from, to, best);
  if (!similarity.plausible())
    return result;
  std::set<int> distinct;
  for (const Pair& pair : pairs)
    distinct.insert(pair.feature);
  const double width = view.size.width * similarity.scale();
  const double height = view.size.height * similarity.scale();
  result.box = {cvRound(similarity.shift.x - width / 2), cvRound(similarity.shift.y - height / 2),
                std::max(1, cvRound(width)), std::max(1, cvRound(height))};
  result.inliers = static_cast<int>(best.size());
  result.inlier_ratio = static_cast<double>(best.size()) / static_cast<double>(distinct.size());
  return result;
}

}  // namespace kr3::perception
