#include "kr3_perception/model_file.hpp"

#include <cstdio>
#include <filesystem>

#include <opencv2/core/persistence.hpp>

#include "kr3_common/error.hpp"

namespace kr3::perception
{
namespace
{

constexpr int kFormat = 2;
constexpr int kMaxFeatures = 1000;  // of the evidence: far more than there are

/// Trees as rows [tree, feature, threshold, left, right, value].
cv::Mat packed(const std::vector<Tree>& trees)
{
  constexpr int kColumns = 6;
  cv::Mat rows(0, kColumns, CV_64F);
  for (std::size_t t = 0; t < trees.size(); ++t)
    for (const TreeNode& node : trees[t])
    {
      const cv::Mat row = (cv::Mat_<double>(1, kColumns) << static_cast<double>(t), node.feature,
                           node.threshold, node.left, node.right, node.value);
      rows.push_back(row);
    }
  return rows;
}

std::vector<Tree> unpackedTrees(const cv::Mat& rows)
{
  if (!rows.empty() && (rows.type() != CV_64F || rows.cols != 6))
    throw InvalidArgument("the trees have the wrong shape");
  std::vector<Tree> trees;
  for (int i = 0; i < rows.rows; ++i)
  {
    const double* row = rows.ptr<double>(i);
    for (const int column : {1, 3, 4})
      if (!(row[column] >= -1.0 && row[column] < rows.rows + kMaxFeatures))
        throw InvalidArgument("row " + std::to_string(i) + " of the trees has " +
                              std::to_string(row[column]) + " in column " + std::to_string(column));
    if (row[0] != static_cast<double>(trees.size()) &&
        row[0] + 1.0 != static_cast<double>(trees.size()))
      throw InvalidArgument("row " + std::to_string(i) + " of the trees is not in order");
    if (row[0] == static_cast<double>(trees.size()))
      trees.emplace_back();
    trees.back().push_back({static_cast<int>(row[1]), row[2], static_cast<int>(row[3]),
                            static_cast<int>(row[4]), row[5]});
  }
  return trees;
}

cv::Mat packed(const std::vector<cv::KeyPoint>& keypoints)
{
  cv::Mat rows(static_cast<int>(keypoints.size()), 4, CV_32F);
  for (int i = 0; i < rows.rows; ++i)
  {
    const cv::KeyPoint& keypoint = keypoints[static_cast<std::size_t>(i)];
    float* row = rows.ptr<float>(i);
    row[0] = keypoint.pt.x;
    row[1] = keypoint.pt.y;
    row[2] = keypoint.size;
    row[3] = keypoint.angle;
  }
  return rows;
}

std::vector<cv::KeyPoint> unpacked(const cv::Mat& rows)
{
  if (!rows.empty() && (rows.type() != CV_32F || rows.cols != 4))
    throw InvalidArgument("keypoints have the wrong shape");
  std::vector<cv::KeyPoint> keypoints;
  for (int i = 0; i < rows.rows; ++i)
  {
    const float* row = rows.ptr<float>(i);
    keypoints.emplace_back(row[0], row[1], row[2], row[3]);
  }
  return keypoints;
}

void write(cv::FileStorage& file, const DetectorModel& model)
{
  file << "format" << kFormat;
  file << "objects"
       << "[";
  for (std::size_t i = 0; i < model.objects.size(); ++i)
  {
    const ObjectDescription& object = model.objects[i];
    const ShapeModel& shape = model.shapes[i];
    file << "{"
         << "name" << object.name << "class" << object.class_name << "width" << object.width_m
         << "height" << object.height_m << "max_in_image" << object.max_in_image << "shape_mean"
         << std::vector<double>(shape.mean.begin(), shape.mean.end()) << "shape_deviation"
         << std::vector<double>(shape.deviation.begin(), shape.deviation.end()) << "}";
  }
  file << "]";
  file << "views"
       << "[";
  for (const ViewModel& view : model.views)
  {
    cv::Mat histogram;
    view.histogram.convertTo(histogram, CV_16U, 65535.0);
    file << "{"
         << "object" << view.object << "size" << view.size << "histogram" << histogram
         << "thumbnail" << view.thumbnail << "keypoints" << packed(view.keypoints) << "descriptors"
         << view.descriptors << "}";
  }
  file << "]";
  file << "background_descriptors" << model.background_descriptors;
  file << "foreground" << model.foreground.densities();
  file << "object_colours" << model.object_colours.probabilities();
  file << "features" << model.classifier.numFeatures() << "log_odds" << model.classifier.logOdds()
       << "trees" << packed(model.classifier.trees());
}

Shape shapeFrom(const cv::FileNode& node)
{
  std::vector<double> values;
  node >> values;
  Shape shape{};
  if (values.size() != shape.size())
    throw InvalidArgument("a shape has " + std::to_string(values.size()) + " values, expected " +
                          std::to_string(shape.size()));
  std::copy(values.begin(), values.end(), shape.begin());
  return shape;
}

cv::Mat matrixFrom(const cv::FileNode& node)
{
  cv::Mat matrix;
  node >> matrix;
  return matrix;
}

DetectorModel read(const cv::FileStorage& file)
{
  if (static_cast<int>(file["format"]) != kFormat)
    throw InvalidArgument("format is not " + std::to_string(kFormat) +
                          ": not a detector model, or of another version");
  DetectorModel model{{},
                      {},
                      {},
                      matrixFrom(file["background_descriptors"]),
                      ForegroundModel(matrixFrom(file["foreground"])),
                      ObjectColourModel(matrixFrom(file["object_colours"])),
                      {}};
  for (const cv::FileNode& node : file["objects"])
  {
    model.objects.push_back(
        {static_cast<std::string>(node["name"]), static_cast<std::string>(node["class"]),
         static_cast<double>(node["width"]), static_cast<double>(node["height"]),
         static_cast<int>(node["max_in_image"])});
    model.shapes.push_back({shapeFrom(node["shape_mean"]), shapeFrom(node["shape_deviation"])});
  }
  for (const cv::FileNode& node : file["views"])
  {
    ViewModel view;
    view.object = static_cast<int>(node["object"]);
    node["size"] >> view.size;
    matrixFrom(node["histogram"]).convertTo(view.histogram, CV_32F, 1.0 / 65535.0);
    view.thumbnail = matrixFrom(node["thumbnail"]);
    view.keypoints = unpacked(matrixFrom(node["keypoints"]));
    view.descriptors = matrixFrom(node["descriptors"]);
    model.views.push_back(view);
  }
  model.classifier =
      BoostedTrees(static_cast<int>(file["features"]), static_cast<double>(file["log_odds"]),
                   unpackedTrees(matrixFrom(file["trees"])));
  check(model);
  return model;
}

}  // namespace

void saveModel(const DetectorModel& model, const std::string& path)
{
  check(model);
  // The compression follows the name's end, so the temporary name keeps it.
  const std::filesystem::path target(path);
  const std::filesystem::path temporary =
      target.parent_path() / (".writing_" + target.filename().string());
  try
  {
    cv::FileStorage file(temporary.string(), cv::FileStorage::WRITE);
    if (!file.isOpened())
      throw Unavailable("cannot write '" + path + "'");
    write(file, model);
    file.release();
    std::filesystem::rename(temporary, target);
  }
  catch (const cv::Exception& e)
  {
    throw Unavailable("cannot write '" + path + "': " + e.what());
  }
  catch (const std::filesystem::filesystem_error& e)
  {
    throw Unavailable("cannot write '" + path + "': " + e.what());
  }
}

DetectorModel loadModel(const std::string& path)
{
  if (!std::filesystem::is_regular_file(path))
    throw Unavailable("no model file '" + path + "'");
  try
  {
    const cv::FileStorage file(path, cv::FileStorage::READ);
    if (!file.isOpened())
      throw InvalidArgument("it is not an OpenCV file");
    return read(file);
  }
  catch (const cv::Exception& e)
  {
    throw InvalidArgument("bad model file '" + path + "': " + e.err);
  }
  catch (const InvalidArgument& e)
  {
    throw InvalidArgument("bad model file '" + path + "': " + e.what());
  }
}

}  // namespace kr3::perception
