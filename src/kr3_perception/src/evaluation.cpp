#include "kr3_perception/evaluation.hpp"

#include <algorithm>
#include <set>

#include "kr3_common/error.hpp"

namespace kr3::perception
{
namespace
{

constexpr std::size_t kNumBins = 10;

double share(int part, int rest)
{
  return part + rest == 0 ? 1.0 : static_cast<double>(part) / (part + rest);
}

}  // namespace

double ClassScore::precision() const
{
  return share(right, wrong);
}
double ClassScore::recall() const
{
  return share(right, missed);
}

Evaluation::Evaluation(double threshold, int min_pixels, double match_overlap)
  : threshold_(threshold), min_pixels_(min_pixels), match_overlap_(match_overlap), bins_(kNumBins)
{
  if (!(threshold > 0.0 && threshold < 1.0) || !(match_overlap > 0.0 && match_overlap < 1.0))
    throw InvalidArgument("threshold and match_overlap must be in (0, 1)");
}

void Evaluation::add(const std::vector<Detection>& detections, const std::vector<Label>& labels,
                     const std::map<std::string, std::string>& class_of)
{
  std::set<std::size_t> found;  // indices into labels
  std::set<std::size_t> told;   // of them, those told with enough certainty
  for (const Detection& detection : detections)
  {
    // Of several equal objects the one that overlaps most and is not taken yet.
    std::size_t label = labels.size();
    double best = match_overlap_;
    for (std::size_t i = 0; i < labels.size(); ++i)
      if (labels[i].name == detection.name && found.count(i) == 0)
        if (const double common = overlap(labels[i].box, detection.box); common >= best)
        {
          best = common;
          label = i;
        }
    const bool right = label < labels.size();
    if (right)
      found.insert(label);
    ReliabilityBin& bin =
        bins_[std::min(kNumBins - 1, static_cast<std::size_t>(detection.probability * kNumBins))];
    ++bin.detections;
    bin.right += right ? 1 : 0;
    bin.probability_sum += detection.probability;
    const double error = (right ? 1.0 : 0.0) - detection.probability;
    squared_error_ += error * error;
    ++detections_;
    if (detection.probability < threshold_)
      continue;
    if (!right)
    {
      ++classes_[detection.class_name].wrong;
      ++objects_[detection.name].wrong;
    }
    else if (labels[label].pixels >= min_pixels_)
    {
      ++classes_[detection.class_name].right;
      ++objects_[detection.name].right;
      told.insert(label);
    }
  }
  for (std::size_t i = 0; i < labels.size(); ++i)
    if (labels[i].pixels >= min_pixels_ && told.count(i) == 0 && class_of.count(labels[i].name) > 0)
    {
      ++classes_[class_of.at(labels[i].name)].missed;
      ++objects_[labels[i].name].missed;
    }
}

ClassScore Evaluation::total() const
{
  ClassScore sum;
  for (const auto& [name, score] : classes_)
  {
    sum.right += score.right;
    sum.wrong += score.wrong;
    sum.missed += score.missed;
  }
  return sum;
}

double Evaluation::brier() const
{
  return detections_ == 0 ? 0.0 : squared_error_ / detections_;
}

double overlap(const cv::Rect& a, const cv::Rect& b)
{
  const double common = (a & b).area();
  const double both = a.area() + b.area() - common;
  return both > 0.0 ? common / both : 0.0;
}

}  // namespace kr3::perception
