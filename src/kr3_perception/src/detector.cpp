#include "kr3_perception/detector.hpp"

#include <algorithm>

#include "kr3_common/error.hpp"
#include "kr3_perception/evaluation.hpp"
#include "logistic.hpp"
#include "proposals.hpp"

namespace kr3::perception
{
namespace
{

constexpr double kSamePlace = 0.6;  // overlap from which two detections compete
constexpr int kMinImageSide = 16;

DetectorModel checked(DetectorModel model, const DetectorOptions& options)
{
  check(model);
  if (model.weights.size() != kEvidenceCount)
    throw InvalidArgument("the model has " + std::to_string(model.weights.size()) +
                          " weights, expected " + std::to_string(kEvidenceCount));
  if (!(options.min_probability >= 0.0 && options.min_probability < 1.0))
    throw InvalidArgument("min_probability is " + std::to_string(options.min_probability) +
                          ", expected [0, 1)");
  if (options.search_checks <= 0)
    throw InvalidArgument("search_checks is " + std::to_string(options.search_checks) +
                          ", expected > 0");
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
    if (bgr.type() != CV_8UC3 || bgr.cols < kMinImageSide || bgr.rows < kMinImageSide)
      throw InvalidArgument("image of type " + cv::typeToString(bgr.type()) + " with " +
                            std::to_string(bgr.cols) + " x " + std::to_string(bgr.rows) +
                            " px, expected CV_8UC3 of at least 16 x 16");
    std::vector<Detection> candidates;
    for (const Proposal& proposal : proposals_.propose(bgr))
    {
      const double probability = logistic(model_.weights, proposal.evidence);
      const ObjectDescription& object = model_.objects[static_cast<std::size_t>(proposal.object)];
      if (probability >= options_.min_probability)
        candidates.push_back({object.name, object.class_name, probability, proposal.box});
    }
    std::stable_sort(
        candidates.begin(), candidates.end(),
        [](const Detection& a, const Detection& b) { return a.probability > b.probability; });
    std::vector<Detection> detections;
    for (const Detection& candidate : candidates)
    {
      const bool beaten =
          std::any_of(detections.begin(), detections.end(), [&](const Detection& better) {
            return better.name == candidate.name || overlap(better.box, candidate.box) > kSamePlace;
          });
      if (!beaten)
        detections.push_back(candidate);
    }
    return detections;
  }

private:
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
