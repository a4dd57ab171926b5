#include <algorithm>
#include <cmath>

#include "kr3_sim_ode/placement.hpp"

namespace kr3::sim
{

namespace
{
/// The radius of the circle around the box's footprint.
double footprintRadius(const Box& box)
{
  return std::hypot(box.size.x, box.size.y) / 2.0;
}

/// The axis-parallel rectangle around the box's footprint.
Rectangle boundsOf(const Box& box)
{
  const double c = std::abs(std::cos(box.yaw));
  const double s = std::abs(std::sin(box.yaw));
  const double half_x = (c * box.size.x + s * box.size.y) / 2.0;
  const double half_y = (s * box.size.x + c * box.size.y) / 2.0;
  return {box.center.x - half_x, box.center.y - half_y, box.center.x + half_x,
          box.center.y + half_y};
}
}  // namespace

Obstacles::Obstacles(const Building& building)
  : boxes_(wallsOf(building)), extent_(building.extent())
{
  for (const Furniture& furniture : building.furniture)
  {
    boxes_.push_back(furniture.box());
  }
  columns_ = static_cast<int>((extent_.x1 - extent_.x0) / kBucket) + 1;
  rows_ = static_cast<int>((extent_.y1 - extent_.y0) / kBucket) + 1;
  buckets_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
  const auto clamped = [](double value, int count) {
    return std::clamp(static_cast<int>(std::floor(value / kBucket)), 0, count - 1);
  };
  for (std::uint32_t i = 0; i < boxes_.size(); ++i)
  {
    const Rectangle bounds = boundsOf(boxes_[i]);
    for (int row = clamped(bounds.y0 - extent_.y0, rows_);
         row <= clamped(bounds.y1 - extent_.y0, rows_); ++row)
    {
      for (int column = clamped(bounds.x0 - extent_.x0, columns_);
           column <= clamped(bounds.x1 - extent_.x0, columns_); ++column)
      {
        buckets_[static_cast<std::size_t>(row * columns_ + column)].push_back(i);
      }
    }
  }
}

double Obstacles::clearance(double x, double y, double limit_m) const
{
  const auto clamped = [](double value, int count) {
    return std::clamp(static_cast<int>(std::floor(value / kBucket)), 0, count - 1);
  };
  double clearance = limit_m;
  for (int row = clamped(y - limit_m - extent_.y0, rows_);
       row <= clamped(y + limit_m - extent_.y0, rows_); ++row)
  {
    for (int column = clamped(x - limit_m - extent_.x0, columns_);
         column <= clamped(x + limit_m - extent_.x0, columns_); ++column)
    {
      for (const std::uint32_t i : buckets_[static_cast<std::size_t>(row * columns_ + column)])
      {
        const Box& box = boxes_[i];
        if (std::hypot(box.center.x - x, box.center.y - y) - footprintRadius(box) < clearance)
        {
          clearance = std::min(clearance, planarDistance(box, x, y));
        }
      }
    }
  }
  return clearance;
}

}  // namespace kr3::sim
