#include "conversions.hpp"

#include <cmath>

#include <kr3_common/error.hpp>

namespace kr3::navigation
{
namespace
{

geometry_msgs::Point pointMsg(Point p, double z = 0.0)
{
  geometry_msgs::Point message;
  message.x = p.x;
  message.y = p.y;
  message.z = z;
  return message;
}

std_msgs::ColorRGBA color(float red, float green, float blue, float alpha)
{
  std_msgs::ColorRGBA message;
  message.r = red;
  message.g = green;
  message.b = blue;
  message.a = alpha;
  return message;
}

visualization_msgs::Marker marker(const std_msgs::Header& header, const std::string& kind,
                                  std::size_t id, int type)
{
  visualization_msgs::Marker message;
  message.header = header;
  message.ns = kind;
  message.id = static_cast<int>(id);
  message.type = type;
  message.pose.orientation.w = 1.0;
  return message;
}

}  // namespace

Pose fromMsg(const geometry_msgs::Pose& message)
{
  const geometry_msgs::Quaternion& q = message.orientation;
  const double norm = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
  if (!std::isfinite(message.position.x) || !std::isfinite(message.position.y))
    throw InvalidArgument("the position is not finite");
  if (!(std::abs(norm - 1.0) < 0.05))
    throw InvalidArgument("the orientation is no unit quaternion: its squared norm is " +
                          std::to_string(norm));
  return {message.position.x, message.position.y,
          std::atan2(2.0 * (q.w * q.z + q.x * q.y), 1.0 - 2.0 * (q.y * q.y + q.z * q.z))};
}

LaserScan fromMsg(const sensor_msgs::LaserScan& message)
{
  const auto increment = static_cast<double>(message.angle_increment);
  const double beams =
      (static_cast<double>(message.angle_max) - static_cast<double>(message.angle_min)) /
          increment +
      1.0;
  // Drivers disagree on whether angle_max is the last beam or the one after it.
  constexpr double kTolerance = 1.5;
  if (!(std::abs(beams - static_cast<double>(message.ranges.size())) <= kTolerance))
    throw InvalidArgument(std::to_string(message.ranges.size()) + " ranges, but angles for " +
                          std::to_string(beams) + " beams");
  LaserScan scan{static_cast<double>(message.angle_min), increment,
                 static_cast<double>(message.range_min), static_cast<double>(message.range_max),
                 message.ranges};
  check(scan);
  return scan;
}

geometry_msgs::Pose toMsg(const Pose& pose)
{
  geometry_msgs::Pose message;
  message.position = pointMsg(pose.position());
  message.orientation.z = std::sin(pose.yaw / 2.0);
  message.orientation.w = std::cos(pose.yaw / 2.0);
  return message;
}

geometry_msgs::Twist toMsg(const Velocity& velocity)
{
  geometry_msgs::Twist message;
  message.linear.x = velocity.linear;
  message.angular.z = velocity.angular;
  return message;
}

geometry_msgs::TransformStamped toTransformMsg(const Pose& T_parent_child,
                                               const std_msgs::Header& parent,
                                               const std::string& child)
{
  geometry_msgs::TransformStamped message;
  message.header = parent;
  message.child_frame_id = child;
  const geometry_msgs::Pose pose = toMsg(T_parent_child);
  message.transform.translation.x = pose.position.x;
  message.transform.translation.y = pose.position.y;
  message.transform.rotation = pose.orientation;
  return message;
}

geometry_msgs::PoseWithCovarianceStamped toMsg(const PoseEstimate& estimate,
                                               const std_msgs::Header& header)
{
  geometry_msgs::PoseWithCovarianceStamped message;
  message.header = header;
  message.pose.pose = toMsg(estimate.mean);
  constexpr std::size_t kAxes[] = {0, 1, 5};  // x, y and yaw among ROS's six
  for (std::size_t row = 0; row < 3; ++row)
  {
    for (std::size_t column = 0; column < 3; ++column)
      message.pose.covariance[6 * kAxes[row] + kAxes[column]] =
          estimate.covariance[3 * row + column];
  }
  return message;
}

nav_msgs::OccupancyGrid toMsg(const OccupancyGrid& grid, const std_msgs::Header& header)
{
  nav_msgs::OccupancyGrid message;
  message.header = header;
  message.info.map_load_time = header.stamp;
  message.info.resolution = static_cast<float>(grid.geometry.resolution_m);
  message.info.width = static_cast<std::uint32_t>(grid.geometry.width);
  message.info.height = static_cast<std::uint32_t>(grid.geometry.height);
  message.info.origin.position = pointMsg(grid.geometry.origin);
  message.info.origin.orientation.w = 1.0;
  message.data.reserve(grid.nodes.size());
  for (const Occupancy node : grid.nodes)
  {
    constexpr std::int8_t kUnknown = -1;
    constexpr std::int8_t kFree = 0;
    constexpr std::int8_t kOccupied = 100;
    message.data.push_back(node == Occupancy::kOccupied ? kOccupied
                           : node == Occupancy::kFree   ? kFree
                                                        : kUnknown);
  }
  return message;
}

nav_msgs::Path toMsg(const std::vector<Point>& path, const std_msgs::Header& header)
{
  nav_msgs::Path message;
  message.header = header;
  for (const Point& point : path)
  {
    geometry_msgs::PoseStamped pose;
    pose.header = header;
    pose.pose.position = pointMsg(point);
    pose.pose.orientation.w = 1.0;
    message.poses.push_back(pose);
  }
  return message;
}

kr3_msgs::CellArray toMsg(const CellMap& map, const std_msgs::Header& header)
{
  kr3_msgs::CellArray message;
  message.header = header;
  for (const Cell& cell : map.cells())
  {
    kr3_msgs::Cell entry;
    entry.name = cell.name;
    entry.room = cell.place;
    entry.center = pointMsg(cell.rectangle.center());
    entry.stand = pointMsg(cell.stand);
    entry.size_x = cell.rectangle.width();
    entry.size_y = cell.rectangle.height();
    for (const std::size_t neighbor : cell.neighbors)
      entry.neighbors.push_back(map.cells()[neighbor].name);
    message.cells.push_back(entry);
  }
  for (std::size_t from = 0; from < map.cells().size(); ++from)
  {
    for (std::size_t to = 0; to < map.cells().size(); ++to)
      message.travel_distance.push_back(map.travelDistance(from, to));
  }
  return message;
}

visualization_msgs::MarkerArray toMarkers(const CellMap& map, const std_msgs::Header& header)
{
  visualization_msgs::MarkerArray message;
  for (std::size_t id = 0; id < map.cells().size(); ++id)
  {
    const Cell& cell = map.cells()[id];
    visualization_msgs::Marker border =
        marker(header, "border", id, visualization_msgs::Marker::LINE_STRIP);
    border.scale.x = 0.03;
    border.color = color(0.2F, 0.4F, 0.9F, 0.8F);
    const Rectangle& r = cell.rectangle;
    for (const Point& corner :
         {Point{r.x_min, r.y_min}, Point{r.x_max, r.y_min}, Point{r.x_max, r.y_max},
          Point{r.x_min, r.y_max}, Point{r.x_min, r.y_min}})
      border.points.push_back(pointMsg(corner, 0.02));
    message.markers.push_back(border);

    visualization_msgs::Marker stand =
        marker(header, "stand", id, visualization_msgs::Marker::SPHERE);
    stand.pose.position = pointMsg(cell.stand, 0.05);
    stand.scale.x = stand.scale.y = stand.scale.z = 0.12;
    stand.color = cell.reachable ? color(0.1F, 0.7F, 0.2F, 0.9F) : color(0.9F, 0.1F, 0.1F, 0.9F);
    message.markers.push_back(stand);

    visualization_msgs::Marker label =
        marker(header, "name", id, visualization_msgs::Marker::TEXT_VIEW_FACING);
    label.pose.position = pointMsg(cell.rectangle.center(), 0.3);
    label.scale.z = 0.2;
    label.color = color(0.1F, 0.1F, 0.1F, 1.0F);
    label.text = cell.name;
    message.markers.push_back(label);
  }
  return message;
}

std_msgs::UInt8MultiArray toMsg(std::vector<std::uint8_t> bytes)
{
  std_msgs::UInt8MultiArray message;
  message.layout.dim.resize(1);
  message.layout.dim[0].label = "bytes";
  message.layout.dim[0].size = static_cast<std::uint32_t>(bytes.size());
  message.layout.dim[0].stride = static_cast<std::uint32_t>(bytes.size());
  message.data = std::move(bytes);
  return message;
}

}  // namespace kr3::navigation
