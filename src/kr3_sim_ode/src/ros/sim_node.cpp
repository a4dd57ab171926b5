#include "sim_node.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <ros/callback_queue.h>
#include <rosgraph_msgs/Clock.h>
#include <std_msgs/Bool.h>

#include <kr3_common/error.hpp>
#include <kr3_common/ros/status.hpp>
#include <kr3_msgs/SimulationState.h>

#include "conversions.hpp"
#include "names.hpp"

namespace kr3::sim
{

namespace
{
constexpr double kStartTime = 1.0;     // s; a stamp of zero means "no time" in ROS
constexpr double kClockPeriod = 0.01;  // s, simulated, as all periods here
constexpr double kOdometryPeriod = 0.02;
constexpr double kScanPeriod = 0.1;
constexpr double kModelsPeriod = 1.0;
constexpr double kStatePeriod = 1.0;          // s, wall
constexpr double kMaxWait = 0.01;             // s, wall
constexpr double kWaitForConsumers = 0.0005;  // s, wall
constexpr double kMaxLag = 0.2;               // s, wall: what is lost beyond it is not caught up
constexpr std::uint32_t kMaxStepsPerRequest = 100000;
}  // namespace

SimNode::SimNode(ros::NodeHandle nh, const SimNodeConfig& config)
  : config_(config)
  , world_(makeWorld(config.scenario))
  , renderer_(config.scenario.building, config.scenario.models, config.camera)
  , image_noise_(config.camera, config.camera_noise, config.scenario.world.seed)
  , window_start_(ros::WallTime::now())
  , nh_(std::move(nh))
  , clock_(nh_.advertise<rosgraph_msgs::Clock>(names::kClock, 10, true))
  , odometry_(nh_.advertise<nav_msgs::Odometry>(names::kOdometry, 50))
  , scan_(nh_.advertise<sensor_msgs::LaserScan>(names::kScan, 10))
  , image_(nh_.advertise<sensor_msgs::Image>(names::kImage, 2))
  , camera_info_(nh_.advertise<sensor_msgs::CameraInfo>(names::kCameraInfo, 2))
  , holding_(nh_.advertise<std_msgs::Bool>(names::kHolding, 1, true))
  , state_(nh_.advertise<kr3_msgs::SimulationState>(names::kState, 5))
  , ground_truth_(nh_, config.octomap)
  , lockstep_(nh_,
              ros::Duration(static_cast<double>(tickSteps()) * config.scenario.world.time_step_s),
              config.lockstep_consumers, config.lockstep_timeout_s, [this] { return now(); })
  , command_(nh_.subscribe(names::kCommand, 100, &SimNode::onCommand, this,
                           ros::TransportHints().tcpNoDelay()))
  , close_(nh_.advertiseService(names::kCloseGripper, &SimNode::onClose, this))
  , open_(nh_.advertiseService(names::kOpenGripper, &SimNode::onOpen, this))
  , pause_(nh_.advertiseService(names::kPause, &SimNode::onPause, this))
  , resume_(nh_.advertiseService(names::kResume, &SimNode::onResume, this))
  , drop_(nh_.advertiseService(names::kDrop, &SimNode::onDrop, this))
  , reset_(nh_.advertiseService(names::kReset, &SimNode::onReset, this))
  , step_(nh_.advertiseService(names::kStep, &SimNode::onStep, this))
  , spawn_(nh_.advertiseService(names::kSpawn, &SimNode::onSpawn, this))
  , delete_(nh_.advertiseService(names::kDelete, &SimNode::onDelete, this))
  , set_pose_(nh_.advertiseService(names::kSetPose, &SimNode::onSetPose, this))
{
  renderer_.setLight(config_.scenario.world.seed);
  diagnostics_.setHardwareID("simulation");
  diagnostics_.add("Simulation", this, &SimNode::diagnose);
  static_transforms_.sendTransform(mountTransforms(now(), config_.scenario.world.robot));
  publishChanges();
}

ros::Time SimNode::now() const
{
  const double step_ns = std::round(config_.scenario.world.time_step_s * 1e9);
  ros::Time time;
  time.fromNSec(static_cast<std::uint64_t>(kStartTime * 1e9) +
                total_steps_ * static_cast<std::uint64_t>(step_ns));
  return time;
}

std::uint64_t SimNode::tickSteps() const
{
  return static_cast<std::uint64_t>(
      std::max(1.0, std::round(kClockPeriod / config_.scenario.world.time_step_s)));
}

bool SimNode::isDue(double period_s) const
{
  const auto period_steps = static_cast<std::uint64_t>(
      std::max(1.0, std::round(period_s / config_.scenario.world.time_step_s)));
  return total_steps_ % period_steps == 0;
}

void SimNode::run()
{
  ros::CallbackQueue& queue = *ros::getGlobalCallbackQueue();
  const double step_s = config_.scenario.world.time_step_s;
  double ahead = 0.0;  // wall seconds by which simulated time leads
  ros::WallTime last = ros::WallTime::now();
  while (ros::ok())
  {
    queue.callAvailable(ros::WallDuration(std::clamp(ahead, 0.0, kMaxWait)));
    const ros::WallTime wall = ros::WallTime::now();
    ahead = std::max(ahead - (wall - last).toSec(), -kMaxLag);
    last = wall;
    if (paused_)
    {
      ahead = kMaxWait;
      lockstep_.advanced();  // nobody can be late meanwhile
    }
    else if (ahead <= 0.0 && !lockstep_.mayAdvance())
    {
      ahead = kWaitForConsumers;
    }
    else if (ahead <= 0.0)
    {
      const std::uint64_t steps = tickSteps() - total_steps_ % tickSteps();
      advance(steps);
      lockstep_.advanced();
      ahead = config_.real_time_factor > 0.0
                  ? ahead + static_cast<double>(steps) * step_s / config_.real_time_factor
                  : 0.0;
    }
    ground_truth_.update(*world_);
    publishWallClockState();
  }
}

void SimNode::advance(std::uint64_t steps)
{
  for (std::uint64_t i = 0; i < steps; ++i)
  {
    if (last_command_ && (now() - *last_command_).toSec() > config_.command_timeout_s)
    {
      world_->setCommand(0.0, 0.0);
      last_command_.reset();
    }
    world_->step();
    ++total_steps_;
    if (published_holding_ != world_->held().has_value())
    {
      publishChanges();  // dropped on the way
    }
    publishDue();
  }
}

void SimNode::publishDue()
{
  if (isDue(kClockPeriod))
  {
    rosgraph_msgs::Clock clock;
    clock.clock = now();
    clock_.publish(clock);
  }
  if (isDue(kOdometryPeriod))
  {
    const Pose T_odom_base = poseOf(world_->odometryPose(), 0.0);
    odometry_.publish(
        toOdometry(now(), names::kOdomFrame, T_odom_base, world_->odometryVelocity()));
    transforms_.sendTransform(
        toTransform(now(), names::kOdomFrame, names::kBaseFrame, T_odom_base));
    ground_truth_.publishMotion(now(), *world_);
  }
  if (isDue(kScanPeriod))
  {
    scan_.publish(toScan(now(), config_.scenario.world.laser, kScanPeriod, world_->scan()));
  }
  if (isDue(1.0 / config_.camera_rate_hz))
  {
    publishCamera();
  }
  if (isDue(kModelsPeriod))
  {
    ground_truth_.publishModels(now(), *world_);
  }
}

void SimNode::publishCamera()
{
  camera_info_.publish(toCameraInfo(now(), config_.camera));
  if (image_.getNumSubscribers() == 0)
  {
    return;
  }
  const Pose T_world_camera = world_->robotPose() * config_.scenario.world.robot.T_base_camera();
  cv::Mat image = renderer_.image(T_world_camera, world_->objects());
  image_noise_.apply(image);
  image_.publish(toImage(now(), image));
}

void SimNode::publishChanges()
{
  ground_truth_.noteChange();
  const bool holding = world_->held().has_value();
  if (published_holding_ != holding)
  {
    std_msgs::Bool msg;
    msg.data = static_cast<std::uint8_t>(holding);
    holding_.publish(msg);
    published_holding_ = holding;
  }
  ground_truth_.publishModels(now(), *world_);
}

void SimNode::publishWallClockState()
{
  const ros::WallTime wall = ros::WallTime::now();
  const double elapsed = (wall - window_start_).toSec();
  if (elapsed < kStatePeriod)
  {
    return;
  }
  achieved_factor_ = static_cast<double>(total_steps_ - window_steps_) *
                     config_.scenario.world.time_step_s / elapsed;
  window_start_ = wall;
  window_steps_ = total_steps_;
  kr3_msgs::SimulationState msg;
  msg.header = makeHeader(now(), names::kWorldFrame);
  msg.paused = static_cast<std::uint8_t>(paused_);
  msg.real_time_factor = achieved_factor_;
  msg.steps = total_steps_;
  msg.robot_contacts = world_->robotContacts();
  state_.publish(msg);
  diagnostics_.force_update();
}

void SimNode::reset()
{
  world_ = makeWorld(config_.scenario);
  image_noise_ = ImageNoise(config_.camera, config_.camera_noise, config_.scenario.world.seed);
  last_command_.reset();
  publishChanges();
  ROS_INFO("reset, seed %lu", static_cast<unsigned long>(config_.scenario.world.seed));
}

void SimNode::onCommand(const ros::MessageEvent<const geometry_msgs::Twist>& event)
{
  lockstep_.noteCommand(event.getPublisherName());
  const geometry_msgs::Twist& command = *event.getConstMessage();
  try
  {
    world_->setCommand(command.linear.x, command.angular.z);
    last_command_ = now();
  }
  catch (const InvalidArgument& e)
  {
    ROS_WARN_THROTTLE(1.0, "ignored a velocity command: %s", e.what());
  }
}

bool SimNode::onClose(kr3_msgs::CloseGripper::Request& /*request*/,
                      kr3_msgs::CloseGripper::Response& response)
{
  return respond(response.status, "close gripper", [&] {
    response.holding = static_cast<std::uint8_t>(world_->closeGripper());
    publishChanges();
  });
}

bool SimNode::onOpen(kr3_msgs::OpenGripper::Request& /*request*/,
                     kr3_msgs::OpenGripper::Response& response)
{
  return respond(response.status, "open gripper", [&] {
    response.released = static_cast<std::uint8_t>(world_->openGripper());
    publishChanges();
  });
}

bool SimNode::onPause(std_srvs::Trigger::Request& /*request*/,
                      std_srvs::Trigger::Response& response)
{
  paused_ = true;
  response.success = 1;
  return true;
}

bool SimNode::onResume(std_srvs::Trigger::Request& /*request*/,
                       std_srvs::Trigger::Response& response)
{
  paused_ = false;
  response.success = 1;
  return true;
}

bool SimNode::onDrop(std_srvs::Trigger::Request& /*request*/, std_srvs::Trigger::Response& response)
{
  kr3_msgs::Status status;
  respond(status, "drop what is held", [&] {
    const std::optional<std::string> dropped = world_->dropHeld();
    if (!dropped)
    {
      throw FailedPrecondition("nothing is held");
    }
    publishChanges();
    response.message = *dropped;
  });
  response.success = static_cast<std::uint8_t>(status.code == kr3_msgs::Status::OK);
  if (response.success == 0)
  {
    response.message = status.message;
  }
  return true;
}

bool SimNode::onReset(std_srvs::Trigger::Request& /*request*/,
                      std_srvs::Trigger::Response& response)
{
  kr3_msgs::Status status;
  respond(status, "reset", [&] { reset(); });
  response.success = static_cast<std::uint8_t>(status.code == kr3_msgs::Status::OK);
  response.message = status.message;
  return true;
}

bool SimNode::onStep(kr3_msgs::StepSimulation::Request& request,
                     kr3_msgs::StepSimulation::Response& response)
{
  return respond(response.status, "step", [&] {
    if (!paused_)
    {
      throw FailedPrecondition("the simulation is not paused");
    }
    if (request.steps == 0 || request.steps > kMaxStepsPerRequest)
    {
      throw InvalidArgument(std::to_string(request.steps) + " steps, expected 1 to " +
                            std::to_string(kMaxStepsPerRequest));
    }
    advance(request.steps);
    response.now = now();
  });
}

bool SimNode::onSpawn(kr3_msgs::SpawnModel::Request& request,
                      kr3_msgs::SpawnModel::Response& response)
{
  return respond(response.status, "spawn '" + request.name + "'", [&] {
    world_->spawn(request.name, request.model, fromMsg(request.pose));
    publishChanges();
  });
}

bool SimNode::onDelete(kr3_msgs::DeleteModel::Request& request,
                       kr3_msgs::DeleteModel::Response& response)
{
  return respond(response.status, "delete '" + request.name + "'", [&] {
    world_->remove(request.name);
    publishChanges();
  });
}

bool SimNode::onSetPose(kr3_msgs::SetModelPose::Request& request,
                        kr3_msgs::SetModelPose::Response& response)
{
  return respond(response.status, "set the pose of '" + request.name + "'", [&] {
    const Pose pose = fromMsg(request.pose);
    if (request.name == "robot")
    {
      world_->setRobotPose({pose.position.x, pose.position.y, yawOf(pose.orientation)});
    }
    else
    {
      world_->setObjectPose(request.name, pose);
    }
    publishChanges();
  });
}

void SimNode::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status)
{
  const bool slow = !paused_ && config_.real_time_factor > 0.0 &&
                    achieved_factor_ < 0.8 * config_.real_time_factor;
  if (slow)
  {
    status.summary(diagnostic_msgs::DiagnosticStatus::WARN, "slower than asked for");
  }
  else
  {
    status.summary(diagnostic_msgs::DiagnosticStatus::OK, paused_ ? "paused" : "running");
  }
  status.add("real-time factor", achieved_factor_);
  status.add("real-time factor asked for", config_.real_time_factor);
  status.add("lockstep waits for", lockstep_.waitingFor());
  status.add("robot contacts", world_->robotContacts());
}

}  // namespace kr3::sim
