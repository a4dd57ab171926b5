#include "robot_body.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace kr3::sim
{

namespace
{
constexpr double kWheelMass = 0.5;      // kg
constexpr double kCasterRadius = 0.04;  // m
constexpr double kCasterX = 0.17;       // m, before and behind the axle
// Casters hang a little above the floor, as sprung ones do: otherwise they, not the wheels, may
// carry the weight, and the wheels slip.
constexpr double kCasterClearance = 0.002;  // m

const std::string kRobotName = "robot";

double approached(double from, double to, double max_change)
{
  return from + std::clamp(to - from, -max_change, max_change);
}
}  // namespace

RobotBody::RobotBody(Physics& physics, const RobotModel& model, const Pose2& start) : model_(model)
{
  dWorldID world = physics.world();
  dMass mass;
  base_.reset(dBodyCreate(world));
  dMassSetBoxTotal(&mass, model.base_mass_kg, model.base_size.x, model.base_size.y,
                   model.base_size.z);
  dBodySetMass(base_.get(), &mass);
  dBodySetPosition(base_.get(), 0.0, 0.0, model.base_center_z_m);
  dBodySetAutoDisableFlag(base_.get(), 0);
  base_geom_.reset(
      dCreateBox(physics.robotSpace(), model.base_size.x, model.base_size.y, model.base_size.z));
  dGeomSetBody(base_geom_.get(), base_.get());
  dGeomSetCategoryBits(base_geom_.get(), kRobotGeom);

  for (std::size_t i = 0; i < 2; ++i)
  {
    const double side = i == 0 ? 1.0 : -1.0;
    GeomHandle& caster = caster_geoms_.at(i);
    caster.reset(dCreateSphere(physics.robotSpace(), kCasterRadius));
    dGeomSetBody(caster.get(), base_.get());
    dGeomSetOffsetPosition(caster.get(), side * kCasterX, 0.0,
                           kCasterRadius + kCasterClearance - model.base_center_z_m);
    dGeomSetCategoryBits(caster.get(), kCasterGeom);

    // Spheres as wheels: one contact point each, so that turning in place does not scrub.
    BodyHandle& wheel = wheels_.at(i);
    wheel.reset(dBodyCreate(world));
    dMassSetSphereTotal(&mass, kWheelMass, model.wheel_radius_m);
    dBodySetMass(wheel.get(), &mass);
    dBodySetPosition(wheel.get(), 0.0, side * model.track_m / 2.0, model.wheel_radius_m);
    dBodySetAutoDisableFlag(wheel.get(), 0);
    GeomHandle& wheel_geom = wheel_geoms_.at(i);
    wheel_geom.reset(dCreateSphere(physics.robotSpace(), model.wheel_radius_m));
    dGeomSetBody(wheel_geom.get(), wheel.get());
    dGeomSetCategoryBits(wheel_geom.get(), kRobotGeom);

    JointHandle& motor = motors_.at(i);
    motor.reset(dJointCreateHinge(world, nullptr));
    dJointAttach(motor.get(), base_.get(), wheel.get());
    dJointSetHingeAnchor(motor.get(), 0.0, side * model.track_m / 2.0, model.wheel_radius_m);
    dJointSetHingeAxis(motor.get(), 0.0, -1.0, 0.0);  // turning forwards is positive
    dJointSetHingeParam(motor.get(), dParamFMax, model.wheel_torque_nm);
  }
  for (dGeomID geom : {base_geom_.get(), caster_geoms_[0].get(), caster_geoms_[1].get(),
                       wheel_geoms_[0].get(), wheel_geoms_[1].get()})
  {
    Physics::nameGeom(geom, kRobotName);
  }
  moveTo(start);
}

void RobotBody::setCommand(double speed_m_s, double turn_rate_rad_s)
{
  command_ = {std::clamp(speed_m_s, -model_.max_speed_m_s, model_.max_speed_m_s),
              std::clamp(turn_rate_rad_s, -model_.max_turn_rate_rad_s, model_.max_turn_rate_rad_s)};
}

void RobotBody::control(double time_step_s)
{
  set_point_.speed_m_s = approached(set_point_.speed_m_s, command_.speed_m_s,
                                    model_.max_acceleration_m_s2 * time_step_s);
  set_point_.turn_rate_rad_s = approached(set_point_.turn_rate_rad_s, command_.turn_rate_rad_s,
                                          model_.max_turn_acceleration_rad_s2 * time_step_s);
  const double difference = set_point_.turn_rate_rad_s * model_.track_m / 2.0;
  dJointSetHingeParam(motors_[0].get(), dParamVel,
                      (set_point_.speed_m_s - difference) / model_.wheel_radius_m);
  dJointSetHingeParam(motors_[1].get(), dParamVel,
                      (set_point_.speed_m_s + difference) / model_.wheel_radius_m);
}

void RobotBody::moveTo(const Pose2& pose)
{
  const Pose T_world_base = kr3::sim::poseOf(pose, 0.0);
  setPose(base_.get(), T_world_base * Pose{{0.0, 0.0, model_.base_center_z_m}, {}});
  for (std::size_t i = 0; i < 2; ++i)
  {
    const double side = i == 0 ? 1.0 : -1.0;
    setPose(wheels_.at(i).get(),
            T_world_base * Pose{{0.0, side * model_.track_m / 2.0, model_.wheel_radius_m}, {}});
  }
  set_point_ = {};
}

Pose RobotBody::T_world_base() const
{
  return kr3::sim::poseOf(base_.get()) * Pose{{0.0, 0.0, -model_.base_center_z_m}, {}};
}

Velocity RobotBody::velocity() const
{
  const dReal* const linear = dBodyGetLinearVel(base_.get());
  const dReal* const angular = dBodyGetAngularVel(base_.get());
  const double yaw = yawOf(T_world_base().orientation);
  return {linear[0] * std::cos(yaw) + linear[1] * std::sin(yaw), angular[2]};
}

WheelRates RobotBody::wheelRates() const
{
  return {dJointGetHingeAngleRate(motors_[0].get()), dJointGetHingeAngleRate(motors_[1].get())};
}

}  // namespace kr3::sim
