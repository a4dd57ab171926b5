#pragma once

#include <cstdint>
#include <random>

#include "kr3_sim_ode/geometry.hpp"

namespace kr3::sim
{

/// Of the base, in its own frame: forwards and counter-clockwise.
struct Velocity
{
  double speed_m_s = 0.0;
  double turn_rate_rad_s = 0.0;
};

/// Of the wheels about their axles, forwards, rad/s.
struct WheelRates
{
  double left = 0.0;
  double right = 0.0;
};

struct OdometryNoise
{
  double radius_stddev =
      0.003;  ///< of each wheel's true radius against the believed one, drawn once, relative
  double track_stddev = 0.005;  ///< of the track, drawn once, relative
  double slip_stddev = 0.05;    ///< of every step's wheel motion, relative
};

/// Dead reckoning from the wheels, with errors that grow as those of a real robot: a constant one
/// per robot and a random one per step. Starts at the origin of frame odom.
class WheelOdometry
{
public:
  WheelOdometry(double wheel_radius_m, double track_m, const OdometryNoise& noise,
                std::uint64_t seed);

  void update(const WheelRates& rates, double period_s);

  [[nodiscard]] const Pose2& pose() const { return pose_; }
  [[nodiscard]] const Velocity& velocity() const { return velocity_; }

private:
  OdometryNoise noise_;
  std::mt19937_64 generator_;
  std::normal_distribution<double> normal_;
  double left_radius_m_;
  double right_radius_m_;
  double track_m_;
  Pose2 pose_;
  Velocity velocity_;
};

}  // namespace kr3::sim
