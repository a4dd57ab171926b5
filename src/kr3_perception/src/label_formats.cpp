#include "label_formats.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include <nlohmann/json.hpp>

#include "kr3_common/error.hpp"

namespace kr3::perception
{
namespace
{

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr double kMaxCoordinate = 3e4;  // px: the area of a box with such sides fits into an int
constexpr long long kMaxPixels = 100'000'000;  // of an image
constexpr long long kMaxId =
    1LL << 53;  // whole numbers up to here are exact also as floating point

/// Where in a file the reader is; makes its messages.
class Place
{
public:
  explicit Place(std::string text) : text_(std::move(text)) {}
  [[nodiscard]] Place in(const std::string& part) const { return Place(text_ + ": " + part); }
  [[nodiscard]] const std::string& text() const { return text_; }
  [[noreturn]] void fail(const std::string& what) const
  {
    throw InvalidArgument(text_ + ": " + what);
  }

private:
  std::string text_;
};

Json parsed(const fs::path& path)
{
  std::ifstream file(path);
  if (!file)
    throw Unavailable("cannot read '" + path.string() + "'");
  try
  {
    return Json::parse(file);
  }
  catch (const Json::exception& e)
  {
    throw InvalidArgument(path.string() + ": " + e.what());
  }
}

template <typename T>
T valueOf(const Json& json, const std::string& key, const char* expected, const Place& place)
{
  if (!json.is_object() || !json.contains(key))
    place.fail("'" + key + "' is missing, expected " + expected);
  try
  {
    return json.at(key).get<T>();
  }
  catch (const Json::exception&)
  {
    place.fail("'" + key + "' is " + json.at(key).dump().substr(0, 60) + ", expected " + expected);
  }
}

/// A whole number in [low, high]: one with a fraction or out of range is refused, not cut.
long long wholeOf(const Json& json, const std::string& key, long long low, long long high,
                  const Place& place)
{
  const std::string expected =
      "a whole number from " + std::to_string(low) + " to " + std::to_string(high);
  (void)valueOf<Json>(json, key, expected.c_str(), place);
  const Json& value = json.at(key);
  // Numbers written as 3.0 are what some tools make of 3.
  const double number = value.is_number() ? value.get<double>() : std::nan("");
  if (!(number >= static_cast<double>(low) && number <= static_cast<double>(high)) ||
      number != std::floor(number))
    place.fail("'" + key + "' is " + value.dump().substr(0, 60) + ", expected " + expected);
  return value.is_number_float() ? static_cast<long long>(number) : value.get<long long>();
}

const Json& listOf(const Json& json, const std::string& key, const Place& place)
{
  if (!json.is_object() || !json.contains(key) || !json.at(key).is_array())
    place.fail("expected a list named '" + key + "'");
  return json.at(key);
}

cv::Rect boxOf(const Json& json, const std::string& key, const Place& place)
{
  const std::vector<double> box =
      valueOf<std::vector<double>>(json, key, "[x, y, width, height] in px", place);
  if (box.size() != 4 || !std::all_of(box.begin(), box.end(), [](double value) {
        return std::isfinite(value) && std::abs(value) < kMaxCoordinate;
      }))
    place.fail("'" + key + "' is " + json.at(key).dump().substr(0, 60) +
               ", expected [x, y, width, height] in px");
  const cv::Rect rect(cv::Point(cvRound(box[0]), cvRound(box[1])),
                      cv::Point(cvRound(box[0] + box[2]), cvRound(box[1] + box[3])));
  if (box[2] <= 0.0 || box[3] <= 0.0 || rect.area() <= 0)
    place.fail("the box " + json.at(key).dump().substr(0, 60) + " has no area");
  return rect;
}

std::vector<LabelledEntry> readOurs(const fs::path& folder)
{
  const Place file((folder / "labels.json").string());
  const Json root = parsed(folder / "labels.json");
  std::vector<LabelledEntry> entries;
  for (const Json& image : listOf(root, "images", file))
  {
    const Place place = file.in("image " + std::to_string(entries.size()));
    LabelledEntry entry;
    entry.where = place.text();
    entry.image = (folder / valueOf<std::string>(image, "image", "a file name", place)).string();
    if (image.contains("mask"))
      entry.mask = (folder / valueOf<std::string>(image, "mask", "a file name", place)).string();
    for (const Json& object : listOf(image, "objects", place))
    {
      const Place here = place.in("object " + std::to_string(entry.labels.size()));
      Label label;
      label.name = valueOf<std::string>(object, "name", "text", here);
      label.box = boxOf(object, "box", here);
      label.pixels = label.box.area();
      if (object.contains("instance"))
        label.instance = static_cast<int>(wholeOf(object, "instance", 0, 255, here));
      if (object.contains("pixels"))
        label.pixels = static_cast<int>(wholeOf(object, "pixels", 0, kMaxPixels, here));
      if (label.name.empty())
        here.fail("the name is empty");
      entry.labels.push_back(label);
    }
    entries.push_back(entry);
  }
  return entries;
}

std::vector<LabelledEntry> readCoco(const fs::path& path, const Json& root)
{
  const Place file(path.string());
  std::map<long long, std::string> categories;
  for (const Json& category : listOf(root, "categories", file))
  {
    const Place place = file.in("category " + std::to_string(categories.size()));
    categories[wholeOf(category, "id", -kMaxId, kMaxId, place)] =
        valueOf<std::string>(category, "name", "text", place);
  }
  const fs::path folder = path.parent_path();
  std::map<long long, std::size_t> index;
  std::vector<LabelledEntry> entries;
  for (const Json& image : listOf(root, "images", file))
  {
    const Place place = file.in("image " + std::to_string(entries.size()));
    const std::string name = valueOf<std::string>(image, "file_name", "a file name", place);
    const long long id = wholeOf(image, "id", -kMaxId, kMaxId, place);
    if (!index.emplace(id, entries.size()).second)
      place.fail("the id " + std::to_string(id) + " is there twice");
    const fs::path in_images = folder / "images" / name;
    LabelledEntry entry;
    entry.where = place.text();
    entry.image = (fs::exists(in_images) ? in_images : folder / name).string();
    entries.push_back(entry);
  }
  std::size_t number = 0;
  for (const Json& annotation : listOf(root, "annotations", file))
  {
    const Place place = file.in("annotation " + std::to_string(number++));
    const auto image = index.find(wholeOf(annotation, "image_id", -kMaxId, kMaxId, place));
    if (image == index.end())
      place.fail("there is no image with the id " + annotation.at("image_id").dump());
    const auto category =
        categories.find(wholeOf(annotation, "category_id", -kMaxId, kMaxId, place));
    if (category == categories.end())
      place.fail("there is no category with the id " + annotation.at("category_id").dump());
    Label label;
    label.name = category->second;
    label.box = boxOf(annotation, "bbox", place);
    label.pixels = label.box.area();
    entries[image->second].labels.push_back(label);
  }
  return entries;
}

bool isImage(const fs::path& path)
{
  std::string end = path.extension().string();
  std::transform(end.begin(), end.end(), end.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return end == ".png" || end == ".jpg" || end == ".jpeg" || end == ".bmp" || end == ".ppm";
}

/// "CLASS X Y WIDTH HEIGHT": the centre and the size as shares of the image.
void addYoloLine(const std::string& text, const std::vector<std::string>& names, const Place& place,
                 LabelledEntry& entry)
{
  std::istringstream line(text);
  std::size_t name = 0;
  double x = 0.0;
  double y = 0.0;
  double width = 0.0;
  double height = 0.0;
  std::string rest;
  if (!(line >> name >> x >> y >> width >> height) || (line >> rest))
    place.fail("found '" + text.substr(0, 60) + "', expected CLASS X Y WIDTH HEIGHT");
  if (name >= names.size())
    place.fail("class " + std::to_string(name) + " of " + std::to_string(names.size()) +
               " in classes.txt");
  if (!(width > 0.0 && height > 0.0))
    place.fail("the box " + std::to_string(width) + " x " + std::to_string(height) +
               " has no area");
  constexpr double kRounding = 1e-3;
  if (!(x - width / 2 >= -kRounding && y - height / 2 >= -kRounding &&
        x + width / 2 <= 1.0 + kRounding && y + height / 2 <= 1.0 + kRounding))
    place.fail("the box '" + text.substr(0, 60) +
               "' leaves the image, expected shares of its width and height");
  Label label;
  label.name = names[name];
  entry.labels.push_back(label);
  entry.shares.emplace_back(x - width / 2, y - height / 2, width, height);
}

std::vector<LabelledEntry> readYolo(const fs::path& folder)
{
  std::vector<std::string> names;
  std::ifstream classes(folder / "classes.txt");
  for (std::string line; std::getline(classes, line);)
  {
    while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back())) != 0)
      line.pop_back();
    if (!line.empty())
      names.push_back(line);
  }
  if (names.empty())
    throw InvalidArgument((folder / "classes.txt").string() +
                          ": found nothing, expected one name a line");
  const bool apart = fs::is_directory(folder / "images");
  std::vector<fs::path> images;
  for (const fs::directory_entry& file : fs::directory_iterator(apart ? folder / "images" : folder))
    if (file.is_regular_file() && isImage(file.path()))
      images.push_back(file.path());
  std::sort(images.begin(), images.end());
  std::vector<LabelledEntry> entries;
  for (const fs::path& image : images)
  {
    LabelledEntry entry;
    entry.image = image.string();
    entry.where = entry.image;
    const fs::path beside = apart ? folder / "labels" / image.filename() : image;
    const fs::path text = fs::path(beside).replace_extension(".txt");
    std::ifstream file(text);  // an image without a label file shows no object
    int number = 0;
    for (std::string line; std::getline(file, line);)
    {
      ++number;
      if (line.find_first_not_of(" \t\r") != std::string::npos)
        addYoloLine(line, names, Place(text.string() + ":" + std::to_string(number)), entry);
    }
    entries.push_back(entry);
  }
  return entries;
}

}  // namespace

std::vector<LabelledEntry> readLabels(const std::string& folder_path)
{
  const fs::path folder(folder_path);
  if (!fs::is_directory(folder))
    throw Unavailable("there is no folder '" + folder_path + "'");
  if (fs::exists(folder / "labels.json"))
    return readOurs(folder);
  std::vector<fs::path> candidates;
  for (const fs::directory_entry& file : fs::directory_iterator(folder))
    if (file.path().extension() == ".json")
      candidates.push_back(file.path());
  std::sort(candidates.begin(), candidates.end());
  for (const fs::path& path : candidates)
    if (const Json root = parsed(path); root.is_object() && root.contains("annotations"))
      return readCoco(path, root);
  if (fs::exists(folder / "classes.txt"))
    return readYolo(folder);
  throw Unavailable("cannot read labels of '" + folder_path +
                    "': expected labels.json, a COCO file (*.json with 'annotations') or YOLO's "
                    "classes.txt");
}

}  // namespace kr3::perception
