#include "kr3_sim_ode/odometry.hpp"

#include <cmath>

#include "kr3_sim_ode/random.hpp"

namespace kr3::sim
{

WheelOdometry::WheelOdometry(double wheel_radius_m, double track_m, const OdometryNoise& noise,
                             std::uint64_t seed)
  : noise_(noise)
  , generator_(makeGenerator(seed, Stream::kOdometry))
  , left_radius_m_(wheel_radius_m * (1.0 + noise.radius_stddev * normal_(generator_)))
  , right_radius_m_(wheel_radius_m * (1.0 + noise.radius_stddev * normal_(generator_)))
  , track_m_(track_m * (1.0 + noise.track_stddev * normal_(generator_)))
{
}

void WheelOdometry::update(const WheelRates& rates, double period_s)
{
  const double left =
      rates.left * left_radius_m_ * (1.0 + noise_.slip_stddev * normal_(generator_));
  const double right =
      rates.right * right_radius_m_ * (1.0 + noise_.slip_stddev * normal_(generator_));
  velocity_ = {(left + right) / 2.0, (right - left) / track_m_};
  const double heading = pose_.yaw + velocity_.turn_rate_rad_s * period_s / 2.0;
  pose_.x += velocity_.speed_m_s * period_s * std::cos(heading);
  pose_.y += velocity_.speed_m_s * period_s * std::sin(heading);
  pose_.yaw = wrapped(pose_.yaw + velocity_.turn_rate_rad_s * period_s);
}

}  // namespace kr3::sim
