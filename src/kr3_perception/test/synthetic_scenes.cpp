#include "synthetic_scenes.hpp"

#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace kr3::perception::test
{
namespace
{

constexpr int kWidth = 320;
constexpr int kHeight = 240;

double uniform(std::mt19937_64& random, double low, double high)
{
  return std::uniform_real_distribution<double>(low, high)(random);
}

cv::Mat paintedFront(int object)
{
  cv::RNG random(static_cast<std::uint64_t>(object) * 7919 + 17);
  cv::Mat front(
      160, 120, CV_8UC3,
      cv::Scalar(random.uniform(0, 120), random.uniform(0, 255), random.uniform(60, 255)));
  for (int i = 0; i < 40; ++i)
  {
    const cv::Scalar colour(random.uniform(0, 255), random.uniform(0, 255), random.uniform(0, 255));
    const cv::Point centre(random.uniform(8, 112), random.uniform(8, 152));
    if (i % 2 == 0)
      cv::circle(front, centre, random.uniform(3, 10), colour, cv::FILLED, cv::LINE_AA);
    else
      cv::line(front, centre, {random.uniform(8, 112), random.uniform(8, 152)}, colour, 2,
               cv::LINE_AA);
  }
  return front;
}

}  // namespace

SyntheticWorld::SyntheticWorld(int num_objects)
{
  for (int i = 0; i < num_objects; ++i)
  {
    objects_.push_back({"object" + std::to_string(i), i % 2 == 0 ? "even" : "odd", 0.15, 0.20});
    fronts_.push_back(paintedFront(i));
  }
}

LabelledImage SyntheticWorld::scene(std::uint64_t seed) const
{
  std::mt19937_64 random(seed);
  LabelledImage image;
  image.name = std::to_string(seed) + ".png";
  image.bgr =
      cv::Mat(kHeight, kWidth, CV_8UC3, cv::Scalar(205, 215, 220) * uniform(random, 0.85, 1.1));
  image.mask = cv::Mat::zeros(kHeight, kWidth, CV_8U);
  const int columns = static_cast<int>(objects_.size());
  for (int i = 0; i < columns; ++i)
  {
    if (uniform(random, 0.0, 1.0) < 0.5)
      continue;
    const cv::Mat& texture = front(i);
    const double scale = uniform(random, 0.35, 0.55);
    const double angle_deg = uniform(random, -6.0, 6.0);
    const cv::Point2d centre((i + 0.5) * kWidth / columns, uniform(random, 80.0, 160.0));
    cv::Mat placed = cv::getRotationMatrix2D(
        {static_cast<float>(texture.cols) / 2.0F, static_cast<float>(texture.rows) / 2.0F},
        angle_deg, scale);
    placed.at<double>(0, 2) += centre.x - texture.cols / 2.0;
    placed.at<double>(1, 2) += centre.y - texture.rows / 2.0;
    cv::Mat layer;
    cv::Mat cover;
    cv::warpAffine(texture, layer, placed, image.bgr.size(), cv::INTER_AREA);
    cv::warpAffine(cv::Mat(texture.size(), CV_8U, cv::Scalar(255)), cover, placed,
                   image.bgr.size());
    cover = cover > 127;
    layer.copyTo(image.bgr, cover);
    image.mask.setTo(i + 1, cover);
    image.labels.push_back({objects_[static_cast<std::size_t>(i)].name, i + 1,
                            cv::boundingRect(cover), cv::countNonZero(cover)});
  }
  cv::Mat noise(image.bgr.size(), CV_16SC3);
  cv::RNG(seed + 1).fill(noise, cv::RNG::NORMAL, 0.0, 3.0);
  cv::add(image.bgr, noise, image.bgr, cv::noArray(), CV_8U);
  return image;
}

void SyntheticWorld::writeFolder(const std::string& path, int num_images, std::uint64_t first_seed,
                                 bool masks) const
{
  std::filesystem::create_directories(path);
  std::ostringstream json;
  for (int i = 0; i < num_images; ++i)
  {
    const LabelledImage image = scene(first_seed + static_cast<std::uint64_t>(i));
    cv::imwrite(path + "/" + image.name, image.bgr);
    if (masks)
      cv::imwrite(path + "/mask_" + image.name, image.mask);
    json << (i > 0 ? ",\n" : "") << R"({"image": ")" << image.name << '"';
    if (masks)
      json << R"(, "mask": "mask_)" << image.name << '"';
    json << R"(, "objects": [)";
    for (std::size_t k = 0; k < image.labels.size(); ++k)
    {
      const Label& label = image.labels[k];
      json << (k > 0 ? ", " : "") << R"({"name": ")" << label.name << R"(", "box": [)"
           << label.box.x << ", " << label.box.y << ", " << label.box.width << ", "
           << label.box.height << "]";
      if (masks)
        json << R"(, "instance": )" << label.instance << R"(, "pixels": )" << label.pixels;
      json << "}";
    }
    json << "]}";
  }
  std::ofstream(path + "/labels.json") << "{\"images\": [\n" << json.str() << "\n]}\n";
}

}  // namespace kr3::perception::test
