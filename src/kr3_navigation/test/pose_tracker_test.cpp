#include "kr3_navigation/pose_tracker.hpp"

#include <gtest/gtest.h>

#include "synthetic_world.hpp"

namespace kr3::navigation
{
namespace
{

const Pose kStart{2.0, 3.0, 0.5};

ParticleFilter twoRoomsFilter()
{
  return {distanceField(SyntheticWorld::twoRooms().grid(kTwoRoomsArea)), ParticleFilterOptions{},
          1};
}

TEST(PoseTracker, HasNoPoseBeforeOdometry)
{
  PoseTracker tracker(twoRoomsFilter(), kStart);
  EXPECT_FALSE(tracker.hasPose());
  EXPECT_FALSE(tracker.isReadyFor(0.0));
  EXPECT_EQ(tracker.addOdometry(1.0, {}), OdometryResult::kTaken);
  ASSERT_TRUE(tracker.hasPose());
  EXPECT_NEAR(tracker.pose().x, kStart.x, 1e-12);
  EXPECT_TRUE(tracker.isReadyFor(1.0));
  EXPECT_FALSE(tracker.isReadyFor(1.01));
}

TEST(PoseTracker, FindsTheRobotWhenItStartsUnderWay)
{
  std::mt19937_64 random(1);
  PoseTracker tracker(twoRoomsFilter(), kStart);
  // The robot is at (6, 2); its odometry, zero at kStart, has drifted by 10 cm and 0.03 rad.
  const Pose truth{6.0, 2.0, -0.4};
  const Pose drifted = inverse(kStart) * Pose{truth.x + 0.08, truth.y - 0.06, truth.yaw + 0.03};
  for (int i = 0; i < 40; ++i)
  {
    const double time = 1.0 + 0.1 * i;
    tracker.addOdometry(time, drifted);
    ASSERT_TRUE(tracker.correct(time, SyntheticWorld::twoRooms().scan(truth, random), Pose{}));
  }
  EXPECT_LT(distance(tracker.pose().position(), truth.position()), 0.05);
  EXPECT_NEAR(tracker.pose().yaw, truth.yaw, 0.03);
  EXPECT_TRUE(tracker.isConfident());
  EXPECT_GT(tracker.probabilityIn({4.0, 0.0, 8.0, 4.0}), 0.99);
}

TEST(PoseTracker, StartsAgainWhenOdometryJumps)
{
  PoseTracker tracker(twoRoomsFilter(), kStart);
  tracker.addOdometry(1.0, {3.0, 0.0, 0.0});
  EXPECT_EQ(tracker.addOdometry(1.02, {0.0, 0.0, 0.0}), OdometryResult::kRestarted);
  EXPECT_NEAR(tracker.pose().x, kStart.x, 1e-12);
  EXPECT_NEAR(tracker.pose().y, kStart.y, 1e-12);
}

TEST(PoseTracker, TakesAnInitialPoseThatComesFirst)
{
  PoseTracker tracker(twoRoomsFilter(), kStart);
  tracker.reset({1.0, 2.0, 0.0}, PoseSpread{});
  EXPECT_FALSE(tracker.hasPose());
  tracker.addOdometry(1.0, {5.0, 5.0, 1.0});
  EXPECT_NEAR(tracker.pose().x, 1.0, 1e-12);
  EXPECT_NEAR(tracker.pose().yaw, 0.0, 1e-12);
}

TEST(PoseTracker, IsSceptical)
{
  std::mt19937_64 random(1);
  PoseTracker tracker(twoRoomsFilter(), kStart);
  tracker.addOdometry(1.0, {});
  // What it sees, four posts around it, is not in the map.
  const SyntheticWorld posts{
      {{2.4, 2.9, 2.6, 3.1}, {1.4, 2.9, 1.6, 3.1}, {1.9, 3.4, 2.1, 3.6}, {1.9, 2.4, 2.1, 2.6}}};
  (void)tracker.correct(1.0, posts.scan(kStart, random), Pose{});
  EXPECT_GT(tracker.estimate().mean_hit_distance_m, 0.3);
  EXPECT_FALSE(tracker.isConfident());
  EXPECT_FALSE(tracker.correct(0.5, SyntheticWorld{}.scan({}, random),
                               Pose{}));  // before all that is remembered
}

TEST(PoseTracker, WithKnownPosesOdometryIsOnlyCarriedOn)
{
  PoseTracker tracker(std::nullopt, Pose{});
  tracker.addOdometry(1.0, {0.5, 0.0, 0.0});
  EXPECT_FALSE(tracker.isReadyFor(1.0));
  tracker.addKnownPose(1.0, {2.0, 2.0, 0.0});
  ASSERT_TRUE(tracker.isReadyFor(1.0));
  ASSERT_TRUE(tracker.correct(1.0, LaserScan{}, Pose{}));
  tracker.addOdometry(1.1, {0.7, 0.0, 0.0});
  EXPECT_NEAR(tracker.pose().x, 2.2, 1e-12);
  EXPECT_EQ(tracker.probabilityIn({2.0, 1.0, 3.0, 3.0}), 1.0);
  EXPECT_EQ(tracker.probabilityIn({3.0, 1.0, 4.0, 3.0}), 0.0);
}

}  // namespace
}  // namespace kr3::navigation
