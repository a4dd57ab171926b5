#pragma once

#include <array>

#include "kr3_sim_ode/odometry.hpp"
#include "kr3_sim_ode/robot.hpp"
#include "physics.hpp"

namespace kr3::sim
{

/// The robot as ODE bodies: a base on two driven wheels and two frictionless casters.
class RobotBody
{
public:
  RobotBody(Physics& physics, const RobotModel& model, const Pose2& start);

  /// The velocity to reach, limited to what the robot can do.
  void setCommand(double speed_m_s, double turn_rate_rad_s);

  /// Moves the motors' set-points towards the command within the acceleration limits. Call before
  /// every step.
  void control(double time_step_s);

  void moveTo(const Pose2& pose);

  [[nodiscard]] dBodyID base() const { return base_.get(); }
  [[nodiscard]] Pose T_world_base() const;
  [[nodiscard]] Velocity velocity() const;
  [[nodiscard]] WheelRates wheelRates() const;

private:
  RobotModel model_;
  BodyHandle base_;
  std::array<BodyHandle, 2> wheels_;  // left, right
  std::array<JointHandle, 2> motors_;
  GeomHandle base_geom_;
  std::array<GeomHandle, 2> caster_geoms_;
  std::array<GeomHandle, 2> wheel_geoms_;
  Velocity command_;
  Velocity set_point_;
};

}  // namespace kr3::sim
