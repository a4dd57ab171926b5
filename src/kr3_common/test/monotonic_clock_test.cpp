#include <gtest/gtest.h>

#include <kr3_common/ros/monotonic_clock.hpp>

namespace kr3
{
namespace
{

class MonotonicClockTest : public testing::Test
{
protected:
  MonotonicClockTest() { ros::Time::init(); }

  [[nodiscard]] double at(double time_s)
  {
    ros::Time::setNow(ros::Time(time_s));
    return clock.now().toSec();
  }

  MonotonicClock clock;
};

TEST_F(MonotonicClockTest, IsRosTimeWhileThatGoesForward)
{
  EXPECT_DOUBLE_EQ(at(3.0), 3.0);
  EXPECT_DOUBLE_EQ(at(3.0), 3.0);
  EXPECT_DOUBLE_EQ(at(10.5), 10.5);
}

TEST_F(MonotonicClockTest, LeavesJumpsBackOut)
{
  EXPECT_DOUBLE_EQ(at(100.0), 100.0);
  EXPECT_DOUBLE_EQ(at(1.0), 100.0);
  EXPECT_DOUBLE_EQ(at(6.0), 105.0);
  EXPECT_DOUBLE_EQ(at(2.0), 105.0);
  EXPECT_DOUBLE_EQ(at(2.5), 105.5);
  EXPECT_DOUBLE_EQ(at(200.0), 303.0);
}

TEST_F(MonotonicClockTest, BeginsWithTheClock)
{
  EXPECT_DOUBLE_EQ(at(0.0), 0.0);
}

}  // namespace
}  // namespace kr3
