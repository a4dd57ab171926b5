#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <kr3_navigation/cells.hpp>
#include <kr3_navigation/navigator.hpp>
#include <kr3_sim_ode/scenario.hpp>

namespace kr3::experiments
{

/// How well the robot knew where it was, over the scans of a drive.
struct PoseErrors
{
  long scans = 0;
  double sum_m = 0.0;
  double max_m = 0.0;
  double sum_yaw_rad = 0.0;
  double max_yaw_rad = 0.0;
  double sum_deviation_m = 0.0;  ///< of the standard deviation that the filter states
  /// Sum of e' S^-1 e of the position's error e and its covariance S: 2 per scan on average when
  /// the covariance is honest, more when it is too small (normalised estimation error squared).
  double sum_squared_normalised = 0.0;

  void add(const navigation::PoseEstimate& estimate, const navigation::Pose& truth);
  void add(const PoseErrors& other);
};

/// What came of a drive.
struct DriveReport
{
  bool arrived = false;      ///< the driver says so
  bool in_cell = false;      ///< the truth says so
  std::string reason;        ///< why the driver gave up; empty otherwise
  double time_s = 0.0;       ///< simulated
  double length_m = 0.0;     ///< driven
  double end_error_m = 0.0;  ///< of the true position from where it wanted to stand
  std::uint32_t contacts = 0;
  int plans = 0;
  PoseErrors errors;
};

/// Robot, building and navigation in one process, without ROS: the rates are those of sim_node and
/// navigation_node. The same arguments and calls give the same results. Not thread-safe.
class SimulatedRobot
{
public:
  /// @param places, doors  name what blocks the way
  SimulatedRobot(const sim::Scenario& scenario, navigation::Navigator navigator,
                 const navigation::DriverOptions& driver, const navigation::CellOptions& cells,
                 std::vector<navigation::Place> places, std::vector<navigation::Door> doors);

  /// Lets time pass; the robot stands.
  void wait(double time_s);

  /// Drives to a cell.
  DriveReport driveTo(const navigation::Cell& cell, double time_limit_s);

  [[nodiscard]] navigation::Pose truth() const;
  [[nodiscard]] navigation::Navigator& navigator() { return navigator_; }
  [[nodiscard]] double time() const;
  /// CPU seconds that navigation took, without the simulator.
  [[nodiscard]] double navigationCpu() const { return navigation_cpu_s_; }
  [[nodiscard]] const PoseErrors& errors() const { return errors_; }

  /// Poses come from the simulator instead of localisation, for a Navigator without a filter.
  void useKnownPoses() { known_poses_ = true; }

private:
  /// One tick of odometry, with a scan every fifth.
  void tick();
  void sense();

  sim::Scenario scenario_;
  std::unique_ptr<sim::World> world_;
  navigation::Navigator navigator_;
  navigation::Driver driver_;
  navigation::CellOptions cell_options_;
  std::vector<navigation::Place> places_;
  std::vector<navigation::Door> doors_;
  std::optional<navigation::Cell> target_;
  PoseErrors errors_;
  bool known_poses_ = false;
  long ticks_ = 0;
  double navigation_cpu_s_ = 0.0;
};

}  // namespace kr3::experiments
