#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "simulated_robot.hpp"

namespace kr3::experiments
{

/// A building as simulator and navigation read it, with the objects that may stand in it.
struct Site
{
  sim::Building building;
  std::vector<sim::ObjectModel> models;
  std::vector<navigation::Place> places;
  std::vector<navigation::Door> doors;
};

/// @throws Unavailable, InvalidArgument  a file is missing or malformed
[[nodiscard]] Site loadSite(const std::filesystem::path& building,
                            const std::filesystem::path& objects);

/// What every robot of these trials is like.
struct RobotOptions
{
  navigation::DriverOptions driver;
  navigation::CellOptions cells;
  navigation::LiveMapOptions live_map;
  navigation::OccupancyMapOptions occupancy;
  navigation::ParticleFilterOptions filter;
  sim::WorldConfig world;
};

struct MappingReport
{
  navigation::OccupancyMap map;
  std::size_t cells = 0;
  std::vector<std::string> missed;  ///< cells not reached
  std::uint32_t contacts = 0;
  double time_s = 0.0;  ///< simulated
  PoseErrors errors;    ///< 0 with known poses
};

/// Drives a robot through every cell of a building it does not know, nearest unvisited cell first.
/// @param own_poses  localises in the growing map; otherwise the simulator tells the poses
[[nodiscard]] MappingReport buildMap(const Site& site, const RobotOptions& options, bool own_poses,
                                     std::uint64_t seed);

struct DriveTrialOptions
{
  std::uint64_t seed = 1;
  double moved_furniture = 0.0;    ///< share of the furniture that is moved, [0, 1]
  double furniture_shift_m = 0.6;  ///< at most, along x and y
  double shut_doors = 0.0;         ///< share of the doors that are shut, [0, 1]
  double initial_error_m = 0.0;    ///< of the first pose, in a random direction
  double initial_error_rad = 0.0;  ///< either way
  double time_limit_s = 300.0;     ///< simulated
};

/// One drive from a cell to another.
struct DriveTrial
{
  int run = 0;
  std::string from;
  std::string to;
  bool doors_open = true;   ///< no shut door keeps the goal apart from the start
  bool possible = true;     ///< it arrived, or furniture leaves a way of 0.64 m into the cell
  double shortest_m = 0.0;  ///< the shortest way in the empty building
  double shortest_s = 0.0;  ///< and its time at full speed
  double simulator_cpu_s = 0.0;
  double navigation_cpu_s = 0.0;
  DriveReport report;

  /// Arrived where the truth says so too, without contact; or said why not when every way is
  /// narrower than 0.64 m, naming a door when shut ones are the reason.
  [[nodiscard]] bool succeeded() const;
};

/// Run number `run` of a seed: a pure function of its arguments. Start, goal, furniture, doors and
/// noise are drawn.
/// @throws FailedPrecondition  no two cells of the map can be reached
[[nodiscard]] DriveTrial driveTrial(const Site& site, const navigation::OccupancyMap& map,
                                    const RobotOptions& robot, const DriveTrialOptions& options,
                                    int run);

/// CPU time of the parts of navigation that run at every scan, ms, one entry for each scan.
struct ScanCosts
{
  std::vector<double> insertion_ms;     ///< into an empty map that grows
  std::vector<double> localisation_ms;  ///< prediction, update and summary of the filter
};

/// Takes `num_scans` scans at random free points of the building and times what is done with them.
[[nodiscard]] ScanCosts measureScanCosts(const Site& site, const navigation::OccupancyMap& map,
                                         const RobotOptions& options, int num_scans,
                                         std::uint64_t seed);

/// Length of the shortest way for the robot's centre, cut straight where that is free; +inf when
/// there is none.
[[nodiscard]] double shortestLength(const navigation::OccupancyGrid& grid,
                                    const navigation::PathPlannerOptions& options,
                                    navigation::Point from, navigation::Point to);

}  // namespace kr3::experiments
