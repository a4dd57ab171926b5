#include "navigation_node.hpp"

#include <algorithm>
#include <cmath>

#include <tf2/exceptions.h>

#include <kr3_common/error.hpp>

#include "conversions.hpp"
#include "kr3_navigation/movable_nodes.hpp"
#include "names.hpp"

namespace kr3::navigation
{
namespace
{

constexpr double kGridMargin = 0.2;  // m around the places
constexpr std::uint32_t kScanQueue = 5;
constexpr PoseSpread kFrameSpread{0.005, 0.002};

void requireMap(const NavigationNodeConfig& config)
{
  if (std::filesystem::exists(config.map))
    return;
  const std::string problem = "the map " + config.map.string() + " does not exist";
  if (config.building.empty())
    throw Unavailable(problem);
  throw Unavailable(problem + "; build it with `./kr3 map " +
                    std::filesystem::absolute(config.building).parent_path().filename().string() +
                    "`");
}

std::vector<Place> placesFor(const NavigationNodeConfig& config)
{
  if (config.place_source == PlaceSource::kBuilding)
    return loadPlaces(config.building);
  requireMap(config);
  const std::vector<Place> places =
      placesOfMap(OccupancyMap::load(config.map, config.occupancy), config.live_map.z_min_m,
                  config.live_map.z_max_m, config.segmentation);
  ROS_INFO("the map shows %zu rooms", places.size());
  return places;
}

std::vector<Door> doorsFor(const NavigationNodeConfig& config, const std::vector<Place>& places)
{
  if (config.place_source == PlaceSource::kMap)
    return {};  // passages are found where they are blocked
  return loadDoors(config.building, places);
}

LiveMap makeLiveMap(const NavigationNodeConfig& config, const std::vector<Place>& places)
{
  if (config.pose_source != PoseSource::kLocalisation)
    return {OccupancyMap(config.occupancy), false, areaOf(places, kGridMargin), config.live_map};
  requireMap(config);
  return {OccupancyMap::load(config.map, config.occupancy), true, areaOf(places, kGridMargin),
          config.live_map};
}

Navigator makeNavigator(const NavigationNodeConfig& config, const std::vector<Place>& places)
{
  LiveMap map = makeLiveMap(config, places);
  NavigatorOptions options;
  options.control_period_s = config.control_period_s;
  if (config.pose_source == PoseSource::kGroundTruth)
    return {std::move(map), PoseTracker(std::nullopt, Pose{}), options};
  const bool maps = config.pose_source == PoseSource::kMapping;
  const DistanceField& field = maps ? map.planner().field() : map.reference();
  ParticleFilter filter(field, config.particle_filter, static_cast<std::uint64_t>(config.seed),
                        movableNodes(field, places));
  // A robot that maps on its own says where the frame is.
  const PoseSpread spread = maps ? kFrameSpread : PoseSpread{};
  return {std::move(map), PoseTracker(std::move(filter), config.initial_pose, spread), options};
}

double smoothed(double before, double now)
{
  return 0.95 * before + 0.05 * now;
}

}  // namespace

NavigationNode::NavigationNode(const NavigationNodeConfig& config)
  : config_(config)
  , places_(placesFor(config))
  , doors_(doorsFor(config, places_))
  , navigator_(makeNavigator(config, places_))
{
  ros::NodeHandle nh;
  constexpr bool kLatched = true;
  map_publisher_ = nh.advertise<nav_msgs::OccupancyGrid>(names::kMap, 1, kLatched);
  octomap_publisher_ = nh.advertise<std_msgs::UInt8MultiArray>(names::kOctomapBinary, 1, kLatched);
  cells_publisher_ = nh.advertise<kr3_msgs::CellArray>(names::kCells, 1, kLatched);
  markers_publisher_ =
      nh.advertise<visualization_msgs::MarkerArray>(names::kCellMarkers, 1, kLatched);
  path_publisher_ = nh.advertise<nav_msgs::Path>(names::kPath, 1, kLatched);
  cmd_vel_publisher_ = nh.advertise<geometry_msgs::Twist>(names::kCmdVel, 10);
  tf_publisher_ = nh.advertise<tf2_msgs::TFMessage>(names::kTf, 100);
  if (config_.pose_source == PoseSource::kGroundTruth)
    ROS_WARN("poses come from the simulator's ground truth: for building the map only");
  makeCells(navigator_.map().planner());
  publishMap(0.0);

  servers_.emplace(
      nh, config_.driver, config_.cells, config_.map_frame, config_.drive_time_limit_s,
      DriveContext{
          navigator_.tracker(), [this]() -> const CellMap& { return *cells_; },
          [this]() -> const PathPlanner& { return navigator_.map().planner(); },
          [this](const Velocity& velocity) { cmd_vel_publisher_.publish(toMsg(velocity)); },
          [this](Point goal, const std::string& reason) {
    return navigator_.whyUnreachable(goal, reason, places_, doors_);
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
      nh.subscribe(names::kScan, kScanQueue, &NavigationNode::onScan, this, fast));
  subscribers_.push_back(
      nh.subscribe(names::kInitialPose, 1, &NavigationNode::onInitialPose, this));
  if (config_.pose_source == PoseSource::kGroundTruth)
    subscribers_.push_back(
        nh.subscribe(names::kGroundTruthPose, 200, &NavigationNode::onGroundTruth, this, fast));
  // The last, so that who finds this topic knows that the node has subscribed to its inputs.
  pose_publisher_ = nh.advertise<geometry_msgs::PoseWithCovarianceStamped>(names::kPose, 10);
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
  const double start_s = ros::WallTime::now().toSec();
  try
  {
    navigator_.addScan(message.header.stamp.toSec(), fromMsg(message), *mount);
  }
  catch (const InvalidArgument& e)
  {
    ROS_WARN_THROTTLE(5.0, "scan ignored: %s", e.what());
    return;
  }
  publishEstimates(start_s);
}

void NavigationNode::onGroundTruth(const nav_msgs::Odometry& message)
{
  const double start_s = ros::WallTime::now().toSec();
  try
  {
    navigator_.addKnownPose(message.header.stamp.toSec(), fromMsg(message.pose.pose));
  }
  catch (const InvalidArgument& e)
  {
    ROS_WARN_THROTTLE(5.0, "ground truth ignored: %s", e.what());
    return;
  }
  publishEstimates(start_s);
}

void NavigationNode::onOdometry(const nav_msgs::Odometry& message)
{
  const double start_s = ros::WallTime::now().toSec();
  try
  {
    const OdometryResult result =
        navigator_.addOdometry(message.header.stamp.toSec(), fromMsg(message.pose.pose));
    if (result == OdometryResult::kRestarted)
      ROS_WARN(
          "odometry jumped or its time went back: localisation starts again at the initial "
          "pose");
  }
  catch (const InvalidArgument& e)
  {
    ROS_WARN_THROTTLE(5.0, "odometry ignored: %s", e.what());
    return;
  }
  publishEstimates(start_s);
  if (navigator_.takeControlTurn())
    control();
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
    const double variance = std::max(covariance[0], covariance[7]);
    if (!std::isfinite(covariance[0]) || !std::isfinite(covariance[7]) ||
        !std::isfinite(covariance[35]))
      throw InvalidArgument("the covariance is not finite");
    const PoseSpread least;
    navigator_.reset(fromMsg(message.pose.pose),
                     {std::max(least.position_m, std::sqrt(std::max(0.0, variance))),
                      std::max(least.yaw_rad, std::sqrt(std::max(0.0, covariance[35])))});
    ROS_INFO("localisation starts again at (%.2f, %.2f)", message.pose.pose.position.x,
             message.pose.pose.position.y);
  }
  catch (const InvalidArgument& e)
  {
    ROS_ERROR("initialpose ignored: %s", e.what());
  }
}

void NavigationNode::publishEstimates(double start_s)
{
  const std::vector<StampedEstimate> estimates = navigator_.takeEstimates();
  if (estimates.empty())
    return;
  const double per_scan_s =
      (ros::WallTime::now().toSec() - start_s) / static_cast<double>(estimates.size());
  for (const StampedEstimate& stamped : estimates)
  {
    load_.scan_ms = smoothed(load_.scan_ms, 1e3 * per_scan_s);
    load_.scan_age_s = smoothed(load_.scan_age_s, navigator_.tracker().poseTime() - stamped.time_s);
    ++load_.scans;
    pose_publisher_.publish(toMsg(stamped.estimate, mapHeader(stamped.time_s)));
  }
}

void NavigationNode::control()
{
  const double time_s = navigator_.tracker().poseTime();
  publishCorrection(time_s);
  if (const std::optional<DriveInput> input = navigator_.driveInput(servers_->driver().isActive()))
  {
    servers_->tick(*input);
    if (const std::optional<Point> contact = servers_->takeContact())
    {
      ROS_WARN("touched something unseen near (%.2f, %.2f): marked in the map", contact->x,
               contact->y);
      navigator_.addContact(*contact);
    }
    if (servers_->takeFreshMapRequest())
    {
      ROS_INFO("no path: obstacles seen earlier are forgotten, and looked for again");
      navigator_.forgetRevisions();
    }
  }
  else
  {
    if (servers_->driver().isActive())
      ROS_WARN_THROTTLE(5.0, "the robot waits for scans");
    servers_->hold();
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
  message.transforms.push_back(
      toTransformMsg(navigator_.tracker().correction(), header, config_.odom_frame));
  tf_publisher_.publish(message);
}

void NavigationNode::publishPath()
{
  const Driver& driver = servers_->driver();
  if (driver.numPlans() == published_plans_)
    return;
  published_plans_ = driver.numPlans();
  path_publisher_.publish(toMsg(driver.path(), mapHeader(navigator_.tracker().poseTime())));
}

void NavigationNode::publishMap(double time_s)
{
  publish_time_s_ = time_s;
  if (!navigator_.takeMapChange())
    return;
  map_publisher_.publish(toMsg(navigator_.map().grid(), mapHeader(time_s)));
  octomap_publisher_.publish(toMsg(navigator_.map().map().toBinary()));
}

void NavigationNode::makeCells(const PathPlanner& planner)
{
  cells_.emplace(places_, config_.cells, planner);
  for (const std::string& line : describeUnreachable(*cells_, places_, navigator_.map().grid()))
    ROS_WARN("%s", line.c_str());
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
    navigator_.map().map().save(config_.map_out);
    response.success = 1;
    response.message = "saved " + config_.map_out.string();
    ROS_INFO("%s", response.message.c_str());
    if (config_.pose_source != PoseSource::kLocalisation)
    {
      // What was never seen is not free for those who will use this map.
      PathPlannerOptions finished = config_.live_map.planner;
      finished.unknown_is_free = false;
      navigator_.reviseMap();
      makeCells(PathPlanner(navigator_.map().grid(), finished));
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
  if (!navigator_.tracker().hasPose() || !navigator_.hasScan())
    status.summary(DiagnosticStatus::WARN, "waiting for odometry and scans");
  else if (!navigator_.tracker().isConfident())
    status.summary(DiagnosticStatus::WARN, "the pose is uncertain");
  else
    status.summary(DiagnosticStatus::OK, toString(servers_->driver().phase()));
  const PoseEstimate estimate =
      navigator_.tracker().hasPose() ? navigator_.tracker().estimate() : PoseEstimate{};
  status.add("position deviation (m)", std::sqrt(estimate.covariance[0] + estimate.covariance[4]));
  status.add("mean distance of hits from the map (m)", estimate.mean_hit_distance_m);
  status.add("scans processed", load_.scans);
  status.add("scans dropped", navigator_.droppedScans());
  status.add("time per scan (ms)", load_.scan_ms);
  status.add("age of a scan when processed (simulated s)", load_.scan_age_s);
  status.add("map leaves", navigator_.map().map().numLeaves());
}

}  // namespace kr3::navigation
