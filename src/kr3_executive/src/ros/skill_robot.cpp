#include "skill_robot.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include <geometry_msgs/PointStamped.h>
#include <geometry_msgs/Twist.h>
#include <tf2/utils.h>
#include <tf2_geometry_msgs/tf2_geometry_msgs.h>

#include <kr3_common/error.hpp>
#include <kr3_msgs/CloseGripper.h>
#include <kr3_msgs/OpenGripper.h>

#include "skill_names.hpp"

namespace kr3::executive::skills
{
namespace
{

constexpr std::chrono::milliseconds kPoll(20);  // of wall time: how soon an interruption is noticed
constexpr double kTurnGain = 2.5;               // 1/s
constexpr double kMinTurnSpeed = 0.12;          // rad/s: slower does not overcome friction
constexpr double kSlowTurnSpeed = 0.4;          // rad/s, of corrections
constexpr int kTurnAttempts = 4;
constexpr double kStillSpeed = 0.03;         // m/s and rad/s
constexpr double kPositionTolerance = 0.01;  // m, of creeping

double yawOf(const geometry_msgs::Quaternion& q)
{
  return tf2::getYaw(q);
}

ErrorCode codeOf(const kr3_msgs::Status& status)
{
  return static_cast<ErrorCode>(status.code);
}

}  // namespace

SkillRobot::SkillRobot(const ros::NodeHandle& nh, const SkillRobotConfig& config)
  : config_(config), nh_(nh), tf_listener_(tf_), move_base_(nh_, names::kMoveBase, false)
{
  close_ = nh_.serviceClient<kr3_msgs::CloseGripper>(names::kCloseGripper);
  open_ = nh_.serviceClient<kr3_msgs::OpenGripper>(names::kOpenGripper);
  command_ = nh_.advertise<geometry_msgs::Twist>(names::kCommand, 1);
  const auto keep = [this](auto member) {
    return [this, member](const auto& message) { notify([&] { this->*member = message; }); };
  };
  subscribers_ = {
      nh_.subscribe<kr3_msgs::CellArray>(names::kCells, 1, keep(&SkillRobot::cells_)),
      nh_.subscribe<nav_msgs::OccupancyGrid>(names::kMap, 1, keep(&SkillRobot::map_)),
      nh_.subscribe<sensor_msgs::LaserScan>(names::kScan, 1, keep(&SkillRobot::scan_)),
      nh_.subscribe<nav_msgs::Odometry>(names::kOdometry, 1, keep(&SkillRobot::odometry_),
                                        ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay()),
      nh_.subscribe<std_msgs::Bool>(names::kHolding, 1,
                                    [this](const std_msgs::BoolConstPtr& message) {
    notify([&] { holding_ = message->data; });
      })};
}

SkillRobot::~SkillRobot() = default;

void SkillRobot::notify(const std::function<void()>& change)
{
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    change();
  }
  changed_.notify_all();
}

void SkillRobot::waitFor(const std::function<bool()>& condition, const std::string& what,
                         const Interruption& interruption, bool patient)
{
  const ros::WallTime deadline = ros::WallTime::now() + ros::WallDuration(config_.peer_timeout_s);
  std::unique_lock<std::mutex> lock(mutex_);
  while (!condition())
  {
    changed_.wait_for(lock, kPoll);
    lock.unlock();
    interruption();
    if (!patient && ros::WallTime::now() > deadline)
      throw Unavailable("waited " + std::to_string(config_.peer_timeout_s) + " s in vain for " +
                        what);
    lock.lock();
  }
}

CellMap SkillRobot::cells(const Interruption& interruption)
{
  waitFor([&] { return cells_ != nullptr; }, "the cells of the building", interruption);
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<CellArea> areas;
  for (const kr3_msgs::Cell& cell : cells_->cells)
    areas.push_back({cell.name,
                     cell.room,
                     {cell.center.x, cell.center.y},
                     cell.size_x,
                     cell.size_y,
                     {cell.stand.x, cell.stand.y}});
  return CellMap(areas);
}

Grid SkillRobot::grid(const Interruption& interruption)
{
  waitFor([&] { return map_ != nullptr; }, "the map", interruption);
  const std::lock_guard<std::mutex> lock(mutex_);
  return {{map_->info.origin.position.x, map_->info.origin.position.y},
          map_->info.resolution,
          static_cast<int>(map_->info.width),
          static_cast<int>(map_->info.height),
          {map_->data.begin(), map_->data.end()}};
}

std::optional<geometry_msgs::TransformStamped> SkillRobot::transform(const std::string& target,
                                                                     const std::string& source,
                                                                     const ros::Time& time) const
{
  try
  {
    return tf_.lookupTransform(target, source, time);
  }
  catch (const tf2::TransformException&)
  {
    return std::nullopt;
  }
}

Pose SkillRobot::pose(const Interruption& interruption)
{
  std::optional<geometry_msgs::TransformStamped> T_map_base;
  waitFor(
      [&] {
    T_map_base = transform(config_.map_frame, config_.base_frame, ros::Time());
    return T_map_base.has_value();
      },
      "the transform from " + config_.base_frame + " to " + config_.map_frame, interruption);
  const geometry_msgs::Transform& t = T_map_base->transform;
  return {t.translation.x, t.translation.y, yawOf(t.rotation)};
}

bool SkillRobot::holding() const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return holding_;
}

bool SkillRobot::viewAngleKnown() const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return view_angle_rad_.has_value();
}

void SkillRobot::openEyes()
{
  if (!eyes_)
    eyes_ = nh_.subscribe<kr3_msgs::DetectionArray>(
        names::kDetections, 1, [this](const kr3_msgs::DetectionArrayConstPtr& message) {
          notify([&] { detections_ = message; });
        });
  if (!camera_info_ && !viewAngleKnown())
    camera_info_ = nh_.subscribe<sensor_msgs::CameraInfo>(
        names::kCameraInfo, 1, [this](const sensor_msgs::CameraInfoConstPtr& info) {
          if (info->K[0] > 0.0)
            notify([&] { view_angle_rad_ = 2.0 * std::atan(info->width / (2.0 * info->K[0])); });
        });
}

void SkillRobot::restEyes()
{
  eyes_.shutdown();
  camera_info_.shutdown();
}

double SkillRobot::viewAngle(const Interruption& interruption)
{
  waitFor([&] { return view_angle_rad_.has_value(); }, "the camera's calibration", interruption);
  camera_info_.shutdown();  // not under the lock: it waits for a callback that may be under way
  const std::lock_guard<std::mutex> lock(mutex_);
  return *view_angle_rad_;
}

std::vector<Seen> SkillRobot::look(const Interruption& interruption)
{
  const ros::Time from = ros::Time::now();
  waitFor([&] { return detections_ && detections_->header.stamp > from; }, "detections",
          interruption);
  kr3_msgs::DetectionArrayConstPtr detections;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    detections = detections_;
  }
  std::optional<geometry_msgs::TransformStamped> T_map_camera;
  waitFor(
      [&] {
    T_map_camera =
        transform(config_.map_frame, detections->header.frame_id, detections->header.stamp);
    return T_map_camera.has_value();
      },
      "the transform from " + detections->header.frame_id + " to " + config_.map_frame,
      interruption);
  std::vector<Seen> seen;
  for (const kr3_msgs::Detection& detection : detections->detections)
    seen.push_back({detection.name, detection.probability, positionOf(detection, *T_map_camera)});
  return seen;
}

std::optional<Point> SkillRobot::positionOf(const kr3_msgs::Detection& detection,
                                            const geometry_msgs::TransformStamped& T_map_camera)
{
  if (!detection.has_position)
    return std::nullopt;
  geometry_msgs::PointStamped p_camera;
  p_camera.point = detection.position;
  geometry_msgs::PointStamped p_map;
  tf2::doTransform(p_camera, p_map, T_map_camera);
  const Point by_size{p_map.point.x, p_map.point.y};

  sensor_msgs::LaserScanConstPtr scan;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    scan = scan_;
  }
  if (!scan)
    return by_size;
  const auto T_map_laser = transform(config_.map_frame, scan->header.frame_id, ros::Time());
  if (!T_map_laser || p_map.point.z < T_map_laser->transform.translation.z)
    return by_size;  // it stands below the laser's plane: on the floor
  const Point laser{T_map_laser->transform.translation.x, T_map_laser->transform.translation.y};
  const double direction = bearing(laser, by_size);
  const auto by_laser = laserRange(direction, *T_map_laser);
  if (!by_laser)
    return by_size;
  const double range = boundedRange(distance(laser, by_size), *by_laser, config_.furniture_depth_m);
  return Point{laser.x + range * std::cos(direction), laser.y + range * std::sin(direction)};
}

std::optional<double> SkillRobot::laserRange(double bearing_map_rad,
                                             const geometry_msgs::TransformStamped& T_map_laser)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!scan_ || scan_->ranges.empty() || !(scan_->angle_increment > 0.0F))
    return std::nullopt;
  double angle =
      wrapped(bearing_map_rad - yawOf(T_map_laser.transform.rotation)) - scan_->angle_min;
  while (angle < 0.0)
    angle += 2.0 * M_PI;
  const auto beam = std::lround(angle / static_cast<double>(scan_->angle_increment));
  if (beam >= static_cast<long>(scan_->ranges.size()))
    return std::nullopt;
  const float range = scan_->ranges[static_cast<std::size_t>(beam)];
  if (!std::isfinite(range) || range < scan_->range_min)
    return std::nullopt;
  return static_cast<double>(range);
}

std::vector<Point> SkillRobot::scanInBase(const Interruption& interruption)
{
  waitFor([&] { return scan_ != nullptr; }, "a laser scan", interruption);
  sensor_msgs::LaserScanConstPtr scan;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    scan = scan_;
  }
  const auto T_base_laser = transform(config_.base_frame, scan->header.frame_id, ros::Time());
  if (!T_base_laser)
    throw Unavailable("no transform from " + scan->header.frame_id + " to " + config_.base_frame);
  const double yaw = yawOf(T_base_laser->transform.rotation);
  std::vector<Point> points;
  for (std::size_t i = 0; i < scan->ranges.size(); ++i)
  {
    const double range = static_cast<double>(scan->ranges[i]);
    if (!std::isfinite(range) || range < static_cast<double>(scan->range_min))
      continue;
    const double angle = yaw + static_cast<double>(scan->angle_min) +
                         static_cast<double>(i) * static_cast<double>(scan->angle_increment);
    points.push_back({T_base_laser->transform.translation.x + range * std::cos(angle),
                      T_base_laser->transform.translation.y + range * std::sin(angle)});
  }
  return points;
}

void SkillRobot::command(double linear_m_s, double angular_rad_s)
{
  geometry_msgs::Twist twist;
  twist.linear.x = linear_m_s;
  twist.angular.z = angular_rad_s;
  command_.publish(twist);
}

void SkillRobot::stop()
{
  command(0.0, 0.0);
}

nav_msgs::Odometry SkillRobot::nextOdometry(const Interruption& interruption)
{
  waitFor([&] { return odometry_ && odometry_->header.stamp != last_odometry_; }, "odometry",
          interruption);
  const std::lock_guard<std::mutex> lock(mutex_);
  last_odometry_ = odometry_->header.stamp;
  return *odometry_;
}

void SkillRobot::standStill(const Interruption& interruption)
{
  for (;;)
  {
    const nav_msgs::Odometry odometry = nextOdometry(interruption);
    if (std::abs(odometry.twist.twist.linear.x) < kStillSpeed &&
        std::abs(odometry.twist.twist.angular.z) < kStillSpeed)
      return;
    stop();
  }
}

void SkillRobot::turnTo(double yaw_rad, const Interruption& interruption)
{
  // The correction of drift changes only a little while turning: the goal is fixed in odometry.
  const double heading = pose(interruption).yaw;
  const double goal =
      yawOf(nextOdometry(interruption).pose.pose.orientation) + wrapped(yaw_rad - heading);
  const auto error = [&] {
    return wrapped(goal - yawOf(nextOdometry(interruption).pose.pose.orientation));
  };
  // Commands take effect late, so that the robot may overshoot: look again once it stands.
  for (int attempt = 0; attempt < kTurnAttempts; ++attempt)
  {
    for (double left = error(); std::abs(left) > config_.turn_tolerance_rad; left = error())
    {
      const double fastest = attempt == 0 ? config_.turn_speed_rad_s : kSlowTurnSpeed;
      const double speed = std::clamp(kTurnGain * std::abs(left), kMinTurnSpeed, fastest);
      command(0.0, std::copysign(speed, left));
    }
    stop();
    standStill(interruption);
    if (std::abs(error()) <= 2.0 * config_.turn_tolerance_rad)
      return;
  }
}

double SkillRobot::creep(double distance_m, const Interruption& interruption)
{
  const bool forward = distance_m >= 0.0;
  const auto position = [&] {
    const nav_msgs::Odometry odometry = nextOdometry(interruption);
    return Point{odometry.pose.pose.position.x, odometry.pose.pose.position.y};
  };
  const Point start = position();
  double done = 0.0;
  for (;;)
  {
    done = distance(start, position());
    const double room = freeDistance(scanInBase(interruption), config_.robot_radius_m, forward);
    if (done >= std::abs(distance_m) - kPositionTolerance || room <= config_.stop_clearance_m)
      break;
    command(forward ? config_.creep_speed_m_s : -config_.creep_speed_m_s, 0.0);
  }
  stop();
  standStill(interruption);
  return done;
}

bool SkillRobot::driveTo(const Pose& pose_map, const Interruption& interruption)
{
  waitFor([&] { return move_base_.isServerConnected(); }, names::kMoveBase, interruption);
  move_base_msgs::MoveBaseGoal goal;
  goal.target_pose.header.frame_id = config_.map_frame;
  goal.target_pose.header.stamp = ros::Time::now();
  goal.target_pose.pose.position.x = pose_map.x;
  goal.target_pose.pose.position.y = pose_map.y;
  goal.target_pose.pose.orientation.z = std::sin(pose_map.yaw / 2.0);
  goal.target_pose.pose.orientation.w = std::cos(pose_map.yaw / 2.0);
  move_base_.sendGoal(goal);
  try
  {
    waitFor([&] { return move_base_.getState().isDone(); }, names::kMoveBase, interruption, true);
  }
  catch (...)
  {
    move_base_.cancelGoal();
    throw;
  }
  return move_base_.getState() == actionlib::SimpleClientGoalState::SUCCEEDED;
}

bool SkillRobot::closeGripper()
{
  kr3_msgs::CloseGripper call;
  if (!close_.call(call))
    throw Unavailable(std::string("no answer from ") + names::kCloseGripper);
  if (codeOf(call.response.status) != ErrorCode::kOk)
    throw Error(codeOf(call.response.status), call.response.status.message);
  return call.response.holding;
}

bool SkillRobot::openGripper()
{
  kr3_msgs::OpenGripper call;
  if (!open_.call(call))
    throw Unavailable(std::string("no answer from ") + names::kOpenGripper);
  if (codeOf(call.response.status) == ErrorCode::kFailedPrecondition)
    return false;
  if (codeOf(call.response.status) != ErrorCode::kOk)
    throw Error(codeOf(call.response.status), call.response.status.message);
  return call.response.released;
}

}  // namespace kr3::executive::skills
