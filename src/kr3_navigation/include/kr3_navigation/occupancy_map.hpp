#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "kr3_navigation/laser_scan.hpp"
#include "kr3_navigation/occupancy_grid.hpp"

namespace kr3::navigation
{

struct OccupancyMapOptions
{
  double resolution_m = 0.1;       ///< of a new map; a loaded one keeps its own
  double probability_hit = 0.8;    ///< in (0.5, 1)
  double probability_miss = 0.45;  ///< in (0, 0.5)
};

/// An OctoMap that grows with laser scans.
///
/// OctoMap's own insertion lets grazing beams erase walls; here no node next to a surface that the
/// same scan hits is counted as free. A single beam without a return is a dropout and says nothing.
/// Not thread-safe. Source: Hornung et al., "OctoMap" (Autonomous Robots, 2013), Sec. 3; the two
/// rules are ours.
class OccupancyMap
{
public:
  /// An empty map.
  explicit OccupancyMap(const OccupancyMapOptions& options);

  /// @param path  a binary OctoMap file (`.bt`)
  /// @throws Unavailable      the file cannot be opened
  /// @throws InvalidArgument  it is not a binary OctoMap, or damaged: says where and how
  [[nodiscard]] static OccupancyMap load(const std::filesystem::path& path,
                                         const OccupancyMapOptions& options);

  OccupancyMap(OccupancyMap&&) noexcept;
  OccupancyMap& operator=(OccupancyMap&&) noexcept;
  ~OccupancyMap();

  [[nodiscard]] OccupancyMap copy() const;

  /// The same map with nodes twice as large as often as they stay within `resolution_m`; a node is
  /// occupied where a part of it is, else free where a part of it is.
  /// @throws InvalidArgument  that would be more than 20 million nodes
  [[nodiscard]] OccupancyMap coarsened(double resolution_m) const;

  /// Adds what a scan shows: nodes hit are more likely occupied, nodes passed are more likely free.
  ///
  /// @param T_map_laser  the laser's pose when the scan was taken
  /// @param height_m     of the scan plane
  /// @param max_range_m  beams count as free up to there, and hits beyond it are ignored
  /// @param known        when given, a hit within `known_distance_m` of an obstacle of that field
  /// strengthens occupied
  ///                     nodes only: so a small error of the pose does not thicken known walls
  /// Cost: about 1 ms for 360 beams at 0.1 m.
  void insertScan(const LaserScan& scan, const Pose& T_map_laser, double height_m,
                  double max_range_m, const DistanceField* known = nullptr,
                  double known_distance_m = 0.2);

  /// Whether a node became occupied, free or known since the last call of clearChanges().
  [[nodiscard]] bool hasChanges() const;
  void clearChanges();

  /// The map between two heights, over at least `area`: occupied where any node of the column is,
  /// else free where any is, else unknown.
  /// @throws InvalidArgument  that would be more than 25 million nodes
  [[nodiscard]] OccupancyGrid project(double z_min_m, double z_max_m, const Rectangle& area) const;

  /// What the map knows, seen from above; a rectangle of no size at the origin when that is
  /// nothing.
  [[nodiscard]] Rectangle extent() const;
  [[nodiscard]] double resolution() const;
  [[nodiscard]] std::size_t numLeaves() const;

  /// The maximum likelihood map in the `.bt` format.
  [[nodiscard]] std::vector<std::uint8_t> toBinary() const;

  /// Writes toBinary() to a file, replacing it as a whole.
  /// @throws Unavailable  the file cannot be written
  void save(const std::filesystem::path& path) const;

private:
  struct Impl;
  explicit OccupancyMap(std::unique_ptr<Impl> impl);

  std::unique_ptr<Impl> impl_;
};

}  // namespace kr3::navigation
