#include "kr3_navigation/live_map.hpp"

#include <algorithm>

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
  for (const Contact& contact : contacts_)
  {
    forEachNear(grid_.geometry, contact.p_map, options_.contact_radius_m, [&](int node) {
      grid_.nodes[static_cast<std::size_t>(node)] = Occupancy::kOccupied;
    });
  }
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

void LiveMap::addContact(Point p_map, double time_s)
{
  if (!area_.contains(p_map))
    return;
  contacts_.push_back({p_map, time_s});
  contacts_changed_ = true;
}

void LiveMap::forgetOldContacts(double now_s)
{
  const auto is_old = [&](const Contact& contact) {
    return now_s < contact.time_s || now_s - contact.time_s > options_.contact_memory_s;
  };
  const auto end = std::remove_if(contacts_.begin(), contacts_.end(), is_old);
  contacts_changed_ = contacts_changed_ || end != contacts_.end();
  contacts_.erase(end, contacts_.end());
}

void LiveMap::forgetRevisions()
{
  contacts_.clear();
  if (given_)
    map_ = given_->copy();
  project();
  map_.clearChanges();
  contacts_changed_ = false;
}

bool LiveMap::revise()
{
  if (!map_.hasChanges() && !contacts_changed_)
    return false;
  project();
  map_.clearChanges();
  contacts_changed_ = false;
  return true;
}

}  // namespace kr3::navigation
