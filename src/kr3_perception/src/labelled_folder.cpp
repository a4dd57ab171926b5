#include "kr3_perception/labelled_folder.hpp"

#include <fstream>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "kr3_common/error.hpp"

namespace kr3::perception
{
namespace
{

Label labelFrom(const nlohmann::json& json)
{
  Label label;
  label.name = json.at("name").get<std::string>();
  label.instance = json.value("instance", 0);
  const std::vector<int> box = json.at("box").get<std::vector<int>>();
  if (box.size() != 4 || box[2] <= 0 || box[3] <= 0)
    throw InvalidArgument("box of '" + label.name +
                          "' is not [x, y, width, height] with a positive size");
  label.box = {box[0], box[1], box[2], box[3]};
  label.pixels = json.value("pixels", label.box.area());
  return label;
}

}  // namespace

LabelledFolder::LabelledFolder(std::string path) : path_(std::move(path))
{
  const std::string file_name = path_ + "/labels.json";
  std::ifstream file(file_name);
  if (!file)
    throw Unavailable("cannot read '" + file_name + "'");
  try
  {
    const nlohmann::json root = nlohmann::json::parse(file);
    for (const nlohmann::json& image : root.at("images"))
    {
      Entry entry;
      entry.image = image.at("image").get<std::string>();
      entry.mask = image.value("mask", "");
      for (const nlohmann::json& object : image.at("objects"))
        entry.labels.push_back(labelFrom(object));
      entries_.push_back(entry);
    }
  }
  catch (const nlohmann::json::exception& e)
  {
    throw InvalidArgument(file_name + ": image " + std::to_string(entries_.size()) + ": " +
                          e.what());
  }
  catch (const InvalidArgument& e)
  {
    throw InvalidArgument(file_name + ": image " + std::to_string(entries_.size()) + ": " +
                          e.what());
  }
}

LabelledImage LabelledFolder::image(std::size_t index) const
{
  if (index >= entries_.size())
    throw InvalidArgument("image " + std::to_string(index) + " of " +
                          std::to_string(entries_.size()));
  const Entry& entry = entries_[index];
  LabelledImage result;
  result.name = entry.image;
  result.labels = entry.labels;
  result.bgr = cv::imread(path_ + "/" + entry.image, cv::IMREAD_COLOR);
  if (result.bgr.empty())
    throw Unavailable("cannot read image '" + path_ + "/" + entry.image + "'");
  if (!entry.mask.empty())
  {
    result.mask = cv::imread(path_ + "/" + entry.mask, cv::IMREAD_GRAYSCALE);
    if (result.mask.size() != result.bgr.size())
      throw Unavailable("mask '" + path_ + "/" + entry.mask +
                        "' cannot be read or is not of the image's size");
  }
  const cv::Rect whole({}, result.bgr.size());
  for (const Label& label : result.labels)
    if ((label.box & whole) != label.box)
      throw InvalidArgument(path_ + "/" + entry.image + ": box of '" + label.name +
                            "' leaves the image");
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
