#include "navigation_node.hpp"

#include <algorithm>
#include <cmath>

#include <tf2/exceptions.h>

#include <kr3_common/error.hpp>

#include "conversions.hpp"
#include "names.hpp"

namespace kr3::navigation
{
namespace
{

constexpr double kGridMargin = 0.2;    // m around the places
constexpr double kRevisePeriod = 0.5;  // s
constexpr double kScanTimeout = 0.6;   // s: without scans the robot does not move
constexpr std::size_t kMaxPending = 5;

Rectangle areaOf(const std::vector<Place>& places)
{
  Rectangle area = places.front().rectangle;
  for (const Place& place : places)
  {
    area = {
        std::min(area.x_min, place.rectangle.x_min), std::min(area.y_min, place.rectangle.y_min),
        std::max(area.x_max, place.rectangle.x_max), std::max(area.y_max, place.rectangle.y_max)};
  }
  return area.shrunk(-kGridMargin);
}

LiveMap makeLiveMap(const NavigationNodeConfig& config, const std::vector<Place>& places)
{
  if (config.pose_source == PoseSource::kGroundTruth)
    return {OccupancyMap(config.occupancy), false, areaOf(places), config.live_map};
  if (!std::filesystem::exists(config.map))
    throw Unavailable(
        "the map " + config.map.string() + " does not exist; build it with `./kr3 map " +
        std::filesystem::absolute(config.building).parent_path().filename().string() + "`");
  return {OccupancyMap::load(config.map, config.occupancy), true, areaOf(places), config.live_map};
}

PoseTracker makeTracker(const NavigationNodeConfig& config, const LiveMap& map)
{
  if (config.pose_source == PoseSource::kGroundTruth)
    return {std::nullopt, Pose{}};
  return {ParticleFilter(map.reference(), config.particle_filter,
                         static_cast<std::uint64_t>(config.seed)),
          config.initial_pose};
}

double smoothed(double before, double now)
{
  return 0.95 * before + 0.05 * now;
}

}  // namespace

NavigationNode::NavigationNode(const NavigationNodeConfig& config)
  : config_(config)
  , places_(loadPlaces(config.building))
  , live_map_(makeLiveMap(config, places_))
  , tracker_(makeTracker(config, live_map_))
{
  ros::NodeHandle nh;
  constexpr bool kLatched = true;
  map_publisher_ = nh.advertise<nav_msgs::OccupancyGrid>(names::kMap, 1, kLatched);
  octomap_publisher_ = nh.advertise<std_msgs::UInt8MultiArray>(names::kOctomapBinary, 1, kLatched);
  cells_publisher_ = nh.advertise<kr3_msgs::CellArray>(names::kCells, 1, kLatched);
  markers_publisher_ =
      nh.advertise<visualization_msgs::MarkerArray>(names::kCellMarkers, 1, kLatched);
  path_publisher_ = nh.advertise<nav_msgs::Path>(names::kPath, 1, kLatched);
  pose_publisher_ = nh.advertise<geometry_msgs::PoseWithCovarianceStamped>(names::kPose, 10);
  cmd_vel_publisher_ = nh.advertise<geometry_msgs::Twist>(names::kCmdVel, 10);
  tf_publisher_ = nh.advertise<tf2_msgs::TFMessage>(names::kTf, 100);
  if (config_.pose_source == PoseSource::kGroundTruth)
    ROS_WARN("poses come from the simulator's ground truth: for building the map only");
  makeCells(live_map_.planner());
  publishMap(0.0);

  servers_.emplace(nh, config_.driver, config_.cells, config_.map_frame, config_.drive_time_limit_s,
                   DriveContext{tracker_, [this]() -> const CellMap& { return *cells_; },
                                [this]() -> const PathPlanner& { return live_map_.planner(); },
                                [this](const Velocity& velocity) {
    cmd_vel_publisher_.publish(toMsg(velocity));
                                }});
  save_map_server_ = nh.advertiseService(names::kSaveMap, &NavigationNode::onSaveMap, this);
  diagnostics_.setHardwareID("none");
  diagnostics_.add("navigation", [this](diagnostic_updater::DiagnosticStatusWrapper& status) {
    diagnose(status);
  });
  diagnostics_timer_ = nh.createWallTimer(
      ros::WallDuration(1.0), [this](const ros::WallTimerEvent&) { diagnostics_.force_update(); });
  const ros::TransportHints fast = ros::TransportHints().tcpNoDelay();
  subscribers_.push_back(
      nh.subscribe(names::kTfStatic, 100, &NavigationNode::onStaticTransforms, this));
  subscribers_.push_back(nh.subscribe(names::kOdom, 200, &NavigationNode::onOdometry, this, fast));
  subscribers_.push_back(
      nh.subscribe(names::kScan, kMaxPending, &NavigationNode::onScan, this, fast));
  subscribers_.push_back(
      nh.subscribe(names::kInitialPose, 1, &NavigationNode::onInitialPose, this));
  if (config_.pose_source == PoseSource::kGroundTruth)
    subscribers_.push_back(
        nh.subscribe(names::kGroundTruthPose, 200, &NavigationNode::onGroundTruth, this, fast));
}

void NavigationNode::stop()
{
  subscribers_.clear();
  servers_->stop();
  cmd_vel_publisher_.publish(toMsg(Velocity{}));
}

std_msgs::Header NavigationNode::mapHeader(double time_s) const
{
  std_msgs::Header header;
  header.frame_id = config_.map_frame;
  header.stamp = ros::Time(time_s);
  return header;
}

void NavigationNode::onStaticTransforms(const tf2_msgs::TFMessage& message)
{
  for (const geometry_msgs::TransformStamped& transform : message.transforms)
    static_transforms_.setTransform(transform, "tf_static", true);
}

std::optional<LaserMount> NavigationNode::mountOf(const std::string& laser_frame) const
{
  try
  {
    const geometry_msgs::Transform transform =
        static_transforms_.lookupTransform(config_.base_frame, laser_frame, ros::Time(0)).transform;
    geometry_msgs::Pose pose;
    pose.position.x = transform.translation.x;
    pose.position.y = transform.translation.y;
    pose.orientation = transform.rotation;
    return LaserMount{fromMsg(pose), transform.translation.z};
  }
  catch (const tf2::TransformException& e)
  {
    ROS_WARN_THROTTLE(5.0, "scans are ignored until /tf_static says where the laser is: %s",
                      e.what());
    return std::nullopt;
  }
}

void NavigationNode::onScan(const sensor_msgs::LaserScan& message)
{
  const std::optional<LaserMount> mount = mountOf(message.header.frame_id);
  if (!mount)
    return;
  try
  {
    pending_.push_back({message.header.stamp.toSec(), fromMsg(message), *mount});
  }
  catch (const InvalidArgument& e)
  {
    ROS_WARN_THROTTLE(5.0, "scan ignored: %s", e.what());
    return;
  }
  if (pending_.size() > kMaxPending)
  {
    pending_.pop_front();
    ++load_.dropped_scans;
  }
  processScans();
}

void NavigationNode::onGroundTruth(const nav_msgs::Odometry& message)
{
  try
  {
    tracker_.addKnownPose(message.header.stamp.toSec(), fromMsg(message.pose.pose));
  }
  catch (const InvalidArgument& e)
  {
    ROS_WARN_THROTTLE(5.0, "ground truth ignored: %s", e.what());
  }
  processScans();
}

void NavigationNode::onOdometry(const nav_msgs::Odometry& message)
{
  const double time_s = message.header.stamp.toSec();
  try
  {
    if (!tracker_.addOdometry(time_s, fromMsg(message.pose.pose)))
    {
      ROS_WARN("odometry jumped: localisation starts again at the initial pose");
      pending_.clear();
      obstacles_odom_.clear();
      scan_time_s_.reset();
    }
  }
  catch (const InvalidArgument& e)
  {
    ROS_WARN_THROTTLE(5.0, "odometry ignored: %s", e.what());
    return;
  }
  processScans();
  if (!control_time_s_ || time_s < *control_time_s_ ||
      time_s - *control_time_s_ >= config_.control_period_s - 1e-6)
  {
    control_time_s_ = time_s;
    control(time_s);
  }
}

void NavigationNode::onInitialPose(const geometry_msgs::PoseWithCovarianceStamped& message)
{
  if (message.header.frame_id != config_.map_frame)
  {
    ROS_ERROR("initialpose ignored: it is in frame '%s', expected '%s'",
              message.header.frame_id.c_str(), config_.map_frame.c_str());
    return;
  }
  try
  {
    const auto& covariance = message.pose.covariance;
    const PoseSpread least;
    tracker_.reset(fromMsg(message.pose.pose),
                   {std::max(least.position_m, std::sqrt(std::max(covariance[0], covariance[7]))),
                    std::max(least.yaw_rad, std::sqrt(std::max(0.0, covariance[35])))});
    ROS_INFO("localisation starts again at (%.2f, %.2f)", message.pose.pose.position.x,
             message.pose.pose.position.y);
  }
  catch (const InvalidArgument& e)
  {
    ROS_ERROR("initialpose ignored: %s", e.what());
  }
}

void NavigationNode::processScans()
{
  // A scan waits until odometry of its own moment has arrived.
  while (!pending_.empty() && tracker_.isReadyFor(pending_.front().time_s))
  {
    const PendingScan pending = std::move(pending_.front());
    pending_.pop_front();
    const ros::WallTime start = ros::WallTime::now();
    processScan(pending);
    load_.scan_ms = smoothed(load_.scan_ms, 1e3 * (ros::WallTime::now() - start).toSec());
    load_.scan_age_s =
        smoothed(load_.scan_age_s, tracker_.odometry().latestTime() - pending.time_s);
    ++load_.scans;
  }
}

void NavigationNode::processScan(const PendingScan& pending)
{
  const std::optional<Pose> pose =
      tracker_.correct(pending.time_s, pending.scan, pending.mount.T_base_laser);
  if (!pose)
  {
    ++load_.dropped_scans;
    return;
  }
  const Pose T_odom_base = inverse(tracker_.correction()) * *pose;
  obstacles_odom_ = hitPoints(pending.scan, T_odom_base * pending.mount.T_base_laser);
  scan_time_s_ = pending.time_s;
  PoseEstimate estimate = tracker_.estimate();
  estimate.mean = *pose;
  pose_publisher_.publish(toMsg(estimate, mapHeader(pending.time_s)));

  if (!tracker_.isConfident())
    return;
  live_map_.insertScan(pending.scan, *pose * pending.mount.T_base_laser, pending.mount.height_m);
  if (revise_time_s_ && pending.time_s >= *revise_time_s_ &&
      pending.time_s - *revise_time_s_ < kRevisePeriod)
    return;
  revise_time_s_ = pending.time_s;
  if (live_map_.revise())
    map_changed_for_driver_ = map_changed_for_others_ = true;
}

void NavigationNode::control(double time_s)
{
  if (!tracker_.hasPose())
    return;
  publishCorrection(time_s);
  if (!scan_time_s_ || time_s - *scan_time_s_ > kScanTimeout)
  {
    if (servers_->driver().isActive())
      ROS_WARN_THROTTLE(5.0, "the robot waits: no scan for %.1f s", kScanTimeout);
    servers_->hold();
  }
  else
  {
    const Pose T_base_odom = inverse(tracker_.odometry().latest());
    std::vector<Point> obstacles_base;
    if (servers_->driver().isActive())
    {
      obstacles_base.reserve(obstacles_odom_.size());
      for (const Point& p_odom : obstacles_odom_)
        obstacles_base.push_back(T_base_odom * p_odom);
    }
    servers_->tick(
        {time_s, tracker_.pose(), live_map_.planner(), obstacles_base, map_changed_for_driver_});
    map_changed_for_driver_ = false;
    if (servers_->takeFreshMapRequest())
    {
      ROS_INFO("no path: obstacles seen earlier are forgotten, and looked for again");
      live_map_.forgetRevisions();
      map_changed_for_driver_ = map_changed_for_others_ = true;
    }
  }
  publishPath();
  if (!publish_time_s_ || time_s < *publish_time_s_ ||
      time_s - *publish_time_s_ >= config_.map_publish_period_s)
    publishMap(time_s);
}

void NavigationNode::publishCorrection(double time_s)
{
  std_msgs::Header header = mapHeader(time_s);
  tf2_msgs::TFMessage message;
  message.transforms.push_back(toTransformMsg(tracker_.correction(), header, config_.odom_frame));
  tf_publisher_.publish(message);
}

void NavigationNode::publishPath()
{
  const Driver& driver = servers_->driver();
  if (driver.numPlans() == published_plans_)
    return;
  published_plans_ = driver.numPlans();
  path_publisher_.publish(toMsg(driver.path(), mapHeader(tracker_.poseTime())));
}

void NavigationNode::publishMap(double time_s)
{
  publish_time_s_ = time_s;
  if (!map_changed_for_others_)
    return;
  map_changed_for_others_ = false;
  map_publisher_.publish(toMsg(live_map_.grid(), mapHeader(time_s)));
  octomap_publisher_.publish(toMsg(live_map_.map().toBinary()));
}

void NavigationNode::makeCells(const PathPlanner& planner)
{
  cells_.emplace(places_, config_.cells, planner);
  for (const Cell& cell : cells_->cells())
  {
    if (!cell.reachable)
      ROS_WARN("the cell %s has no free point that the robot can reach", cell.name.c_str());
  }
  const std_msgs::Header header = mapHeader(publish_time_s_.value_or(0.0));
  cells_publisher_.publish(toMsg(*cells_, header));
  markers_publisher_.publish(toMarkers(*cells_, header));
}

bool NavigationNode::onSaveMap(std_srvs::Trigger::Request& /*request*/,
                               std_srvs::Trigger::Response& response)
{
  try
  {
    if (config_.map_out.empty())
      throw FailedPrecondition("the parameter map_out is not set");
    live_map_.map().save(config_.map_out);
    response.success = 1;
    response.message = "saved " + config_.map_out.string();
    ROS_INFO("%s", response.message.c_str());
    if (config_.pose_source == PoseSource::kGroundTruth)
    {
      // What was never seen is not free for those who will use this map.
      PathPlannerOptions finished = config_.live_map.planner;
      finished.unknown_is_free = false;
      (void)live_map_.revise();
      makeCells(PathPlanner(live_map_.grid(), finished));
    }
  }
  catch (const Error& e)
  {
    response.success = 0;
    response.message = e.what();
    ROS_ERROR("%s: %s", names::kSaveMap, e.what());
  }
  return true;
}

void NavigationNode::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) const
{
  using diagnostic_msgs::DiagnosticStatus;
  if (!tracker_.hasPose() || !scan_time_s_)
    status.summary(DiagnosticStatus::WARN, "waiting for odometry and scans");
  else if (!tracker_.isConfident())
    status.summary(DiagnosticStatus::WARN, "the pose is uncertain");
  else
    status.summary(DiagnosticStatus::OK, toString(servers_->driver().phase()));
  const PoseEstimate estimate = tracker_.hasPose() ? tracker_.estimate() : PoseEstimate{};
  status.add("position deviation (m)", std::sqrt(estimate.covariance[0] + estimate.covariance[4]));
  status.add("mean distance of hits from the map (m)", estimate.mean_hit_distance_m);
  status.add("scans processed", load_.scans);
  status.add("scans dropped", load_.dropped_scans);
  status.add("time per scan (ms)", load_.scan_ms);
  status.add("age of a scan when processed (simulated s)", load_.scan_age_s);
  status.add("map leaves", live_map_.map().numLeaves());
}

}  // namespace kr3::navigation
