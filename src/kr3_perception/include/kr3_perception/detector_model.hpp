#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "kr3_perception/boosted_trees.hpp"
#include "kr3_perception/colour_model.hpp"
#include "kr3_perception/shape_model.hpp"
#include "kr3_perception/thumbnail.hpp"

namespace kr3::perception
{

/// An object to be found, with its physical size standing upright; 0 = not known.
struct ObjectDescription
{
  std::string name;        ///< unique
  std::string class_name;  ///< several objects may share it
  double width_m = 0.0;    ///< widest horizontal extent
  double height_m = 0.0;
  int max_in_image = 1;  ///< so many of it were seen in one training image, > 0
};

/// One object as seen from one side: local features and colours.
struct ViewModel
{
  int object = 0;                       ///< index into DetectorModel::objects
  cv::Size size;                        ///< px, of its box in the training image
  cv::Mat histogram;                    ///< see colourHistogram()
  cv::Mat thumbnail;                    ///< see thumbnailOf()
  std::vector<cv::KeyPoint> keypoints;  ///< px, relative to the box's centre
  cv::Mat descriptors;                  ///< CV_8UC1, shape [keypoints, 128]
};

/// Everything that was learned: objects as probabilistic functions of colour, shape and local
/// gradients. Source: Li and Sridharan, "Automatic object discovery and detection by colour, shape
/// and local gradients", ICAR 2013; the evidence is joined here by boosted trees instead of by its
/// Bayesian product.
struct DetectorModel
{
  std::vector<ObjectDescription> objects;
  std::vector<ShapeModel> shapes;  ///< shape [objects]
  std::vector<ViewModel> views;
  cv::Mat
      background_descriptors;  ///< CV_8UC1, shape [n, 128]: features of the building, n may be 0
  ForegroundModel foreground;
  ObjectColourModel object_colours;
  BoostedTrees classifier;  ///< of evidence in the order of Evidence in proposals.hpp
};

/// @throws InvalidArgument  naming the first thing that is inconsistent
void check(const DetectorModel& model);

}  // namespace kr3::perception
