#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "kr3_perception/colour_model.hpp"
#include "kr3_perception/shape_model.hpp"

namespace kr3::perception
{

/// An object to be found, with its physical size standing upright.
struct ObjectDescription
{
  std::string name;        ///< unique
  std::string class_name;  ///< several objects may share it
  double width_m = 0.0;    ///< widest horizontal extent
  double height_m = 0.0;
};

/// One object as seen from one side: local features and colours.
struct ViewModel
{
  int object = 0;                       ///< index into DetectorModel::objects
  cv::Size size;                        ///< px, of its box in the training image
  cv::Mat histogram;                    ///< see colourHistogram()
  std::vector<cv::KeyPoint> keypoints;  ///< px, relative to the box's centre
  cv::Mat descriptors;                  ///< CV_8UC1, shape [keypoints, 128]
};

/// Everything that was learned: objects as probabilistic functions of colour, shape and local
/// gradients. Source: Li and Sridharan, "Automatic object discovery and detection by colour, shape
/// and local gradients", ICAR 2013; the evidence is joined here by logistic regression instead of
/// by its Bayesian product.
struct DetectorModel
{
  std::vector<ObjectDescription> objects;
  std::vector<ShapeModel> shapes;  ///< shape [objects]
  std::vector<ViewModel> views;
  cv::Mat
      background_descriptors;  ///< CV_8UC1, shape [n, 128]: features of the building, n may be 0
  ForegroundModel foreground;
  ObjectColourModel object_colours;
  std::vector<double>
      weights;  ///< of the logistic regression; see Evidence in proposals.hpp for their order
};

/// @throws InvalidArgument  naming the first thing that is inconsistent
void check(const DetectorModel& model);

}  // namespace kr3::perception
