#include "kr3_navigation/driver.hpp"

#include <algorithm>
#include <memory>

#include <gtest/gtest.h>

#include "kr3_navigation/live_map.hpp"
#include "synthetic_world.hpp"

namespace kr3::navigation
{
namespace
{

/// A kinematic robot in a synthetic world whose map is revised like the node's.
class DriveTest : public ::testing::Test
{
protected:
  explicit DriveTest() : map_(OccupancyMapOptions{})
  {
    for (double x = 0.5; x < 7.5; x += 0.1)
    {
      const Pose pose{x, 2.0, 0.3 * x};
      map_.insertScan(world_.scan(pose, random_), pose, 0.3, 8.0);
    }
    revise();
  }

  void revise()
  {
    OccupancyGrid grid = map_.project(0.2, 0.4, kTwoRoomsArea);
    for (const Point& contact : contacts_)
      forEachNear(grid.geometry, contact, LiveMapOptions{}.contact_radius_m, [&](int node) {
        grid.nodes[static_cast<std::size_t>(node)] = Occupancy::kOccupied;
      });
    planner_ = std::make_unique<PathPlanner>(grid, PathPlannerOptions{});
  }

  /// Runs until the driver is done; returns the least distance to any box.
  double run(Driver& driver, double time_limit_s, double appear_s = 1e9,
             const Rectangle& appears = {})
  {
    double clearance = 1e9;
    bool appeared = false;
    const double end = time_ + time_limit_s;
    for (int tick = 0; driver.isActive() && time_ < end; ++tick)
    {
      if (!appeared && time_ >= appear_s)
      {
        world_.boxes.push_back(appears);
        appeared = true;
      }
      if (tick % 2 == 0)
      {
        const LaserScan scan = world_.scan(pose_, random_);
        obstacles_ = hitPoints(scan, Pose{});
        map_.insertScan(scan, pose_, 0.3, 4.0);
      }
      const bool changed = tick % 10 == 0;
      if (changed)
        revise();
      const Velocity velocity = driver.step({time_, pose_, *planner_, obstacles_, changed});
      EXPECT_LE(std::abs(velocity.linear), 0.5 + 1e-9);
      EXPECT_LE(std::abs(velocity.angular), 1.2 + 1e-9);
      move(velocity);
      if (const std::optional<Point> contact = driver.takeContact())
        contacts_.push_back(*contact);
      time_ += kPeriod;
      for (const Rectangle& box : world_.boxes)
        clearance = std::min(clearance, box.distanceTo(pose_.position()));
    }
    return clearance;
  }

  /// Unseen boxes stop the robot.
  void move(const Velocity& velocity)
  {
    constexpr double kFront = 0.2;  // m
    const Pose next = pose_ * Pose{velocity.linear * kPeriod, 0.0, velocity.angular * kPeriod};
    const bool stopped = std::any_of(unseen_.begin(), unseen_.end(), [&](const Rectangle& box) {
      return box.distanceTo(next.position()) < kFront &&
             box.distanceTo(next.position()) < box.distanceTo(pose_.position());
    });
    pose_ = stopped ? Pose{pose_.x, pose_.y, next.yaw} : next;
  }

  static constexpr double kPeriod = 0.05;
  std::vector<Rectangle> unseen_;
  std::vector<Point> contacts_;
  SyntheticWorld world_ = SyntheticWorld::twoRooms();
  std::mt19937_64 random_{1};
  OccupancyMap map_;
  std::unique_ptr<PathPlanner> planner_;
  std::vector<Point> obstacles_;
  Pose pose_{2.0, 3.0, M_PI};
  double time_ = 0.0;
};

TEST_F(DriveTest, ArrivesAtPoseWithinTolerance)
{
  Driver driver{DriverOptions{}};
  driver.start({{6.5, 1.0}, -1.0});
  const double clearance = run(driver, 60.0);
  EXPECT_EQ(driver.phase(), DrivePhase::kArrived) << driver.reason();
  EXPECT_LT(distance(pose_.position(), {6.5, 1.0}), 0.12);
  EXPECT_LT(std::abs(wrapAngle(pose_.yaw + 1.0)), 0.08);
  EXPECT_GT(clearance, 0.24);
  EXPECT_LT(time_, 25.0);
  EXPECT_EQ(driver.progress(), 1.0);
}

TEST_F(DriveTest, GoesAroundAnObstacleThatAppears)
{
  Driver driver{DriverOptions{}};
  driver.start({{6.5, 2.0}, std::nullopt});
  const double clearance = run(driver, 90.0, 7.0, {5.2, 1.7, 5.5, 2.3});
  EXPECT_EQ(driver.phase(), DrivePhase::kArrived) << driver.reason();
  EXPECT_GT(clearance, 0.2);
}

TEST_F(DriveTest, GoesRoundWhatItTouchesWithoutSeeing)
{
  unseen_ = {{5.2, 1.6, 5.5, 2.4}};
  Driver driver{DriverOptions{}};
  driver.start({{6.8, 2.0}, std::nullopt});
  run(driver, 120.0);
  EXPECT_EQ(driver.phase(), DrivePhase::kArrived) << driver.reason();
  ASSERT_GE(contacts_.size(), 1U);
  EXPECT_LE(contacts_.size(), 4U);
  for (const Point& contact : contacts_)
    EXPECT_LT(unseen_[0].distanceTo(contact), 0.25) << contact.x << ", " << contact.y;
}

TEST_F(DriveTest, TouchesNothingWhereTheWayIsFree)
{
  Driver driver{DriverOptions{}};
  driver.start({{6.5, 1.0}, -1.0});
  run(driver, 60.0);
  EXPECT_EQ(driver.phase(), DrivePhase::kArrived) << driver.reason();
  EXPECT_TRUE(contacts_.empty());
}

TEST_F(DriveTest, GivesUpBeforeAnUnseenWallAndSaysWhy)
{
  unseen_ = {{4.8, 0.0, 5.0, 4.0}};
  Driver driver{DriverOptions{}};
  driver.start({{6.8, 2.0}, std::nullopt});
  run(driver, 300.0);
  EXPECT_EQ(driver.phase(), DrivePhase::kUnreachable);
  EXPECT_FALSE(driver.reason().empty());
}

TEST_F(DriveTest, GivesUpWhenTheDoorIsShutAndSaysWhy)
{
  Driver driver{DriverOptions{}};
  driver.start({{6.5, 2.0}, std::nullopt});
  const double clearance = run(driver, 200.0, 1.0, {3.95, 1.5, 4.05, 2.5});
  EXPECT_EQ(driver.phase(), DrivePhase::kUnreachable);
  EXPECT_FALSE(driver.reason().empty());
  EXPECT_GT(clearance, 0.2);
  EXPECT_LT(time_, 60.0);
}

TEST_F(DriveTest, RefusesAGoalOutsideTheMapAtOnce)
{
  Driver driver{DriverOptions{}};
  driver.start({{20.0, 0.8}, std::nullopt});
  const Velocity velocity = driver.step({0.0, pose_, *planner_, obstacles_, false});
  EXPECT_EQ(driver.phase(), DrivePhase::kUnreachable);
  EXPECT_EQ(velocity.linear, 0.0);
  EXPECT_EQ(velocity.angular, 0.0);
}

TEST_F(DriveTest, LooksOnceMoreBeforeItRefusesAGoalInAnObstacle)
{
  Driver driver{DriverOptions{}};
  driver.start({{1.2, 0.8}, std::nullopt});
  (void)driver.step({time_, pose_, *planner_, obstacles_, false});
  EXPECT_EQ(driver.phase(), DrivePhase::kBlocked);
  EXPECT_TRUE(driver.takeFreshMapRequest());
  EXPECT_FALSE(driver.takeFreshMapRequest());
  const Pose start = pose_;
  run(driver, 5.0);
  EXPECT_EQ(driver.phase(), DrivePhase::kUnreachable);
  EXPECT_LT(time_, 1.5);
  EXPECT_EQ(distance(pose_.position(), start.position()), 0.0);
}

TEST_F(DriveTest, ANewGoalReplacesTheOld)
{
  Driver driver{DriverOptions{}};
  driver.start({{6.5, 2.0}, std::nullopt});
  run(driver, 3.0);
  driver.start({{1.0, 3.0}, std::nullopt});
  run(driver, 60.0);
  EXPECT_EQ(driver.phase(), DrivePhase::kArrived);
  EXPECT_LT(distance(pose_.position(), {1.0, 3.0}), 0.12);
}

TEST(FreeDistance, IsMeasuredAlongTheArc)
{
  const std::vector<Point> ahead{{1.0, 0.0}};
  EXPECT_NEAR(freeDistance({0.5, 0.0}, ahead, 0.25, 2.0), 0.75, 0.05);
  EXPECT_NEAR(freeDistance({0.5, 1.0}, ahead, 0.25, 1.0), 1.0, 1e-9);   // turns away to the left
  EXPECT_NEAR(freeDistance({-0.2, 0.0}, ahead, 0.25, 1.0), 1.0, 1e-9);  // backs off
  EXPECT_NEAR(freeDistance({0.0, 1.0}, ahead, 0.25, 1.0), 1.0, 1e-9);
  // Touching at the side does not hold the robot, touching in front does.
  EXPECT_NEAR(freeDistance({0.5, 0.0}, {{-0.05, 0.2}}, 0.25, 1.0), 1.0, 1e-9);
  EXPECT_NEAR(freeDistance({0.5, 0.0}, {{0.2, 0.0}}, 0.25, 1.0), 0.0, 1e-9);
}

TEST(Limited, KeepsSpeedsAndAccelerations)
{
  const MotionLimits limits;
  const Velocity v = limited({2.0, -9.0}, {0.4, 0.0}, 0.05, limits);
  EXPECT_NEAR(v.linear, 0.44, 1e-9);
  EXPECT_NEAR(v.angular, -0.15, 1e-9);
  EXPECT_NEAR(limited({2.0, 0.0}, {0.49, 0.0}, 0.05, limits).linear, 0.5, 1e-9);
}

}  // namespace
}  // namespace kr3::navigation
