#include "kr3_perception/detector.hpp"

#include <algorithm>

#include <opencv2/imgproc.hpp>

#include "kr3_common/error.hpp"
#include "kr3_perception/evaluation.hpp"
#include "kr3_perception/labelled_folder.hpp"
#include "proposals.hpp"

namespace kr3::perception
{
namespace
{

constexpr double kSamePlace = 0.6;     // overlap from which two detections compete
constexpr double kSameInstance = 0.3;  // overlap from which two of one object do
constexpr int kMinImageSide = 16;
constexpr double kMaxPixels = 1e8;

DetectorModel checked(DetectorModel model, const DetectorOptions& options)
{
  check(model);
  if (model.classifier.numFeatures() != static_cast<int>(kEvidenceCount))
    throw InvalidArgument("the model weighs " + std::to_string(model.classifier.numFeatures()) +
                          " features, expected " + std::to_string(kEvidenceCount));
  if (!(options.min_probability >= 0.0 && options.min_probability < 1.0))
    throw InvalidArgument("min_probability is " + std::to_string(options.min_probability) +
                          ", expected [0, 1)");
  if (options.search_checks <= 0)
    throw InvalidArgument("search_checks is " + std::to_string(options.search_checks) +
                          ", expected > 0");
  if (options.max_instances < 0)
    throw InvalidArgument("max_instances is " + std::to_string(options.max_instances) +
                          ", expected >= 0");
  if (options.max_instances > 0)
    for (ObjectDescription& object : model.objects)
      object.max_in_image = options.max_instances;
  return model;
}

}  // namespace

class Detector::Impl
{
public:
  Impl(DetectorModel model, const DetectorOptions& options)
    : model_(checked(std::move(model), options)), options_(options), proposals_(model_, options)
  {
  }

  [[nodiscard]] const DetectorModel& model() const { return model_; }

  [[nodiscard]] std::vector<Detection> detect(const cv::Mat& bgr) const
  {
    if (static_cast<double>(bgr.total()) > kMaxPixels)
      throw InvalidArgument("image of " + std::to_string(bgr.cols) + " x " +
                            std::to_string(bgr.rows) + " px, expected at most 100 megapixels");
    const int side = std::max(bgr.cols, bgr.rows);
    if (side <= kMaxImageSide)
      return detectAsIs(bgr);
    const double scale = static_cast<double>(kMaxImageSide) / side;
    cv::Mat small;
    cv::resize(bgr, small, {}, scale, scale, cv::INTER_AREA);
    std::vector<Detection> detections = detectAsIs(small);
    for (Detection& detection : detections)
    {
      const cv::Rect& box = detection.box;
      detection.box =
          cv::Rect(cv::Point(cvRound(box.x / scale), cvRound(box.y / scale)),
                   cv::Point(cvRound(box.br().x / scale), cvRound(box.br().y / scale))) &
          cv::Rect({}, bgr.size());
    }
    return detections;
  }

private:
  [[nodiscard]] std::vector<Detection> detectAsIs(const cv::Mat& bgr) const
  {
    if (bgr.type() != CV_8UC3 || bgr.cols < kMinImageSide || bgr.rows < kMinImageSide)
      throw InvalidArgument("image of type " + cv::typeToString(bgr.type()) + " with " +
                            std::to_string(bgr.cols) + " x " + std::to_string(bgr.rows) +
                            " px, expected CV_8UC3 of at least 16 x 16");
    struct Candidate
    {
      std::size_t object;
      double probability;
      cv::Rect box;
    };
    std::vector<Candidate> candidates;
    for (const Proposal& proposal : proposals_.propose(bgr))
    {
      const double probability = model_.classifier.probability(proposal.evidence);
      if (probability >= options_.min_probability)
        candidates.push_back(
            {static_cast<std::size_t>(proposal.object), probability, proposal.box});
    }
    std::stable_sort(
        candidates.begin(), candidates.end(),
        [](const Candidate& a, const Candidate& b) { return a.probability > b.probability; });
    std::vector<int> count(model_.objects.size(), 0);
    std::vector<Candidate> kept;
    for (const Candidate& candidate : candidates)
    {
      const bool beaten = std::any_of(kept.begin(), kept.end(), [&](const Candidate& better) {
        return overlap(better.box, candidate.box) >
               (better.object == candidate.object ? kSameInstance : kSamePlace);
      });
      if (beaten || count[candidate.object] == model_.objects[candidate.object].max_in_image)
        continue;
      ++count[candidate.object];
      kept.push_back(candidate);
    }
    std::vector<Detection> detections;
    for (const Candidate& candidate : kept)
    {
      const ObjectDescription& object = model_.objects[candidate.object];
      detections.push_back({object.name, object.class_name, candidate.probability, candidate.box});
    }
    return detections;
  }

  DetectorModel model_;
  DetectorOptions options_;
  ProposalMaker proposals_;
};

Detector::Detector(DetectorModel model, const DetectorOptions& options)
  : impl_(std::make_unique<Impl>(std::move(model), options))
{
}
Detector::~Detector() = default;
Detector::Detector(Detector&&) noexcept = default;
Detector& Detector::operator=(Detector&&) noexcept = default;

std::vector<Detection> Detector::detect(const cv::Mat& bgr) const
{
  return impl_->detect(bgr);
}

const DetectorModel& Detector::model() const
{
  return impl_->model();
}

}  // namespace kr3::perception
