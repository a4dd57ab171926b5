#include "kr3_navigation/live_map.hpp"

namespace kr3::navigation
{

LiveMap::LiveMap(OccupancyMap map, bool given, const Rectangle& area, const LiveMapOptions& options)
  : options_(options), map_(std::move(map)), area_(area)
{
  if (given)
  {
    reference_ = distanceField(map_.project(options_.z_min_m, options_.z_max_m, area_));
    map_ = map_.coarsened(options_.planning_resolution_m);
    given_ = map_.copy();
  }
  project();
  map_.clearChanges();
}

void LiveMap::project()
{
  grid_ = map_.project(options_.z_min_m, options_.z_max_m, area_);
  planner_.emplace(grid_, options_.planner);
}

PathPlanner LiveMap::givenPlanner() const
{
  return {given_->project(options_.z_min_m, options_.z_max_m, area_), options_.planner};
}

void LiveMap::insertScan(const LaserScan& scan, const Pose& T_map_laser, double height_m)
{
  // A pose that is far off must not make the map grow without bound.
  if (!area_.shrunk(-options_.mapping_range_m).contains(T_map_laser.position()))
    return;
  if (reference_)
    map_.insertScan(scan, T_map_laser, height_m, options_.revision_range_m, &*reference_);
  else
    map_.insertScan(scan, T_map_laser, height_m, options_.mapping_range_m);
}

void LiveMap::forgetRevisions()
{
  if (!given_)
    return;
  map_ = given_->copy();
  project();
  map_.clearChanges();
}

bool LiveMap::revise()
{
  if (!map_.hasChanges())
    return false;
  project();
  map_.clearChanges();
  return true;
}

}  // namespace kr3::navigation
