#include "simulated_robot.hpp"

#include <cmath>
#include <ctime>
#include <utility>

namespace kr3::experiments
{
namespace
{

using navigation::Pose;
using navigation::Velocity;

constexpr double kOdometryPeriod = 0.02;  // s
constexpr int kTicksPerScan = 5;

double cpuSeconds()
{
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

void PoseErrors::add(const navigation::PoseEstimate& estimate, const Pose& truth)
{
  const double dx = estimate.mean.x - truth.x;
  const double dy = estimate.mean.y - truth.y;
  const double error_m = std::hypot(dx, dy);
  const double yaw_rad = std::abs(navigation::wrapAngle(estimate.mean.yaw - truth.yaw));
  ++scans;
  sum_m += error_m;
  max_m = std::max(max_m, error_m);
  sum_yaw_rad += yaw_rad;
  max_yaw_rad = std::max(max_yaw_rad, yaw_rad);
  const double xx = estimate.covariance[0];
  const double xy = estimate.covariance[1];
  const double yy = estimate.covariance[4];
  sum_deviation_m += std::sqrt(xx + yy);
  const double determinant = xx * yy - xy * xy;
  if (determinant > 0.0)
    sum_squared_normalised += (dx * dx * yy - 2.0 * dx * dy * xy + dy * dy * xx) / determinant;
}

void PoseErrors::add(const PoseErrors& other)
{
  scans += other.scans;
  sum_m += other.sum_m;
  max_m = std::max(max_m, other.max_m);
  sum_yaw_rad += other.sum_yaw_rad;
  max_yaw_rad = std::max(max_yaw_rad, other.max_yaw_rad);
  sum_deviation_m += other.sum_deviation_m;
  sum_squared_normalised += other.sum_squared_normalised;
}

SimulatedRobot::SimulatedRobot(const sim::Scenario& scenario, navigation::Navigator navigator,
                               const navigation::DriverOptions& driver,
                               const navigation::CellOptions& cells,
                               std::vector<navigation::Place> places,
                               std::vector<navigation::Door> doors)
  : scenario_(scenario)
  , world_(sim::makeWorld(scenario))
  , navigator_(std::move(navigator))
  , driver_(driver)
  , cell_options_(cells)
  , places_(std::move(places))
  , doors_(std::move(doors))
{
}

Pose SimulatedRobot::truth() const
{
  const sim::Pose pose = world_->robotPose();
  return {pose.position.x, pose.position.y, sim::yawOf(pose.orientation)};
}

double SimulatedRobot::time() const
{
  return static_cast<double>(ticks_) * kOdometryPeriod;
}

void SimulatedRobot::wait(double time_s)
{
  world_->setCommand(0.0, 0.0);
  for (const double end = time() + time_s; time() < end;)
    tick();
}

DriveReport SimulatedRobot::driveTo(const navigation::Cell& cell, double time_limit_s)
{
  DriveReport report;
  errors_ = PoseErrors{};
  target_ = cell;
  const double start_s = time();
  const std::uint32_t contacts_before = world_->robotContacts();
  const int plans_before = driver_.numPlans();
  driver_.start({presentStand(cell, cell_options_, navigator_.map().planner()), std::nullopt});
  Pose last = truth();
  while (driver_.isActive() && time() - start_s < time_limit_s)
  {
    tick();
    const Pose here = truth();
    report.length_m += distance(here.position(), last.position());
    last = here;
  }
  report.end_error_m = distance(last.position(), driver_.goal().position);
  report.arrived = driver_.phase() == navigation::DrivePhase::kArrived;
  if (driver_.isActive())
    report.reason = "not there in time";
  else if (!report.arrived)
    report.reason =
        navigator_.whyUnreachable(driver_.goal().position, driver_.reason(), places_, doors_);
  report.in_cell = cell.rectangle.contains(last.position());
  report.time_s = time() - start_s;
  report.contacts = world_->robotContacts() - contacts_before;
  report.plans = driver_.numPlans() - plans_before;
  report.errors = errors_;
  driver_.cancel();
  target_.reset();
  world_->setCommand(0.0, 0.0);
  return report;
}

void SimulatedRobot::sense()
{
  const std::vector<double> ranges = world_->scan();
  const double increment = 2.0 * M_PI / static_cast<double>(ranges.size());
  const sim::LaserModel& laser = scenario_.world.laser;
  const sim::Pose& mount = scenario_.world.robot.T_base_laser;
  const double start_s = cpuSeconds();
  navigator_.addScan(
      time(),
      {-M_PI, increment, laser.min_range_m, laser.max_range_m, {ranges.begin(), ranges.end()}},
      {{mount.position.x, mount.position.y, sim::yawOf(mount.orientation)}, mount.position.z});
  navigation_cpu_s_ += cpuSeconds() - start_s;
}

void SimulatedRobot::tick()
{
  const auto steps = static_cast<int>(std::lround(kOdometryPeriod / scenario_.world.time_step_s));
  for (int step = 0; step < steps; ++step)
    world_->step();
  ++ticks_;
  const sim::Pose2 odometry = world_->odometryPose();
  if (known_poses_)
    navigator_.addKnownPose(time(), truth());
  const double start_s = cpuSeconds();
  navigator_.addOdometry(time(), {odometry.x, odometry.y, odometry.yaw});
  navigation_cpu_s_ += cpuSeconds() - start_s;
  if (ticks_ % kTicksPerScan == 0)
    sense();
  for (const navigation::StampedEstimate& stamped : navigator_.takeEstimates())
    errors_.add(stamped.estimate, truth());

  const double control_start_s = cpuSeconds();
  if (target_ && navigator_.takeControlTurn())
  {
    Velocity command;
    if (const std::optional<navigation::DriveInput> input =
            navigator_.driveInput(driver_.isActive()))
    {
      if (input->map_changed && !input->planner.isInMainRegion(driver_.goal().position))
        driver_.redirect({presentStand(*target_, cell_options_, input->planner), std::nullopt});
      command = driver_.step(*input);
      if (const std::optional<navigation::Point> contact = driver_.takeContact())
        navigator_.addContact(*contact);
      if (driver_.takeFreshMapRequest())
        navigator_.forgetRevisions();
    }
    world_->setCommand(command.linear, command.angular);
  }
  navigation_cpu_s_ += cpuSeconds() - control_start_s;
}

}  // namespace kr3::experiments
