#pragma once

#include <optional>
#include <vector>

#include "kr3_navigation/occupancy_map.hpp"
#include "kr3_navigation/path_planner.hpp"

namespace kr3::navigation
{

struct LiveMapOptions
{
  double z_min_m = 0.05;  ///< the band of heights in which something is an obstacle
  double z_max_m = 0.60;
  double revision_range_m = 4.0;  ///< of scans that revise a given map
  double mapping_range_m = 8.0;   ///< of scans that build a new one
  /// Of a given map as it is revised and planned in; localisation refers to the finer original.
  double planning_resolution_m = 0.1;
  double contact_radius_m = 0.1;    ///< of the mark where the robot touched something
  double contact_memory_s = 600.0;  ///< after which such a mark is forgotten
  PathPlannerOptions planner;
};

/// The map as the robot knows it now: an OctoMap that every scan revises, and the planner on its
/// present state.
///
/// Started with a given map, it keeps that map's obstacles as the reference for localisation, so
/// that errors of the pose cannot feed back into it. Not thread-safe.
class LiveMap
{
public:
  /// @param given  whether `map` is a finished map to be revised, or a new one to be built
  /// @param area   what the grid covers at least
  LiveMap(OccupancyMap map, bool given, const Rectangle& area, const LiveMapOptions& options);

  /// Takes a scan into account, unless it was taken farther from the area than a scan reaches.
  void insertScan(const LaserScan& scan, const Pose& T_map_laser, double height_m);

  /// Marks where the robot touched something that the laser does not see: occupied in grid and
  /// planner until it is forgotten, though beams pass over it. Ignored outside of the area.
  void addContact(Point p_map, double time_s);
  /// Forgets contacts that are too old; all of them when `now_s` is before one of them, because
  /// the clock started again.
  void forgetOldContacts(double now_s);

  /// Brings grid and planner up to date.
  /// @return whether anything changed since the last call
  /// Cost: a few ms for 40 000 nodes when something changed.
  bool revise();

  /// Returns to the given map, without contacts; scans then show anew what is different. While a
  /// map is built, contacts only are forgotten.
  void forgetRevisions();

  [[nodiscard]] const OccupancyMap& map() const { return map_; }
  [[nodiscard]] const OccupancyGrid& grid() const { return grid_; }
  [[nodiscard]] const PathPlanner& planner() const { return *planner_; }
  /// Whether a finished map is revised, rather than a new one built.
  [[nodiscard]] bool isGiven() const { return given_.has_value(); }
  /// The planner of the given map as it was given; only with isGiven(). Cost: a projection.
  [[nodiscard]] PathPlanner givenPlanner() const;
  /// Distances to the obstacles of the given map; only with isGiven().
  [[nodiscard]] const DistanceField& reference() const { return *reference_; }

private:
  struct Contact
  {
    Point p_map;
    double time_s;
  };

  void project();

  LiveMapOptions options_;
  OccupancyMap map_;
  std::optional<OccupancyMap> given_;
  Rectangle area_;
  OccupancyGrid grid_;
  std::optional<PathPlanner> planner_;
  std::optional<DistanceField> reference_;
  std::vector<Contact> contacts_;
  bool contacts_changed_ = false;
};

}  // namespace kr3::navigation
