#include "kr3_sim_ode/world.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <kr3_common/error.hpp>

#include "gripper.hpp"
#include "kr3_sim_ode/random.hpp"
#include "object_body.hpp"
#include "physics.hpp"
#include "robot_body.hpp"
#include "world_octomap.hpp"

namespace kr3::sim
{

namespace
{
constexpr double kSettlingTime = 0.5;     // s
constexpr double kMaxPenetration = 0.01;  // m, of what is put somewhere by hand

/// @throws InvalidArgument  not finite, or no rotation
Pose checkedPose(const Pose& pose)
{
  const auto& [p, q] = pose;
  const double norm = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z) || !std::isfinite(norm) ||
      std::abs(norm - 1.0) > 0.01)
  {
    throw InvalidArgument("a pose needs finite coordinates and a unit quaternion");
  }
  return {p, {q.w / norm, q.x / norm, q.y / norm, q.z / norm}};
}
}  // namespace

class World::Impl
{
public:
  Impl(const Building& building, const std::vector<ObjectModel>& models,
       const std::vector<ObjectState>& objects, const Pose2& robot_start, const WorldConfig& config)
    : building_(building)
    , config_(config)
    , models_(models)
    , physics_(building, config.seed, config.time_step_s)
    , robot_(physics_, config.robot, robot_start)
    , odometry_(config.robot.wheel_radius_m, config.robot.track_m, config.odometry, config.seed)
    , gripper_(building, physics_, robot_, config.robot, config.grasp_failure_rate, config.seed)
    , laser_generator_(makeGenerator(config.seed, Stream::kLaser))
    , drop_generator_(makeGenerator(config.seed, Stream::kDrop))
  {
    for (const ObjectState& object : objects)
    {
      spawn(object.name, object.model, object.pose);
    }
    drawDrop();
    const auto settling_steps = static_cast<int>(kSettlingTime / config.time_step_s);
    for (int i = 0; i < settling_steps; ++i)
    {
      robot_.control(config_.time_step_s);
      physics_.step();
    }
    settled_steps_ = physics_.steps();
  }

  void step()
  {
    robot_.control(config_.time_step_s);
    physics_.step();
    odometry_.update(robot_.wheelRates(), config_.time_step_s);
    if (gripper_.held() != nullptr && config_.drop_rate_per_m > 0.0)
    {
      carried_m_ += std::abs(robot_.velocity().speed_m_s) * config_.time_step_s;
      if (carried_m_ >= drop_after_m_ && gripper_.drop(bodies_))
      {
        drawDrop();
      }
    }
  }

  /// Decides after how many metres of carrying the next drop comes.
  void drawDrop()
  {
    carried_m_ = 0.0;
    drop_after_m_ = std::exponential_distribution<double>(std::max(config_.drop_rate_per_m, 1e-9))(
        drop_generator_);
  }

  std::vector<double> scan()
  {
    const LaserModel& laser = config_.laser;
    const Pose T_world_base = robot_.T_world_base();
    const Pose T_world_laser = T_world_base * config_.robot.T_base_laser;
    const double yaw = yawOf(T_world_laser.orientation);
    std::normal_distribution<double> noise(0.0, laser.noise_stddev_m);
    std::vector<double> ranges;
    ranges.reserve(static_cast<std::size_t>(laser.num_beams));
    for (int i = 0; i < laser.num_beams; ++i)
    {
      const double angle = yaw - M_PI + i * 2.0 * M_PI / laser.num_beams;
      const double distance = physics_.castRay(
          T_world_laser.position, {std::cos(angle), std::sin(angle), 0.0}, laser.max_range_m, true);
      const double measured =
          laser.noise_stddev_m > 0.0 ? distance + noise(laser_generator_) : distance;
      const bool dropped = uniform(laser_generator_, 0.0, 1.0) < laser.dropout_rate;
      const bool returned = distance < laser.max_range_m && measured >= laser.min_range_m &&
                            measured <= laser.max_range_m && !dropped;
      ranges.push_back(returned ? measured : std::numeric_limits<double>::infinity());
    }
    return ranges;
  }

  void spawn(const std::string& name, const std::string& model, const Pose& pose)
  {
    if (name.empty() || name == "robot" || find(name) != bodies_.end())
    {
      throw InvalidArgument("the object name '" + name + "' is taken or not allowed");
    }
    auto body =
        std::make_unique<ObjectBody>(physics_, name, findModel(models_, model), checkedPose(pose));
    requireRoom(*body);
    bodies_.push_back(std::move(body));
  }

  /// @throws InvalidArgument  the object is inside of something
  void requireRoom(const ObjectBody& body) const
  {
    const std::string other = physics_.penetrated(body.geom(), kMaxPenetration, body.body(), true);
    if (!other.empty())
    {
      throw InvalidArgument("'" + body.name() + "' would be inside of '" + other + "'");
    }
  }

  void remove(const std::string& name)
  {
    const auto body = existing(name);
    gripper_.release(**body);
    bodies_.erase(body);
    wakeObjects();
  }

  void setObjectPose(const std::string& name, const Pose& pose)
  {
    const Pose checked = checkedPose(pose);
    const auto body = existing(name);
    const Pose before = (*body)->pose();
    (*body)->moveTo(checked);
    try
    {
      requireRoom(**body);
    }
    catch (const InvalidArgument&)
    {
      (*body)->moveTo(before);
      gripper_.follow();
      throw;
    }
    gripper_.release(**body);
    wakeObjects();
  }

  bool closeGripper()
  {
    const bool holds = gripper_.close(bodies_);
    wakeObjects();
    return holds;
  }

  /// What lay on something that was taken away must fall.
  void wakeObjects()
  {
    for (const auto& body : bodies_)
    {
      dBodyEnable(body->body());
    }
  }

  void setRobotPose(const Pose2& pose)
  {
    (void)checkedPose(poseOf(pose, 0.0));
    const Rectangle all = building_.extent();
    if (!all.contains(pose.x, pose.y))
    {
      throw InvalidArgument("the robot would be outside of the building");
    }
    // A box around the base, above the floor on which the wheels stand.
    const Vector3& size = config_.robot.base_size;
    const GeomHandle probe(dCreateBox(nullptr, size.x, size.y, size.z));
    const Pose at = poseOf(pose, config_.robot.base_center_z_m);
    const dQuaternion q = {at.orientation.w, at.orientation.x, at.orientation.y, at.orientation.z};
    dGeomSetPosition(probe.get(), at.position.x, at.position.y, at.position.z);
    dGeomSetQuaternion(probe.get(), q);
    const ObjectBody* const held = gripper_.held();
    const std::string other = physics_.penetrated(probe.get(), kMaxPenetration,
                                                  held == nullptr ? nullptr : held->body(), false);
    if (!other.empty())
    {
      throw InvalidArgument("the robot would be inside of '" + other + "'");
    }
    robot_.moveTo(pose);
    gripper_.follow();
  }

  std::vector<BodyTwist> twists() const
  {
    const auto vector = [](const dReal* v) { return Vector3{v[0], v[1], v[2]}; };
    const auto twistOf = [&](const std::string& name, dBodyID body) {
      return BodyTwist{name, vector(dBodyGetLinearVel(body)), vector(dBodyGetAngularVel(body))};
    };
    std::vector<BodyTwist> result{twistOf("robot", robot_.base())};
    for (const auto& body : bodies_)
    {
      result.push_back(twistOf(body->name(), body->body()));
    }
    return result;
  }

  std::vector<ObjectState> objects() const
  {
    std::vector<ObjectState> states;
    for (const auto& body : bodies_)
    {
      states.push_back({body->name(), body->model().name, body->pose()});
    }
    return states;
  }

  Building building_;
  WorldConfig config_;
  std::vector<ObjectModel> models_;
  Physics physics_;
  RobotBody robot_;
  WheelOdometry odometry_;
  std::vector<std::unique_ptr<ObjectBody>> bodies_;  // by address: the gripper refers to one
  Gripper gripper_;
  std::uint64_t settled_steps_ = 0;

private:
  using Bodies = std::vector<std::unique_ptr<ObjectBody>>;

  Bodies::iterator find(const std::string& name)
  {
    return std::find_if(bodies_.begin(), bodies_.end(),
                        [&](const auto& body) { return body->name() == name; });
  }

  Bodies::iterator existing(const std::string& name)
  {
    const auto body = find(name);
    if (body == bodies_.end())
    {
      throw NotFound("there is no object '" + name + "'");
    }
    return body;
  }

  std::mt19937_64 laser_generator_;
  std::mt19937_64 drop_generator_;
  double carried_m_ = 0.0;
  double drop_after_m_ = 0.0;
};

World::World(const Building& building, const std::vector<ObjectModel>& models,
             const std::vector<ObjectState>& objects, const Pose2& robot_start,
             const WorldConfig& config)
  : impl_(std::make_unique<Impl>(building, models, objects, robot_start, config))
{
}

World::~World() = default;

void World::step()
{
  impl_->step();
}

std::uint64_t World::steps() const
{
  return impl_->physics_.steps() - impl_->settled_steps_;
}

void World::setCommand(double speed_m_s, double turn_rate_rad_s)
{
  if (!std::isfinite(speed_m_s) || !std::isfinite(turn_rate_rad_s))
  {
    throw InvalidArgument("a velocity command must be finite");
  }
  impl_->robot_.setCommand(speed_m_s, turn_rate_rad_s);
}

Pose World::robotPose() const
{
  return impl_->robot_.T_world_base();
}

Velocity World::robotVelocity() const
{
  return impl_->robot_.velocity();
}

Pose2 World::odometryPose() const
{
  return impl_->odometry_.pose();
}

Velocity World::odometryVelocity() const
{
  return impl_->odometry_.velocity();
}

std::uint32_t World::robotContacts() const
{
  return impl_->physics_.robotContacts();
}

std::vector<ContactReport> World::takeContacts()
{
  return impl_->physics_.takeContacts();
}

std::vector<BodyTwist> World::twists() const
{
  return impl_->twists();
}

std::vector<double> World::scan()
{
  return impl_->scan();
}

std::vector<ObjectState> World::objects() const
{
  return impl_->objects();
}

std::optional<std::string> World::held() const
{
  const ObjectBody* const body = impl_->gripper_.held();
  return body == nullptr ? std::nullopt : std::make_optional(body->name());
}

std::vector<std::uint8_t> World::octomap(const OctomapOptions& options) const
{
  const ObjectBody* const held = impl_->gripper_.held();
  return octomapOf(impl_->building_, impl_->physics_, held == nullptr ? nullptr : held->body(),
                   options);
}

bool World::closeGripper()
{
  return impl_->closeGripper();
}

bool World::openGripper()
{
  return impl_->gripper_.open(impl_->bodies_);
}

std::optional<std::string> World::dropHeld()
{
  const std::optional<std::string> name = held();
  if (name && !impl_->gripper_.drop(impl_->bodies_))
  {
    throw FailedPrecondition("no free room in front for '" + *name + "' to fall on");
  }
  return name;
}

void World::spawn(const std::string& name, const std::string& model, const Pose& pose)
{
  impl_->spawn(name, model, pose);
}

void World::remove(const std::string& name)
{
  impl_->remove(name);
}

void World::setObjectPose(const std::string& name, const Pose& pose)
{
  impl_->setObjectPose(name, pose);
}

void World::setRobotPose(const Pose2& pose)
{
  impl_->setRobotPose(pose);
}

}  // namespace kr3::sim
