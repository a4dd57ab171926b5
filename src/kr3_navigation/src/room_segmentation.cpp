#include "kr3_navigation/room_segmentation.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <queue>
#include <string>

#include <opencv2/imgproc.hpp>

#include <kr3_common/error.hpp>

namespace kr3::navigation
{
namespace
{

constexpr double kPartShare = 0.1;  // of a place that makes a room one of its parts

double nodeArea(const GridGeometry& grid)
{
  return grid.resolution_m * grid.resolution_m;
}

/// 255 where the floor is, furniture included; 0 for walls and the unknown.
///
/// Furniture is an island: occupied, with the unknown inside of it, and surrounded by floor. What
/// stands against a wall stays, and makes the room smaller.
cv::Mat floorOf(const OccupancyGrid& grid, const SegmentationOptions& options)
{
  const GridGeometry& geometry = grid.geometry;
  cv::Mat floor(geometry.height, geometry.width, CV_8UC1);
  for (std::size_t node = 0; node < grid.nodes.size(); ++node)
    floor.data[node] = grid.nodes[node] == Occupancy::kFree ? 255 : 0;
  // Islands of what is not free, surrounded by floor.
  cv::Mat labels;
  cv::Mat stats;
  cv::Mat centroids;
  const int count = cv::connectedComponentsWithStats(255 - floor, labels, stats, centroids, 8);
  for (int island = 1; island < count; ++island)
  {
    const int side = std::max(stats.at<int>(island, cv::CC_STAT_WIDTH),
                              stats.at<int>(island, cv::CC_STAT_HEIGHT));
    if (side * geometry.resolution_m <= options.furniture_size_m)
      floor.setTo(255, labels == island);
  }
  return floor;
}

/// Watershed by priority flood: nodes join the room of the neighbour from which they are reached,
/// widest places first.
void flood(const cv::Mat& floor, const cv::Mat& distance, cv::Mat& rooms)
{
  struct Entry
  {
    float distance;
    long order;
    int node;
    bool operator<(const Entry& other) const
    {
      return distance != other.distance ? distance < other.distance : order > other.order;
    }
  };
  std::priority_queue<Entry> queue;
  long order = 0;
  const int width = floor.cols;
  auto* const room = rooms.ptr<int>();
  const auto* const depth = distance.ptr<float>();
  const auto push = [&](int node) { queue.push({depth[node], order++, node}); };
  for (int node = 0; node < static_cast<int>(floor.total()); ++node)
  {
    if (room[node] > 0)
      push(node);
  }
  while (!queue.empty())
  {
    const int node = queue.top().node;
    queue.pop();
    const int column = node % width;
    for (const int step : {-1, 1, -width, width})
    {
      const int next = node + step;
      if (next < 0 || next >= static_cast<int>(floor.total()) || (step == -1 && column == 0) ||
          (step == 1 && column == width - 1) || floor.data[next] == 0 || room[next] > 0)
        continue;
      room[next] = room[node];
      push(next);
    }
  }
}

/// Rooms that are too small join the neighbour with the longest common border.
void mergeSmall(cv::Mat& rooms, int num_rooms, double least_nodes)
{
  while (true)
  {
    std::vector<long> size(static_cast<std::size_t>(num_rooms) + 1, 0);
    for (int node = 0; node < static_cast<int>(rooms.total()); ++node)
      ++size[static_cast<std::size_t>(rooms.ptr<int>()[node])];
    int smallest = 0;
    for (int room = 1; room <= num_rooms; ++room)
    {
      const long nodes = size[static_cast<std::size_t>(room)];
      if (nodes > 0 && static_cast<double>(nodes) < least_nodes &&
          (smallest == 0 || nodes < size[static_cast<std::size_t>(smallest)]))
        smallest = room;
    }
    if (smallest == 0)
      return;
    std::map<int, int> border;
    for (int row = 1; row < rooms.rows - 1; ++row)
    {
      for (int column = 1; column < rooms.cols - 1; ++column)
      {
        if (rooms.at<int>(row, column) != smallest)
          continue;
        for (const int next : {rooms.at<int>(row, column - 1), rooms.at<int>(row, column + 1),
                               rooms.at<int>(row - 1, column), rooms.at<int>(row + 1, column)})
        {
          if (next > 0 && next != smallest)
            ++border[next];
        }
      }
    }
    const auto longest =
        std::max_element(border.begin(), border.end(),
                         [](const auto& a, const auto& b) { return a.second < b.second; });
    rooms.setTo(border.empty() ? 0 : longest->first, rooms == smallest);
  }
}

/// The largest rectangle of nodes of a room, in nodes (columns and rows, both inclusive).
cv::Rect largestRectangle(const Segmentation& segmentation, int room)
{
  const GridGeometry& grid = segmentation.geometry;
  std::vector<int> height(static_cast<std::size_t>(grid.width), 0);
  cv::Rect best;
  for (int row = 0; row < grid.height; ++row)
  {
    for (int column = 0; column < grid.width; ++column)
    {
      int& above = height[static_cast<std::size_t>(column)];
      const auto node = static_cast<std::size_t>(row * grid.width + column);
      above = segmentation.room[node] == room ? above + 1 : 0;
      int lowest = above;
      for (int left = column; left >= 0 && lowest > 0; --left)
      {
        lowest = std::min(lowest, height[static_cast<std::size_t>(left)]);
        const int width = column - left + 1;
        if (lowest * width > best.area())
          best = {left, row - lowest + 1, width, lowest};
      }
    }
  }
  return best;
}

}  // namespace

double Segmentation::area(int wanted) const
{
  return static_cast<double>(std::count(room.begin(), room.end(), wanted)) * nodeArea(geometry);
}

Segmentation segmentRooms(const OccupancyGrid& grid, const SegmentationOptions& options)
{
  Segmentation segmentation{grid.geometry, std::vector<int>(grid.nodes.size(), -1), 0};
  if (grid.nodes.empty())
    return segmentation;
  const cv::Mat floor = floorOf(grid, options);
  cv::Mat distance;
  cv::distanceTransform(floor, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE, CV_32F);
  distance *= grid.geometry.resolution_m;
  cv::Mat rooms;
  const cv::Mat centers = distance > options.door_width_m / 2.0;
  const int num_seeds = cv::connectedComponents(centers, rooms, 8, CV_32S) - 1;
  flood(floor, distance, rooms);
  mergeSmall(rooms, num_seeds, options.least_area_m2 / nodeArea(grid.geometry));
  std::map<int, int> number;
  for (std::size_t node = 0; node < grid.nodes.size(); ++node)
  {
    const int label = rooms.ptr<int>()[node];
    if (label <= 0)
      continue;
    const auto [entry, is_new] = number.emplace(label, segmentation.num_rooms);
    if (is_new)
      ++segmentation.num_rooms;
    segmentation.room[node] = entry->second;
  }
  return segmentation;
}

SegmentationAgreement compareRooms(const Segmentation& segmentation,
                                   const std::vector<Place>& places)
{
  const auto num_rooms = static_cast<std::size_t>(segmentation.num_rooms);
  std::vector<long> room_size(num_rooms, 0);
  std::vector<std::vector<long>> common(places.size(), std::vector<long>(num_rooms, 0));
  for (std::size_t node = 0; node < segmentation.room.size(); ++node)
  {
    if (segmentation.room[node] < 0)
      continue;
    const auto room = static_cast<std::size_t>(segmentation.room[node]);
    ++room_size[room];
    const Point p = segmentation.geometry.center(static_cast<int>(node));
    for (std::size_t place = 0; place < places.size(); ++place)
    {
      if (places[place].rectangle.contains(p))
        ++common[place][room];
    }
  }
  SegmentationAgreement agreement;
  std::map<int, int> best_of;
  for (std::size_t place = 0; place < places.size(); ++place)
  {
    PlaceAgreement entry;
    entry.place = places[place].name;
    long size = 0;
    for (const long nodes : common[place])
      size += nodes;
    for (std::size_t room = 0; room < num_rooms; ++room)
    {
      const long both = common[place][room];
      if (both == 0)
        continue;
      if (static_cast<double>(both) >= kPartShare * static_cast<double>(size))
        ++entry.num_parts;
      if (entry.room < 0 || both > common[place][static_cast<std::size_t>(entry.room)])
        entry.room = static_cast<int>(room);
    }
    if (entry.room >= 0)
    {
      const auto room = static_cast<std::size_t>(entry.room);
      const long both = common[place][room];
      entry.iou = static_cast<double>(both) / static_cast<double>(size + room_size[room] - both);
      ++best_of[entry.room];
    }
    agreement.mean_iou += entry.iou / static_cast<double>(places.size());
    agreement.over_segmented += entry.num_parts > 1 ? 1 : 0;
    agreement.places.push_back(entry);
  }
  for (const auto& [room, count] : best_of)
    agreement.under_segmented += count > 1 ? 1 : 0;
  return agreement;
}

std::vector<Place> placesOfMap(const OccupancyMap& map, double z_min_m, double z_max_m,
                               const SegmentationOptions& options)
{
  const Segmentation segmentation =
      segmentRooms(map.project(z_min_m, z_max_m, map.extent()), options);
  if (segmentation.num_rooms == 0)
    throw InvalidArgument("the map shows no room: no free floor of at least " +
                          std::to_string(options.least_area_m2) + " m^2 between " +
                          std::to_string(z_min_m) + " m and " + std::to_string(z_max_m) + " m");
  return placesOf(segmentation);
}

std::vector<Place> placesOf(const Segmentation& segmentation)
{
  const GridGeometry& grid = segmentation.geometry;
  std::vector<Place> places;
  for (int room = 0; room < segmentation.num_rooms; ++room)
  {
    const cv::Rect nodes = largestRectangle(segmentation, room);
    places.push_back(
        {"room_" + std::to_string(room),
         {grid.origin.x + nodes.x * grid.resolution_m, grid.origin.y + nodes.y * grid.resolution_m,
          grid.origin.x + (nodes.x + nodes.width) * grid.resolution_m,
          grid.origin.y + (nodes.y + nodes.height) * grid.resolution_m}});
  }
  return places;
}

}  // namespace kr3::navigation
