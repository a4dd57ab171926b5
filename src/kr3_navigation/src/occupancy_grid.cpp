#include "kr3_navigation/occupancy_grid.hpp"

#include <cassert>

#include <opencv2/imgproc.hpp>

namespace kr3::navigation
{

DistanceField distanceField(const OccupancyGrid& grid)
{
  assert(grid.nodes.size() == grid.geometry.size());
  DistanceField field{grid.geometry,
                      std::vector<float>(grid.nodes.size(), DistanceField::kFarDistance)};
  cv::Mat free(grid.geometry.height, grid.geometry.width, CV_8UC1);
  bool any_occupied = false;
  for (std::size_t node = 0; node < grid.nodes.size(); ++node)
  {
    const bool occupied = grid.nodes[node] == Occupancy::kOccupied;
    free.data[node] = occupied ? 0 : 255;
    any_occupied = any_occupied || occupied;
  }
  if (!any_occupied)
    return field;  // OpenCV's answer without a zero pixel is not a distance
  cv::Mat distance(grid.geometry.height, grid.geometry.width, CV_32FC1, field.distance_m.data());
  cv::distanceTransform(free, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE, CV_32F);
  for (float& value : field.distance_m)
    value *= static_cast<float>(grid.geometry.resolution_m);
  return field;
}

}  // namespace kr3::navigation
