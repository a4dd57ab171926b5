// Measures mapping, localisation and driving in the simulated building, in one process and without
// ROS.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "trials.hpp"

namespace
{

using namespace kr3;
using namespace kr3::experiments;

struct Arguments
{
  std::string building;
  std::string objects;
  std::string map;
  std::string json;
  std::uint64_t seed = 1;
  int runs = 200;
  int first = 0;
  bool own_poses = false;
  bool verbose = false;
  DriveTrialOptions trial;
  RobotOptions robot;
};

void write(const std::string& path, const nlohmann::json& json)
{
  if (path.empty())
    return;
  std::ofstream file(path);
  file << json.dump(1) << '\n';
  file.close();
  if (!file)
    throw std::runtime_error("cannot write " + path);
}

double mean(double sum, long count)
{
  return count > 0 ? sum / static_cast<double>(count) : 0.0;
}

double median(std::vector<double> values)
{
  std::sort(values.begin(), values.end());
  return values.empty() ? 0.0 : values[values.size() / 2];
}

nlohmann::json toJson(const PoseErrors& errors)
{
  return {{"scans", errors.scans},
          {"mean_m", mean(errors.sum_m, errors.scans)},
          {"max_m", errors.max_m},
          {"mean_yaw_rad", mean(errors.sum_yaw_rad, errors.scans)},
          {"max_yaw_rad", errors.max_yaw_rad},
          {"mean_deviation_m", mean(errors.sum_deviation_m, errors.scans)},
          {"normalised_squared_error", mean(errors.sum_squared_normalised, errors.scans)}};
}

int runMap(const Arguments& arguments)
{
  const Site site = loadSite(arguments.building, arguments.objects);
  const MappingReport report = buildMap(site, arguments.robot, arguments.own_poses, arguments.seed);
  report.map.save(arguments.map);
  std::printf("%zu of %zu cells visited in %.0f s, %u contacts, %zu leaves; saved %s\n",
              report.cells - report.missed.size(), report.cells, report.time_s, report.contacts,
              report.map.numLeaves(), arguments.map.c_str());
  for (const std::string& cell : report.missed)
    std::printf("  not reached: %s\n", cell.c_str());
  if (arguments.own_poses)
    std::printf("own poses: error %.1f cm mean, %.1f cm maximum\n",
                100.0 * mean(report.errors.sum_m, report.errors.scans),
                100.0 * report.errors.max_m);
  write(arguments.json, {{"cells", report.cells},
                         {"missed", report.missed},
                         {"contacts", report.contacts},
                         {"time_s", report.time_s},
                         {"errors", toJson(report.errors)}});
  return report.missed.empty() ? EXIT_SUCCESS : EXIT_FAILURE;
}

void print(const DriveTrial& trial)
{
  const DriveReport& report = trial.report;
  std::printf(
      "  run %d: %s -> %s: %s, %.0f s (straight %.0f s), %u contacts, pose error %.1f/%.1f cm"
      ", %d plans%s%s\n",
      trial.run, trial.from.c_str(), trial.to.c_str(),
      !report.arrived  ? "not arrived"
      : report.in_cell ? "arrived"
                       : "in another cell",
      report.time_s, trial.shortest_s, report.contacts,
      100.0 * mean(report.errors.sum_m, report.errors.scans), 100.0 * report.errors.max_m,
      report.plans, report.reason.empty() ? "" : ": ", report.reason.c_str());
  std::fflush(stdout);
}

int runDrives(Arguments& arguments)
{
  const Site site = loadSite(arguments.building, arguments.objects);
  const auto map = navigation::OccupancyMap::load(arguments.map, arguments.robot.occupancy);
  arguments.trial.seed = arguments.seed;
  PoseErrors errors;
  int succeeded = 0;
  int refused = 0;
  std::uint32_t contacts = 0;
  double simulated_s = 0.0;
  double simulator_cpu_s = 0.0;
  double navigation_cpu_s = 0.0;
  std::vector<double> ratios;
  nlohmann::json failures = nlohmann::json::array();
  for (int run = arguments.first; run < arguments.first + arguments.runs; ++run)
  {
    const DriveTrial trial = driveTrial(site, map, arguments.robot, arguments.trial, run);
    errors.add(trial.report.errors);
    contacts += trial.report.contacts;
    simulated_s += trial.report.time_s;
    simulator_cpu_s += trial.simulator_cpu_s;
    navigation_cpu_s += trial.navigation_cpu_s;
    if (trial.succeeded())
    {
      ++succeeded;
      refused += trial.report.arrived ? 0 : 1;
    }
    else
      failures.push_back({{"run", run},
                          {"from", trial.from},
                          {"to", trial.to},
                          {"reason", trial.report.reason},
                          {"contacts", trial.report.contacts}});
    if (trial.report.arrived && trial.shortest_s > 0.0)
      ratios.push_back(trial.report.time_s / trial.shortest_s);
    if (arguments.verbose || !trial.succeeded())
      print(trial);
  }
  std::printf("%d of %d drives as they should be (%d rightly refused), %u contacts\n", succeeded,
              arguments.runs, refused, contacts);
  std::printf("pose error %.2f cm mean, %.1f cm maximum; heading %.2f deg mean, %.1f deg maximum\n",
              100.0 * mean(errors.sum_m, errors.scans), 100.0 * errors.max_m,
              mean(errors.sum_yaw_rad, errors.scans) * 180.0 / M_PI,
              errors.max_yaw_rad * 180.0 / M_PI);
  std::printf("stated deviation %.2f cm, normalised squared error %.2f (2 = honest)\n",
              100.0 * mean(errors.sum_deviation_m, errors.scans),
              mean(errors.sum_squared_normalised, errors.scans));
  std::printf("time against the straight optimum: median %.2f\n", median(ratios));
  std::printf(
      "%.0f simulated s; CPU: simulator %.1f s, navigation %.1f s (%.2f ms a scan, all "
      "included)\n",
      simulated_s, simulator_cpu_s, navigation_cpu_s, 1e3 * mean(navigation_cpu_s, errors.scans));
  write(arguments.json, {{"runs", arguments.runs},
                         {"succeeded", succeeded},
                         {"rightly_refused", refused},
                         {"contacts", contacts},
                         {"errors", toJson(errors)},
                         {"time_ratio_median", median(ratios)},
                         {"simulated_s", simulated_s},
                         {"simulator_cpu_s", simulator_cpu_s},
                         {"navigation_cpu_s", navigation_cpu_s},
                         {"failures", failures}});
  return succeeded == arguments.runs ? EXIT_SUCCESS : EXIT_FAILURE;
}

int runCosts(const Arguments& arguments)
{
  const Site site = loadSite(arguments.building, arguments.objects);
  const auto map = navigation::OccupancyMap::load(arguments.map, arguments.robot.occupancy);
  const ScanCosts costs =
      measureScanCosts(site, map, arguments.robot, arguments.runs, arguments.seed);
  std::printf("CPU per scan, median of %d: insertion %.3f ms, localisation %.3f ms\n",
              arguments.runs, median(costs.insertion_ms), median(costs.localisation_ms));
  write(arguments.json, {{"insertion_ms", median(costs.insertion_ms)},
                         {"localisation_ms", median(costs.localisation_ms)}});
  return EXIT_SUCCESS;
}

void addCommon(CLI::App& command, Arguments& arguments)
{
  command.add_option("building", arguments.building, "building file (YAML)")->required();
  command.add_option("objects", arguments.objects, "object models (YAML)")->required();
  command.add_option("map", arguments.map, "OctoMap file (.bt)")->required();
  command.add_option("--seed", arguments.seed, "of everything random");
  command.add_option("--json", arguments.json, "write the figures there");
  command.add_option("--laser-dropout", arguments.robot.world.laser.dropout_rate,
                     "share of beams that return nothing");
  command.add_option("--laser-noise", arguments.robot.world.laser.noise_stddev_m, "m");
  command.add_option("--odometry-slip", arguments.robot.world.odometry.slip_stddev, "relative");
  command.add_option("--odometry-radius", arguments.robot.world.odometry.radius_stddev,
                     "relative error of the wheels");
  command.add_option("--odometry-track", arguments.robot.world.odometry.track_stddev,
                     "relative error of the track");
  command.add_option("--resolution", arguments.robot.occupancy.resolution_m, "of a new map, m");
  command.add_option("--beam-step", arguments.robot.filter.beam_step, "of the filter");
  command.add_option("--hit-sigma", arguments.robot.filter.hit_sigma_m, "of the filter, m");
  command.add_option("--random-hit", arguments.robot.filter.random_hit, "of the filter");
  command.add_option("--likelihood-power", arguments.robot.filter.likelihood_power,
                     "of the filter");
  command.add_option("--particles", arguments.robot.filter.num_particles, "of the filter");
}

}  // namespace

int main(int argc, char** argv)
{
  Arguments arguments;
  CLI::App app{"Measure mapping, localisation and driving in the simulated building, without ROS."};
  app.require_subcommand(1);
  CLI::App* map = app.add_subcommand("map", "drive through every cell and write the map");
  addCommon(*map, arguments);
  map->add_flag("--own-poses", arguments.own_poses, "localise in the growing map");
  CLI::App* costs = app.add_subcommand("costs", "time what is done with every scan");
  addCommon(*costs, arguments);
  costs->add_option("--runs", arguments.runs, "number of scans")->check(CLI::PositiveNumber);
  CLI::App* drive = app.add_subcommand("drive", "drive from cells to others, drawn by the seed");
  addCommon(*drive, arguments);
  drive->add_option("--runs", arguments.runs, "number of drives")->check(CLI::PositiveNumber);
  drive->add_option("--first", arguments.first, "number of the first")
      ->check(CLI::NonNegativeNumber);
  drive->add_option("--moved-furniture", arguments.trial.moved_furniture, "share that is moved")
      ->check(CLI::Range(0.0, 1.0));
  drive->add_option("--shift", arguments.trial.furniture_shift_m, "of moved furniture, m");
  drive->add_option("--shut-doors", arguments.trial.shut_doors, "share of the doors")
      ->check(CLI::Range(0.0, 1.0));
  drive->add_option("--initial-error", arguments.trial.initial_error_m, "of the first pose, m");
  drive->add_option("--initial-turn", arguments.trial.initial_error_rad, "of the first pose, rad");
  drive->add_option("--time-limit", arguments.trial.time_limit_s, "of a drive, simulated s");
  drive->add_flag("-v,--verbose", arguments.verbose, "a line for each drive");
  CLI11_PARSE(app, argc, argv);
  try
  {
    if (map->parsed())
      return runMap(arguments);
    return drive->parsed() ? runDrives(arguments) : runCosts(arguments);
  }
  catch (const std::exception& e)
  {
    std::cerr << "navigation_trials: " << e.what() << '\n';
    return EXIT_FAILURE;
  }
}
