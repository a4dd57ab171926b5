#include "kr3_perception/labelled_folder.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "kr3_common/error.hpp"
#include "label_formats.hpp"

namespace kr3::perception
{
namespace
{

constexpr double kMaxPixels = 1e8;
constexpr int kRounding = 2;  // px that a box may leave the image: labelling tools round

cv::Mat readImage(const std::string& path, cv::ImreadModes mode, const std::string& where)
{
  cv::Mat image;
  try
  {
    image = cv::imread(path, mode);
  }
  catch (const cv::Exception& e)
  {
    throw Unavailable(where + ": cannot read '" + path + "': " + e.err);
  }
  if (image.empty())
    throw Unavailable(where + ": cannot read '" + path + "': there is no such file, or no image");
  if (static_cast<double>(image.total()) > kMaxPixels)
    throw InvalidArgument(where + ": '" + path + "' has " + std::to_string(image.cols) + " x " +
                          std::to_string(image.rows) + " px, expected at most 100 megapixels");
  return image;
}

/// The box in the image; one that leaves it by more than rounding explains is refused.
cv::Rect insideImage(const Label& label, const cv::Size& size, const std::string& where)
{
  const cv::Rect whole({}, size);
  const cv::Rect inside = label.box & whole;
  const cv::Rect& box = label.box;
  if (box.x < -kRounding || box.y < -kRounding || box.br().x > size.width + kRounding ||
      box.br().y > size.height + kRounding || inside.area() <= 0)
    throw InvalidArgument(where + ": the box of '" + label.name + "' [" + std::to_string(box.x) +
                          ", " + std::to_string(box.y) + ", " + std::to_string(box.width) + ", " +
                          std::to_string(box.height) + "] leaves the image of " +
                          std::to_string(size.width) + " x " + std::to_string(size.height) + " px");
  return inside;
}

}  // namespace

struct LabelledFolder::Entry
{
  LabelledEntry labelled;
};

LabelledFolder::LabelledFolder(const std::string& path)
{
  for (LabelledEntry& entry : readLabels(path))
    entries_.push_back(std::make_shared<const Entry>(Entry{std::move(entry)}));
  if (entries_.empty())
    throw InvalidArgument("'" + path + "' has no images");
}

LabelledFolder::LabelledFolder(std::vector<std::shared_ptr<const Entry>> entries)
  : entries_(std::move(entries))
{
}

std::pair<LabelledFolder, LabelledFolder> LabelledFolder::split(std::size_t every) const
{
  std::vector<std::shared_ptr<const Entry>> most;
  std::vector<std::shared_ptr<const Entry>> some;
  for (std::size_t i = 0; i < entries_.size(); ++i)
    (i % every == every - 1 ? some : most).push_back(entries_[i]);
  if (every < 2 || some.empty())
    throw InvalidArgument("cannot take every " + std::to_string(every) + "th of " +
                          std::to_string(entries_.size()) + " images");
  return {LabelledFolder(std::move(most)), LabelledFolder(std::move(some))};
}

const LabelledFolder::Entry& LabelledFolder::entry(std::size_t index) const
{
  if (index >= entries_.size())
    throw InvalidArgument("image " + std::to_string(index) + " of " +
                          std::to_string(entries_.size()));
  return *entries_[index];
}

const std::vector<Label>& LabelledFolder::labels(std::size_t index) const
{
  return entry(index).labelled.labels;
}

LabelledImage LabelledFolder::image(std::size_t index) const
{
  const LabelledEntry& entry = this->entry(index).labelled;
  LabelledImage result;
  result.name = entry.image;
  result.labels = entry.labels;
  result.bgr = readImage(entry.image, cv::IMREAD_COLOR, entry.where);
  if (!entry.mask.empty())
  {
    result.mask = readImage(entry.mask, cv::IMREAD_GRAYSCALE, entry.where);
    if (result.mask.size() != result.bgr.size())
      throw InvalidArgument(
          entry.where + ": mask '" + entry.mask + "' has " + std::to_string(result.mask.cols) +
          " x " + std::to_string(result.mask.rows) + " px, its image " +
          std::to_string(result.bgr.cols) + " x " + std::to_string(result.bgr.rows));
  }
  for (std::size_t i = 0; i < entry.shares.size(); ++i)
  {
    const cv::Rect2d& share = entry.shares[i];
    Label& label = result.labels[i];
    label.box = {cv::Point(cvRound(share.x * result.bgr.cols), cvRound(share.y * result.bgr.rows)),
                 cv::Point(cvRound((share.x + share.width) * result.bgr.cols),
                           cvRound((share.y + share.height) * result.bgr.rows))};
    label.pixels = label.box.area();
  }
  for (Label& label : result.labels)
    label.box = insideImage(label, result.bgr.size(), entry.where);
  const double scale =
      static_cast<double>(kMaxImageSide) / std::max(result.bgr.cols, result.bgr.rows);
  if (scale < 1.0)
  {
    cv::resize(result.bgr, result.bgr, {}, scale, scale, cv::INTER_AREA);
    if (!result.mask.empty())
      cv::resize(result.mask, result.mask, result.bgr.size(), 0.0, 0.0, cv::INTER_NEAREST);
    const cv::Rect whole({}, result.bgr.size());
    for (Label& label : result.labels)
    {
      label.box =
          cv::Rect(cv::Point(cvFloor(scale * label.box.x), cvFloor(scale * label.box.y)),
                   cv::Point(cvCeil(scale * label.box.br().x), cvCeil(scale * label.box.br().y))) &
          whole;
      label.pixels = cvRound(scale * scale * label.pixels);
    }
  }
  return result;
}

cv::Mat maskOf(const LabelledImage& image, const Label& label)
{
  if (!image.mask.empty() && label.instance > 0)
    return image.mask == label.instance;
  cv::Mat mask = cv::Mat::zeros(image.bgr.size(), CV_8U);
  const cv::Point centre(label.box.x + label.box.width / 2, label.box.y + label.box.height / 2);
  cv::ellipse(mask, centre, {label.box.width / 2, label.box.height / 2}, 0.0, 0.0, 360.0, 255,
              cv::FILLED);
  return mask;
}

}  // namespace kr3::perception
