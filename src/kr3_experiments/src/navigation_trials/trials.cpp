#include "trials.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <random>
#include <utility>

#include <kr3_common/error.hpp>
#include <kr3_navigation/movable_nodes.hpp>

namespace kr3::experiments
{
namespace
{

using namespace navigation;

constexpr double kGridMargin = 0.2;      // m around the places
constexpr double kRobotClearance = 0.4;  // m to walls and furniture where a robot starts
constexpr double kFurnitureGap = 0.15;   // m between moved pieces of furniture
constexpr double kDoorway = 0.9;         // m around a door that stay free of furniture
// m: what planning asks for (0.28), and as much again as half a node of the closer look's grid.
constexpr double kSureClearance = 0.32;
constexpr double kWarmUp = 0.5;  // s of standing before a drive
constexpr int kDraws = 50;
// A robot that maps on its own says where the frame is.
constexpr PoseSpread kFrameSpread{0.005, 0.002};

double uniform(std::mt19937_64& random, double low, double high)
{
  return std::uniform_real_distribution<double>(low, high)(random);
}

double cpuSeconds()
{
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// The rectangle around a box that stands at an angle.
sim::Rectangle footprint(const sim::Furniture& piece)
{
  const double c = std::abs(std::cos(piece.pose.yaw));
  const double s = std::abs(std::sin(piece.pose.yaw));
  const double half_x = (c * piece.size.x + s * piece.size.y) / 2.0;
  const double half_y = (s * piece.size.x + c * piece.size.y) / 2.0;
  return {piece.pose.x - half_x, piece.pose.y - half_y, piece.pose.x + half_x,
          piece.pose.y + half_y};
}

bool near(const sim::Rectangle& a, const sim::Rectangle& b, double gap_m)
{
  return a.x0 < b.x1 + gap_m && b.x0 < a.x1 + gap_m && a.y0 < b.y1 + gap_m && b.y0 < a.y1 + gap_m;
}

bool fits(const sim::Building& building, std::size_t number)
{
  const sim::Furniture& piece = building.furniture[number];
  const sim::Rectangle& room = building.place(piece.place).rectangle;
  const sim::Rectangle box = footprint(piece);
  const double wall = building.wall_thickness_m / 2.0;
  if (box.x0 < room.x0 + wall || box.x1 > room.x1 - wall || box.y0 < room.y0 + wall ||
      box.y1 > room.y1 - wall)
    return false;
  for (std::size_t other = 0; other < building.furniture.size(); ++other)
  {
    if (other != number && near(box, footprint(building.furniture[other]), kFurnitureGap))
      return false;
  }
  return std::none_of(building.doors.begin(), building.doors.end(), [&](const sim::Door& door) {
    return near(box, {door.x, door.y, door.x, door.y}, kDoorway);
  });
}

void moveFurniture(sim::Building& building, const DriveTrialOptions& options,
                   std::mt19937_64& random)
{
  for (std::size_t number = 0; number < building.furniture.size(); ++number)
  {
    const sim::Pose2 before = building.furniture[number].pose;
    if (uniform(random, 0.0, 1.0) >= options.moved_furniture)
      continue;
    for (int draw = 0; draw < kDraws; ++draw)
    {
      sim::Pose2& pose = building.furniture[number].pose;
      pose.x = before.x + uniform(random, -options.furniture_shift_m, options.furniture_shift_m);
      pose.y = before.y + uniform(random, -options.furniture_shift_m, options.furniture_shift_m);
      if (fits(building, number))
        break;
      pose = before;
    }
  }
}

void shutDoors(sim::Building& building, double share, std::mt19937_64& random)
{
  std::vector<sim::Door> open;
  for (const sim::Door& door : building.doors)
  {
    if (uniform(random, 0.0, 1.0) >= share)
      open.push_back(door);
  }
  building.doors = open;
}

/// Whether doors connect two places.
bool connected(const sim::Building& building, const std::string& from, const std::string& to)
{
  std::vector<std::string> reached{from};
  for (std::size_t i = 0; i < reached.size(); ++i)
  {
    for (const sim::Door& door : building.doors)
    {
      for (const auto& [here, there] :
           {std::pair{door.place_a, door.place_b}, std::pair{door.place_b, door.place_a}})
      {
        if (here == reached[i] && std::find(reached.begin(), reached.end(), there) == reached.end())
          reached.push_back(there);
      }
    }
  }
  return std::find(reached.begin(), reached.end(), to) != reached.end();
}

/// Whether furniture leaves a way into the cell along which the robot's centre stays
/// kSureClearance from everything: by the building itself, not by what the robot knows.
bool wayIsWide(const sim::Building& building, const Rectangle& area, Point from, const Cell& to)
{
  const sim::Obstacles obstacles(building);
  OccupancyGrid grid;
  constexpr double kResolution = 0.05;
  grid.geometry = {kResolution,
                   {area.x_min, area.y_min},
                   static_cast<int>(std::ceil(area.width() / kResolution)),
                   static_cast<int>(std::ceil(area.height() / kResolution))};
  grid.nodes.assign(grid.geometry.size(), Occupancy::kFree);
  for (std::size_t node = 0; node < grid.nodes.size(); ++node)
  {
    const Point p = grid.geometry.center(static_cast<int>(node));
    if (obstacles.clearance(p.x, p.y, 2.0 * kSureClearance) < kSureClearance)
      grid.nodes[node] = Occupancy::kOccupied;
  }
  PathPlannerOptions options;
  options.inflation_radius_m = kResolution / 2.0;  // the clearance is in the grid already
  const PathPlanner planner(grid, options);
  const std::vector<double> lengths = planner.distancesFrom(from);
  for (std::size_t node = 0; node < lengths.size(); ++node)
  {
    if (std::isfinite(lengths[node]) &&
        to.rectangle.contains(grid.geometry.center(static_cast<int>(node))))
      return true;
  }
  return false;
}

/// Where the robot starts in a cell: its stand point, or near it where something stands.
Point startIn(const Cell& cell, const sim::Building& building, std::mt19937_64& random)
{
  const sim::Obstacles obstacles(building);
  Point start = cell.stand;
  for (int draw = 0; draw < kDraws; ++draw)
  {
    if (obstacles.clearance(start.x, start.y, 2.0 * kRobotClearance) >= kRobotClearance)
      return start;
    start = {uniform(random, cell.rectangle.x_min, cell.rectangle.x_max),
             uniform(random, cell.rectangle.y_min, cell.rectangle.y_max)};
  }
  throw FailedPrecondition("no free floor in the cell " + cell.name);
}

sim::Scenario scenarioOf(const Site& site, const RobotOptions& options, std::uint64_t seed)
{
  sim::Scenario scenario;
  scenario.building = site.building;
  scenario.models = site.models;
  scenario.world = options.world;
  scenario.world.seed = seed;
  return scenario;
}

}  // namespace

Site loadSite(const std::filesystem::path& building, const std::filesystem::path& objects)
{
  const std::vector<Place> places = loadPlaces(building);
  return {sim::loadBuilding(building.string()), sim::loadObjectModels(objects.string()), places,
          loadDoors(building, places)};
}

MappingReport buildMap(const Site& site, const RobotOptions& options, bool own_poses,
                       std::uint64_t seed)
{
  LiveMapOptions live = options.live_map;
  live.planner.unknown_is_free = true;
  LiveMap map(OccupancyMap(options.occupancy), false, areaOf(site.places, kGridMargin), live);
  const CellMap cells(site.places, options.cells, map.planner());
  const sim::Pose2& start = site.building.robot_start;
  std::optional<ParticleFilter> filter;
  if (own_poses)
    filter.emplace(map.planner().field(), options.filter, seed);
  SimulatedRobot robot(
      scenarioOf(site, options, seed),
      Navigator(std::move(map),
                PoseTracker(std::move(filter), {start.x, start.y, start.yaw}, kFrameSpread), {}),
      options.driver, options.cells, site.places, site.doors);
  if (!own_poses)
    robot.useKnownPoses();

  MappingReport report{OccupancyMap(options.occupancy), cells.cells().size(), {}, 0, 0.0, {}};
  std::vector<std::size_t> left(cells.cells().size());
  for (std::size_t cell = 0; cell < left.size(); ++cell)
    left[cell] = cell;
  std::vector<std::size_t> retried;
  robot.wait(kWarmUp);
  while (!left.empty())
  {
    const std::vector<double> lengths = robot.navigator().map().planner().distancesFrom(
        robot.navigator().tracker().pose().position());
    const GridGeometry& grid = robot.navigator().map().grid().geometry;
    const auto nearest =
        std::min_element(left.begin(), left.end(), [&](std::size_t a, std::size_t b) {
          const auto way = [&](std::size_t cell) {
            return lengths[static_cast<std::size_t>(grid.index(cells.cells()[cell].stand))];
          };
          return way(a) < way(b);
        });
    const std::size_t cell = *nearest;
    left.erase(nearest);
    const DriveReport drive = robot.driveTo(cells.cells()[cell], 120.0);
    report.contacts += drive.contacts;
    report.errors.add(drive.errors);
    if (drive.arrived)
      continue;
    if (std::count(retried.begin(), retried.end(), cell) > 0)
    {
      report.missed.push_back(cells.cells()[cell].name);
      continue;
    }
    retried.push_back(cell);
    left.push_back(cell);  // once more, when more of the building is known
  }
  report.time_s = robot.time();
  report.map = robot.navigator().map().map().copy();
  return report;
}

ScanCosts measureScanCosts(const Site& site, const OccupancyMap& map, const RobotOptions& options,
                           int num_scans, std::uint64_t seed)
{
  const LiveMap live_map(map.copy(), true, areaOf(site.places, kGridMargin), options.live_map);
  const std::unique_ptr<sim::World> world = sim::makeWorld(scenarioOf(site, options, seed));
  OccupancyMap growing(options.occupancy);
  ParticleFilter filter(live_map.reference(), options.filter, seed,
                        movableNodes(live_map.reference(), site.places));
  std::mt19937_64 random(seed);
  ScanCosts costs;
  for (int number = 0; number < num_scans; ++number)
  {
    const std::string& place = site.places[random() % site.places.size()].name;
    const sim::Pose2 pose = sim::freeFloorPose(site.building, place, kRobotClearance, random);
    world->setRobotPose(pose);
    const std::vector<double> ranges = world->scan();
    const LaserScan scan{-M_PI,
                         2.0 * M_PI / static_cast<double>(ranges.size()),
                         options.world.laser.min_range_m,
                         options.world.laser.max_range_m,
                         {ranges.begin(), ranges.end()}};
    const Pose truth{pose.x, pose.y, pose.yaw};
    double start_s = cpuSeconds();
    growing.insertScan(scan, truth, options.world.robot.T_base_laser.position.z,
                       options.live_map.mapping_range_m);
    costs.insertion_ms.push_back(1e3 * (cpuSeconds() - start_s));
    filter.reset(truth, PoseSpread{});
    start_s = cpuSeconds();
    filter.predict({0.05, 0.0, 0.02});
    filter.update(scan, Pose{});
    costs.localisation_ms.push_back(1e3 * (cpuSeconds() - start_s));
  }
  return costs;
}

bool DriveTrial::succeeded() const
{
  if (report.contacts > 0)
    return false;
  if (possible)
    return report.arrived && report.in_cell;
  return !report.arrived && (doors_open ? !report.reason.empty()
                                        : report.reason.find("door between") != std::string::npos);
}

double shortestLength(const OccupancyGrid& grid, const PathPlannerOptions& options, Point from,
                      Point to)
{
  PathPlannerOptions shortest = options;
  shortest.clearance_weight = 0.0;
  const PathPlanner planner(grid, shortest);
  const PlannedPath path = planner.plan(from, to);
  if (!path.found())
    return std::numeric_limits<double>::infinity();
  double length_m = 0.0;
  for (std::size_t here = 0; here + 1 < path.points.size();)
  {
    std::size_t next = path.points.size() - 1;
    while (next > here + 1 && !planner.isSegmentFree(path.points[here], path.points[next]))
      --next;
    length_m += distance(path.points[here], path.points[next]);
    here = next;
  }
  return length_m;
}

DriveTrial driveTrial(const Site& site, const OccupancyMap& map, const RobotOptions& robot_options,
                      const DriveTrialOptions& options, int run)
{
  const double begin_s = cpuSeconds();
  const std::uint64_t seed = options.seed * 1000003 + static_cast<std::uint64_t>(run);
  std::mt19937_64 random(seed);
  LiveMap live_map(map.copy(), true, areaOf(site.places, kGridMargin), robot_options.live_map);
  const CellMap cells(site.places, robot_options.cells, live_map.planner());
  std::vector<std::size_t> reachable;
  for (std::size_t cell = 0; cell < cells.cells().size(); ++cell)
  {
    if (cells.cells()[cell].reachable)
      reachable.push_back(cell);
  }
  if (reachable.size() < 2)
    throw FailedPrecondition("fewer than two cells of the map can be reached");
  std::shuffle(reachable.begin(), reachable.end(), random);
  const Cell& from = cells.cells()[reachable[0]];
  const Cell& to = cells.cells()[reachable[1]];

  Site today = site;
  moveFurniture(today.building, options, random);
  shutDoors(today.building, options.shut_doors, random);
  const Point start = startIn(from, today.building, random);
  const double yaw = uniform(random, -M_PI, M_PI);
  today.building.robot_start = {start.x, start.y, yaw};
  const double direction = uniform(random, -M_PI, M_PI);
  const double turn =
      uniform(random, 0.0, 1.0) < 0.5 ? -options.initial_error_rad : options.initial_error_rad;
  const Pose believed{start.x + options.initial_error_m * std::cos(direction),
                      start.y + options.initial_error_m * std::sin(direction),
                      wrapAngle(yaw + turn)};

  DriveTrial trial;
  trial.run = run;
  trial.from = from.name;
  trial.to = to.name;
  trial.doors_open = connected(today.building, from.place, to.place);
  trial.shortest_m =
      shortestLength(live_map.grid(), robot_options.live_map.planner, start, to.stand);
  trial.shortest_s = trial.shortest_m / robot_options.driver.limits.max_linear;

  ParticleFilter filter(live_map.reference(), robot_options.filter, seed,
                        movableNodes(live_map.reference(), site.places));
  SimulatedRobot robot(scenarioOf(today, robot_options, seed),
                       Navigator(std::move(live_map), PoseTracker(std::move(filter), believed), {}),
                       robot_options.driver, robot_options.cells, site.places, site.doors);
  robot.wait(kWarmUp);
  trial.report = robot.driveTo(to, options.time_limit_s);
  trial.possible =
      trial.report.arrived ||
      (trial.doors_open && wayIsWide(today.building, areaOf(site.places, kGridMargin), start, to));
  trial.navigation_cpu_s = robot.navigationCpu();
  trial.simulator_cpu_s = cpuSeconds() - begin_s - trial.navigation_cpu_s;
  return trial;
}

}  // namespace kr3::experiments
