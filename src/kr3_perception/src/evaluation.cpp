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
  std::set<std::string> found;
  for (const Detection& detection : detections)
  {
    const auto label = std::find_if(labels.begin(), labels.end(), [&](const Label& candidate) {
      return candidate.name == detection.name &&
             overlap(candidate.box, detection.box) >= match_overlap_;
    });
    const bool right = label != labels.end();
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
      ++classes_[detection.class_name].wrong;
    else if (label->pixels >= min_pixels_ && found.insert(label->name).second)
      ++classes_[detection.class_name].right;
  }
  for (const Label& label : labels)
    if (label.pixels >= min_pixels_ && found.count(label.name) == 0 &&
        class_of.count(label.name) > 0)
      ++classes_[class_of.at(label.name)].missed;
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
