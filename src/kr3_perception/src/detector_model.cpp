#include "kr3_perception/detector_model.hpp"

#include <set>

#include "kr3_common/error.hpp"

namespace kr3::perception
{
namespace
{

constexpr int kDescriptorSize = 128;

void checkView(const ViewModel& view, std::size_t index, std::size_t num_objects)
{
  const std::string which = "view " + std::to_string(index);
  if (view.object < 0 || static_cast<std::size_t>(view.object) >= num_objects)
    throw InvalidArgument(which + " is of object " + std::to_string(view.object) + " of " +
                          std::to_string(num_objects));
  if (view.size.width <= 0 || view.size.height <= 0)
    throw InvalidArgument(which + " has no size");
  if (view.histogram.type() != CV_32FC1 || view.histogram.rows != 1 ||
      view.histogram.cols != kHistogramBins)
    throw InvalidArgument(which + " has a colour histogram of the wrong shape");
  if (view.thumbnail.type() != CV_8UC4 || view.thumbnail.rows != kThumbnailSide ||
      view.thumbnail.cols != kThumbnailSide)
    throw InvalidArgument(which + " has a thumbnail of the wrong shape");
  if (view.descriptors.rows != static_cast<int>(view.keypoints.size()) ||
      (view.descriptors.rows > 0 &&
       (view.descriptors.type() != CV_8UC1 || view.descriptors.cols != kDescriptorSize)))
    throw InvalidArgument(which + " has descriptors of the wrong shape");
}

}  // namespace

void check(const DetectorModel& model)
{
  if (model.objects.empty())
    throw InvalidArgument("the model knows no objects");
  std::set<std::string> names;
  for (const ObjectDescription& object : model.objects)
  {
    if (object.name.empty() || !names.insert(object.name).second)
      throw InvalidArgument("object name '" + object.name + "' is empty or there twice");
    if (!(object.width_m >= 0.0 && object.height_m >= 0.0))
      throw InvalidArgument("object '" + object.name + "' has a negative size");
    if (object.max_in_image <= 0)
      throw InvalidArgument("object '" + object.name + "' is said to be seen " +
                            std::to_string(object.max_in_image) + " times an image");
  }
  if (model.shapes.size() != model.objects.size())
    throw InvalidArgument("found " + std::to_string(model.shapes.size()) + " shapes for " +
                          std::to_string(model.objects.size()) + " objects");
  if (model.object_colours.numObjects() != static_cast<int>(model.objects.size()))
    throw InvalidArgument("found colours of " + std::to_string(model.object_colours.numObjects()) +
                          " objects for " + std::to_string(model.objects.size()) + " objects");
  for (const ShapeModel& shape : model.shapes)
    for (const double deviation : shape.deviation)
      if (!(deviation > 0.0))
        throw InvalidArgument("a shape has a standard deviation that is not positive");
  for (std::size_t i = 0; i < model.views.size(); ++i)
    checkView(model.views[i], i, model.objects.size());
  if (model.background_descriptors.rows > 0 &&
      (model.background_descriptors.type() != CV_8UC1 ||
       model.background_descriptors.cols != kDescriptorSize))
    throw InvalidArgument("the building's descriptors have the wrong shape");
}

}  // namespace kr3::perception
