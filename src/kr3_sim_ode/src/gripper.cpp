#include "gripper.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <kr3_common/error.hpp>

#include "kr3_sim_ode/random.hpp"

namespace kr3::sim
{

namespace
{
constexpr double kMargin = 0.02;         // m, around what is put down
constexpr double kBaseClearance = 0.05;  // m, between the base and what is put down

/// Whether a circle lies on the box's top, all of it.
bool supports(const Box& box, double x, double y, double radius)
{
  const double dx = x - box.center.x;
  const double dy = y - box.center.y;
  const double local_x = std::cos(box.yaw) * dx + std::sin(box.yaw) * dy;
  const double local_y = -std::sin(box.yaw) * dx + std::cos(box.yaw) * dy;
  return std::abs(local_x) + radius <= box.size.x / 2.0 &&
         std::abs(local_y) + radius <= box.size.y / 2.0;
}
}  // namespace

Gripper::Gripper(const Building& building, Physics& physics, RobotBody& robot,
                 const RobotModel& model, double failure_rate, std::uint64_t seed)
  : walls_(wallsOf(building))
  , physics_(physics)
  , robot_(robot)
  , model_(model)
  , failure_rate_(failure_rate)
  , generator_(makeGenerator(seed, Stream::kGripper))
{
  for (const Furniture& furniture : building.furniture)
  {
    furniture_.push_back(furniture.box());
  }
}

bool Gripper::close(const Bodies& bodies)
{
  if (held_ != nullptr)
  {
    throw FailedPrecondition("the gripper holds something already");
  }
  const bool fails = uniform(generator_, 0.0, 1.0) < failure_rate_;
  ObjectBody* const body = nearestInReach(bodies);
  if (body == nullptr || fails)
  {
    return false;
  }
  held_ = body;
  follow();
  joint_.reset(dJointCreateFixed(physics_.world(), nullptr));
  dJointAttach(joint_.get(), robot_.base(), body->body());
  dJointSetFixed(joint_.get());
  dBodySetAutoDisableFlag(body->body(), 0);
  return true;
}

bool Gripper::open(const Bodies& bodies)
{
  if (held_ == nullptr)
  {
    return false;
  }
  const std::optional<Spot> spot = bestSpot(bodies);
  if (!spot)
  {
    throw FailedPrecondition("no free surface within the gripper's reach");
  }
  ObjectBody& body = *held_;
  release(body);
  const double facing_robot = yawOf(robot_.T_world_base().orientation) + M_PI;
  body.moveTo(poseOf(Pose2{spot->x, spot->y, facing_robot},
                     spot->surface_z + body.model().size.z / 2.0 + 0.001));
  return true;
}

bool Gripper::drop(const Bodies& bodies)
{
  constexpr double kFall = 0.15;  // m
  const std::optional<Spot> spot = bestSpot(bodies);
  if (!spot)
  {
    return false;
  }
  ObjectBody& body = *held_;
  release(body);
  const double yaw = yawOf(robot_.T_world_base().orientation);
  body.moveTo(poseOf(Pose2{spot->x, spot->y, yaw + M_PI},
                     spot->surface_z + body.model().size.z / 2.0 + kFall));
  return true;
}

void Gripper::release(const ObjectBody& body)
{
  if (held_ != &body)
  {
    return;
  }
  joint_.reset();
  dBodySetAutoDisableFlag(held_->body(), 1);
  dBodyEnable(held_->body());
  held_ = nullptr;
}

void Gripper::follow()
{
  if (held_ == nullptr)
  {
    return;
  }
  held_->moveTo(carryPose());
  const dReal* const linear = dBodyGetLinearVel(robot_.base());
  const dReal* const angular = dBodyGetAngularVel(robot_.base());
  dBodySetLinearVel(held_->body(), linear[0], linear[1], linear[2]);
  dBodySetAngularVel(held_->body(), angular[0], angular[1], angular[2]);
}

Pose Gripper::carryPose() const
{
  return robot_.T_world_base() * Pose{model_.carry_position, quaternionFromYawPitch(M_PI, 0.0)};
}

ObjectBody* Gripper::nearestInReach(const Bodies& bodies) const
{
  const Pose T_world_base = robot_.T_world_base();
  const Vector3 grasp_point = (T_world_base * model_.T_base_gripper).position;
  const double yaw = yawOf(T_world_base.orientation);
  ObjectBody* nearest = nullptr;
  double nearest_distance = std::numeric_limits<double>::infinity();
  for (const auto& body : bodies)
  {
    const Vector3 p = body->pose().position;
    const double dx = p.x - T_world_base.position.x;
    const double dy = p.y - T_world_base.position.y;
    const bool in_reach = std::hypot(dx, dy) <= model_.reach_m &&
                          std::abs(wrapped(std::atan2(dy, dx) - yaw)) <= model_.reach_angle_rad;
    const double distance = std::hypot(p.x - grasp_point.x, p.y - grasp_point.y);
    if (in_reach && distance < nearest_distance && isVisible(p))
    {
      nearest = body.get();
      nearest_distance = distance;
    }
  }
  return nearest;
}

bool Gripper::isVisible(const Vector3& point) const
{
  const Vector3 base = robot_.T_world_base().position;
  const double distance = std::hypot(point.x - base.x, point.y - base.y);
  const Vector3 direction{(point.x - base.x) / distance, (point.y - base.y) / distance, 0.0};
  return physics_.castRay({base.x, base.y, point.z}, direction, distance, false) >= distance;
}

std::optional<double> Gripper::surfaceAt(double x, double y, double radius) const
{
  const auto touches = [&](const Box& box) { return planarDistance(box, x, y) < radius + kMargin; };
  if (std::any_of(walls_.begin(), walls_.end(), touches))
  {
    return std::nullopt;
  }
  std::optional<double> surface = 0.0;
  for (const Box& box : furniture_)
  {
    if (!touches(box))
    {
      continue;
    }
    if (!supports(box, x, y, radius) || *surface > 0.0)
    {
      return std::nullopt;  // half on it, or on two pieces at once
    }
    surface = box.center.z + box.size.z / 2.0;
  }
  return surface;
}

std::optional<Gripper::Spot> Gripper::bestSpot(const Bodies& bodies) const
{
  constexpr double kDistanceStep = 0.05;  // m
  constexpr int kNumBearings = 13;
  const ObjectModel& object = held_->model();
  const double radius = object.footprintRadius();
  const Pose T_world_base = robot_.T_world_base();
  const Vector3 grasp_point = (T_world_base * model_.T_base_gripper).position;
  const double yaw = yawOf(T_world_base.orientation);
  const auto isFree = [&](double x, double y) {
    return std::none_of(bodies.begin(), bodies.end(), [&](const auto& other) {
      const Vector3 p = other->pose().position;
      return other.get() != held_ &&
             std::hypot(p.x - x, p.y - y) < radius + other->model().footprintRadius() + kMargin;
    });
  };

  std::optional<Spot> best;
  double best_distance = std::numeric_limits<double>::infinity();
  for (double distance = model_.base_size.x / 2.0 + kBaseClearance + radius;
       distance <= model_.reach_m; distance += kDistanceStep)
  {
    for (int i = 0; i < kNumBearings; ++i)
    {
      const double bearing = yaw + model_.reach_angle_rad * (2.0 * i / (kNumBearings - 1) - 1.0);
      const double x = T_world_base.position.x + distance * std::cos(bearing);
      const double y = T_world_base.position.y + distance * std::sin(bearing);
      const std::optional<double> surface = surfaceAt(x, y, radius);
      if (!surface || !isFree(x, y) || !isVisible({x, y, *surface + object.size.z / 2.0}))
      {
        continue;
      }
      const double from_grasp_point = std::hypot(x - grasp_point.x, y - grasp_point.y);
      const bool higher = !best || *surface > best->surface_z + 1e-9;
      const bool as_high = best && *surface > best->surface_z - 1e-9;
      if (higher || (as_high && from_grasp_point < best_distance))
      {
        best = Spot{x, y, *surface};
        best_distance = from_grasp_point;
      }
    }
  }
  return best;
}

}  // namespace kr3::sim
