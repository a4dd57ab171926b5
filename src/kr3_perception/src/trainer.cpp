#include "kr3_perception/trainer.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <random>
#include <set>

#include <opencv2/imgproc.hpp>

#include "kr3_common/error.hpp"
#include "kr3_perception/evaluation.hpp"
#include "kr3_perception/features.hpp"
#include "proposals.hpp"

namespace kr3::perception
{
namespace
{

constexpr std::size_t kMaxCandidates = 120;  // views per object among which the best are chosen
constexpr double kSameFeature = 250.0;       // L2 distance of descriptors that tell the same
constexpr double kSmallestDeviation = 0.05;  // of a shape: no object is that exactly known
constexpr int kPadding = 16;
constexpr unsigned kSeed = 1;

/// Everything one object shows in the training images.
struct Candidates
{
  std::size_t seen = 0;
  std::vector<ViewModel> views;
  std::vector<int> pixels;
  std::vector<Shape> shapes;
};

bool cutOff(const cv::Rect& box, const cv::Mat& image)
{
  return box.x <= 0 || box.y <= 0 || box.br().x >= image.cols || box.br().y >= image.rows;
}

ViewModel viewOf(int object, const LabelledImage& image, const Label& label, const cv::Mat& mask,
                 const FeatureExtractor& extractor, int max_keypoints)
{
  ViewModel view;
  view.object = object;
  view.size = label.box.size();
  cv::Mat hsv;
  cv::cvtColor(image.bgr(label.box), hsv, cv::COLOR_BGR2HSV);
  view.histogram = colourHistogram(hsv, mask(label.box));
  cv::Mat grey;
  cv::cvtColor(image.bgr, grey, cv::COLOR_BGR2GRAY);
  const cv::Rect around(label.box.x - kPadding, label.box.y - kPadding,
                        label.box.width + 2 * kPadding, label.box.height + 2 * kPadding);
  cv::Mat lab;
  cv::cvtColor(image.bgr(label.box), lab, cv::COLOR_BGR2Lab);
  view.thumbnail = thumbnailOf(lab, mask(label.box));
  const Features features = extractor.extract(grey, {around}, mask);
  const cv::Point2f centre(
      static_cast<float>(label.box.x) + static_cast<float>(label.box.width) / 2.0F,
      static_cast<float>(label.box.y) + static_cast<float>(label.box.height) / 2.0F);
  view.keypoints = features.keypoints;
  view.descriptors =
      features.descriptors.rowRange(0, std::min(max_keypoints, features.descriptors.rows)).clone();
  view.keypoints.resize(static_cast<std::size_t>(view.descriptors.rows));
  for (cv::KeyPoint& keypoint : view.keypoints)
    keypoint.pt -= centre;
  return view;
}

/// Whether no other label's box covers a part of this one's.
bool apart(const Label& label, const std::vector<Label>& labels)
{
  constexpr double kCovered = 0.04;
  return std::all_of(labels.begin(), labels.end(), [&](const Label& other) {
    return &other == &label || (other.box & label.box).area() <= kCovered * label.box.area();
  });
}

/// Raises max_in_image of `objects` to what is seen in `folders`.
void countInstances(const std::vector<LabelledFolder>& folders,
                    std::vector<ObjectDescription>& objects)
{
  for (const LabelledFolder& folder : folders)
    for (std::size_t i = 0; i < folder.size(); ++i)
    {
      const std::vector<Label>& labels = folder.labels(i);
      for (ObjectDescription& object : objects)
        object.max_in_image = std::max(
            object.max_in_image,
            static_cast<int>(std::count_if(labels.begin(), labels.end(), [&](const Label& label) {
              return label.name == object.name;
            })));
    }
}

/// Features of `view` that none of `known` resembles.
int novelty(const ViewModel& view, const cv::Mat& known)
{
  if (known.empty() || view.descriptors.empty())
    return view.descriptors.rows;
  cv::Mat distances;
  cv::batchDistance(view.descriptors, known, distances, CV_32F, cv::noArray(), cv::NORM_L2);
  int novel = 0;
  for (int i = 0; i < distances.rows; ++i)
  {
    double nearest = 0.0;
    cv::minMaxLoc(distances.row(i), &nearest);
    novel += nearest > kSameFeature ? 1 : 0;
  }
  return novel;
}

/// The views that together show most: each time the one that adds most features.
std::vector<ViewModel> mostTelling(std::vector<ViewModel> views, int count)
{
  std::vector<ViewModel> chosen;
  cv::Mat known;
  while (static_cast<int>(chosen.size()) < count && !views.empty())
  {
    std::size_t best = 0;
    int best_novelty = -1;
    for (std::size_t i = 0; i < views.size(); ++i)
    {
      const int value = novelty(views[i], known);
      if (value > best_novelty)
      {
        best = i;
        best_novelty = value;
      }
    }
    if (!views[best].descriptors.empty())
      known.push_back(views[best].descriptors);
    chosen.push_back(std::move(views[best]));
    views.erase(views.begin() + static_cast<std::ptrdiff_t>(best));
  }
  return chosen;
}

ShapeModel shapeModel(const std::vector<Shape>& shapes)
{
  ShapeModel model;
  const double n = static_cast<double>(shapes.size());
  for (std::size_t k = 0; k < model.mean.size(); ++k)
  {
    for (const Shape& shape : shapes)
      model.mean[k] += shape[k] / n;
    for (const Shape& shape : shapes)
      model.deviation[k] += (shape[k] - model.mean[k]) * (shape[k] - model.mean[k]) / n;
    model.deviation[k] = std::sqrt(model.deviation[k]) + kSmallestDeviation;
  }
  return model;
}

}  // namespace

Trainer::Trainer(std::vector<ObjectDescription> objects, const TrainerOptions& options)
  : objects_(std::move(objects)), options_(options)
{
  std::set<std::string> names;
  for (const ObjectDescription& object : objects_)
    if (!names.insert(object.name).second)
      throw InvalidArgument("object '" + object.name + "' is there twice");
  if (objects_.empty())
    throw InvalidArgument("there are no objects to learn");
  if (options_.views_per_object <= 0 || options_.keypoints_per_view <= 0 ||
      options_.background_features < 0)
    throw InvalidArgument(
        "views_per_object and keypoints_per_view must be > 0, background_features >= 0");
  if (!(options_.match_overlap > 0.0 && options_.match_overlap < 1.0))
    throw InvalidArgument("match_overlap must be in (0, 1)");
}

DetectorModel Trainer::train(const std::vector<LabelledFolder>& looks,
                             const std::vector<LabelledFolder>& calibration,
                             const Progress& progress) const
{
  DetectorModel model = learnLooks(looks, progress);
  for (const std::vector<LabelledFolder>* folders : {&looks, &calibration})
    countInstances(*folders, model.objects);
  model.classifier = learnClassifier(model, calibration, progress);
  return model;
}

DetectorModel Trainer::learnLooks(const std::vector<LabelledFolder>& folders,
                                  const Progress& progress) const
{
  std::map<std::string, int> index;
  for (std::size_t i = 0; i < objects_.size(); ++i)
    index[objects_[i].name] = static_cast<int>(i);
  const FeatureExtractor extractor(options_.detector.max_features);
  std::vector<Candidates> candidates(objects_.size());
  std::vector<Candidates> hidden(objects_.size());
  ColourCounter colours(static_cast<int>(objects_.size()));
  cv::Mat background(0, 128, CV_8U);
  std::mt19937_64 random(kSeed);
  std::size_t seen = 0;
  std::map<std::string, int> unknown;
  for (const LabelledFolder& folder : folders)
    for (std::size_t i = 0; i < folder.size(); ++i)
    {
      const LabelledImage image = folder.image(i);
      cv::Mat who(image.bgr.size(), CV_32S, cv::Scalar(-1));
      for (const Label& label : image.labels)
      {
        const auto known = index.find(label.name);
        if (known == index.end())
        {
          ++unknown[label.name];
          continue;
        }
        const cv::Mat mask = maskOf(image, label);
        who.setTo(known->second, mask);
        // What is partly hidden teaches looks only when there is nothing better.
        Candidates& mine =
            (apart(label, image.labels) ? candidates
                                        : hidden)[static_cast<std::size_t>(known->second)];
        if (label.pixels < options_.min_pixels || cutOff(label.box, image.bgr))
          continue;
        // Reservoir sampling: every view is a candidate with the same probability.
        ++mine.seen;
        std::size_t slot = mine.views.size();
        if (slot == kMaxCandidates)
          slot = random() % mine.seen;
        if (slot >= kMaxCandidates)
          continue;
        mine.views.resize(std::max(mine.views.size(), slot + 1));
        mine.pixels.resize(mine.views.size());
        mine.shapes.resize(mine.views.size());
        mine.views[slot] =
            viewOf(known->second, image, label, mask, extractor, options_.keypoints_per_view);
        mine.pixels[slot] = label.pixels;
        mine.shapes[slot] = shapeOf(mask(label.box));
      }
      cv::Mat lab;
      cv::cvtColor(image.bgr, lab, cv::COLOR_BGR2Lab);
      colours.add(lab, who);
      // Of the building, keep features that lie clear of every object.
      cv::Mat clear;
      cv::dilate(who >= 0, clear, cv::Mat::ones(25, 25, CV_8U));
      cv::bitwise_not(clear, clear);
      cv::Mat grey;
      cv::cvtColor(image.bgr, grey, cv::COLOR_BGR2GRAY);
      const Features building = extractor.extract(grey, {cv::Rect({}, grey.size())}, clear);
      for (int row = 0; row < building.descriptors.rows; ++row)
      {
        ++seen;  // reservoir sampling: every feature is kept with the same probability
        if (background.rows < options_.background_features)
          background.push_back(building.descriptors.row(row));
        else if (const std::size_t slot = random() % seen;
                 slot < static_cast<std::size_t>(background.rows))
          building.descriptors.row(row).copyTo(background.row(static_cast<int>(slot)));
      }
      if ((i + 1) % 50 == 0)
        progress("looked at " + std::to_string(i + 1) + " of " + std::to_string(folder.size()) +
                 " images");
    }

  for (const auto& [name, count] : unknown)
    progress("'" + name + "' is no object to be learned: its " + std::to_string(count) +
             (count == 1 ? " label counts" : " labels count") + " as building");

  DetectorModel model{objects_, {}, {}, background, colours.foreground(), colours.objects(), {}};
  for (std::size_t i = 0; i < objects_.size(); ++i)
  {
    if (candidates[i].views.empty())
      candidates[i] = std::move(hidden[i]);
    if (candidates[i].views.empty())
      throw InvalidArgument("no training image shows '" + objects_[i].name +
                            "' whole with at least " + std::to_string(options_.min_pixels) +
                            " pixels");
    model.shapes.push_back(shapeModel(candidates[i].shapes));
    std::vector<ViewModel> views =
        mostTelling(std::move(candidates[i].views), options_.views_per_object);
    progress(objects_[i].name + ": " + std::to_string(views.size()) + " views");
    std::move(views.begin(), views.end(), std::back_inserter(model.views));
  }
  check(model);
  return model;
}

BoostedTrees Trainer::learnClassifier(const DetectorModel& model,
                                      const std::vector<LabelledFolder>& folders,
                                      const Progress& progress) const
{
  const ProposalMaker maker(model, options_.detector);
  std::vector<std::vector<double>> evidence;
  std::vector<bool> truth;
  std::vector<int> image_of;
  int num_images = 0;
  for (const LabelledFolder& folder : folders)
    for (std::size_t i = 0; i < folder.size(); ++i)
    {
      const LabelledImage image = folder.image(i);
      for (const Proposal& proposal : maker.propose(image.bgr))
      {
        const std::string& name = objects_[static_cast<std::size_t>(proposal.object)].name;
        evidence.push_back(proposal.evidence);
        image_of.push_back(num_images);
        truth.push_back(std::any_of(image.labels.begin(), image.labels.end(),
                                    [&](const Label& label) {
          return label.name == name && overlap(label.box, proposal.box) >= options_.match_overlap;
        }));
      }
      ++num_images;
    }
  const auto right = std::count(truth.begin(), truth.end(), true);
  if (right == 0 || right == static_cast<std::ptrdiff_t>(truth.size()))
    throw InvalidArgument("the calibration images give " + std::to_string(right) +
                          " right ones of " + std::to_string(truth.size()) +
                          " proposals: expected some of both kinds");
  progress("calibrated on " + std::to_string(truth.size()) + " proposals, " +
           std::to_string(right) + " right");
  return fitBoostedTrees(evidence, truth, image_of);
}

}  // namespace kr3::perception
