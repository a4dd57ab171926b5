#include "kr3_navigation/slip_detector.hpp"

#include <gtest/gtest.h>

#include "synthetic_world.hpp"

namespace kr3::navigation
{
namespace
{

constexpr double kStep = 0.05;  // m between two scans

class SlipDetectorTest : public ::testing::Test
{
protected:
  /// Alarms on `count` scans while odometry goes straight on from `start`, and the robot does when
  /// `moves`.
  int alarms(const SyntheticWorld& world, const Pose& start, int count, bool moves)
  {
    SlipDetector detector;
    Pose truth = start;
    Pose odometry;
    int num_alarms = 0;
    for (int i = 0; i < count; ++i)
    {
      const std::optional<Slip> slip = detector.add(world.scan(truth, random_), Pose{}, odometry);
      if (slip)
      {
        ++num_alarms;
        EXPECT_NEAR(slip->told.x, 0.2, kStep);
        EXPECT_NEAR(slip->told.y, 0.0, 1e-9);
        EXPECT_LT(distance(slip->seen.position(), {}), 0.06);
        EXPECT_NEAR(slip->seen.yaw, 0.0, 0.02);
      }
      odometry = odometry * Pose{1.03 * kStep, 0.0, 0.0};
      if (moves)
        truth = truth * Pose{kStep, 0.0, 0.002};
    }
    return num_alarms;
  }

  std::mt19937_64 random_{1};
  SyntheticWorld rooms_ = SyntheticWorld::twoRooms();
};

TEST_F(SlipDetectorTest, NoticesWheelsThatTurnOnTheSpot)
{
  EXPECT_GE(alarms(rooms_, {2.0, 2.0, 0.0}, 21, false), 3);
  EXPECT_GE(alarms(rooms_, {6.0, 3.0, 2.0}, 21, false), 3);
}

TEST_F(SlipDetectorTest, NoticesThemInACorridorByItsEnds)
{
  const SyntheticWorld corridor{{{-0.1, -0.1, 12.1, 0.0},
                                 {-0.1, 2.0, 12.1, 2.1},
                                 {-0.1, 0.0, 0.0, 2.0},
                                 {12.0, 0.0, 12.1, 2.0}}};
  EXPECT_GE(alarms(corridor, {6.0, 1.0, 0.0}, 21, false), 3);
  EXPECT_EQ(alarms(corridor, {2.0, 1.0, 0.0}, 100, true), 0);
}

TEST_F(SlipDetectorTest, IsSilentWhileTheRobotMoves)
{
  for (const double yaw : {0.0, 0.4, -0.4, 3.1})
  {
    EXPECT_EQ(alarms(rooms_, {2.2, 2.0, yaw}, 30, true), 0) << yaw;
    EXPECT_EQ(alarms(rooms_, {6.0, 2.0, yaw}, 30, true), 0) << yaw;
  }
}

TEST_F(SlipDetectorTest, SeesAPartOfAMotionAndAnotherTurn)
{
  SlipDetector detector;
  const Pose start{2.0, 2.5, 0.3};
  const Pose seen{0.08, -0.04, -0.3};
  EXPECT_FALSE(detector.add(rooms_.scan(start, random_), Pose{}, Pose{}));
  const std::optional<Slip> slip =
      detector.add(rooms_.scan(start * seen, random_), Pose{}, Pose{0.25, 0.0, 0.1});
  ASSERT_TRUE(slip);
  EXPECT_LT(distance(slip->seen.position(), seen.position()), 0.04);
  EXPECT_NEAR(slip->seen.yaw, seen.yaw, 0.02);
}

TEST_F(SlipDetectorTest, SaysNothingWhereNothingIsSeen)
{
  EXPECT_EQ(alarms(SyntheticWorld{}, {0.0, 0.0, 0.0}, 30, false), 0);
}

TEST_F(SlipDetectorTest, ForgetsTheEarlierScan)
{
  SlipDetector detector;
  const LaserScan scan = rooms_.scan({2.0, 2.0, 0.0}, random_);
  EXPECT_FALSE(detector.add(scan, Pose{}, Pose{}));
  detector.reset();
  EXPECT_FALSE(detector.add(scan, Pose{}, Pose{0.3, 0.0, 0.0}));
  EXPECT_TRUE(detector.add(scan, Pose{}, Pose{0.6, 0.0, 0.0}));
}

}  // namespace
}  // namespace kr3::navigation
