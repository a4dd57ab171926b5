#include "kr3_sim_ode/odometry.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace kr3::sim
{

TEST(WheelOdometry, IntegratesAnArcExactlyWithoutNoise)
{
  WheelOdometry odometry(0.08, 0.32, {0.0, 0.0, 0.0}, 1);
  // A quarter circle of radius 1 m at 0.5 m/s.
  const double turn_rate = 0.5;
  const WheelRates rates{(0.5 - turn_rate * 0.16) / 0.08, (0.5 + turn_rate * 0.16) / 0.08};
  const double duration = M_PI / 2.0 / turn_rate;
  const int steps = 1000;
  for (int i = 0; i < steps; ++i)
  {
    odometry.update(rates, duration / steps);
  }
  EXPECT_NEAR(odometry.pose().x, 1.0, 1e-5);
  EXPECT_NEAR(odometry.pose().y, 1.0, 1e-5);
  EXPECT_NEAR(odometry.pose().yaw, M_PI / 2.0, 1e-9);
  EXPECT_NEAR(odometry.velocity().speed_m_s, 0.5, 1e-12);
}

TEST(WheelOdometry, DriftsMoreWithMoreNoise)
{
  const auto meanDrift = [](double radius_stddev) {
    double sum = 0.0;
    for (std::uint64_t seed = 1; seed <= 50; ++seed)
    {
      WheelOdometry odometry(0.08, 0.32, {radius_stddev, 0.0, 0.0}, seed);
      for (int i = 0; i < 1000; ++i)
      {
        odometry.update({6.25, 6.25}, 0.02);  // 10 m straight ahead
      }
      sum += std::hypot(odometry.pose().x - 10.0, odometry.pose().y);
    }
    return sum / 50.0;
  };
  EXPECT_NEAR(meanDrift(0.0), 0.0, 1e-9);
  EXPECT_GT(meanDrift(0.003), 0.1);
  EXPECT_GT(meanDrift(0.01), 2.0 * meanDrift(0.003));
}

}  // namespace kr3::sim
