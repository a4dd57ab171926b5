#include "kr3_navigation/navigator.hpp"

#include <limits>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "synthetic_world.hpp"

namespace kr3::navigation
{
namespace
{

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();
const LaserMount kMount{Pose{}, 0.3};
const Pose kStart{2.0, 3.0, 0.4};
const std::vector<Place> kPlaces{{"left", {0.0, 0.0, 4.0, 4.0}}, {"right", {4.0, 0.0, 8.0, 4.0}}};
const std::vector<Door> kDoors{{"left", "right", {4.0, 2.0}, 1.0}};

LiveMap twoRoomsMap()
{
  OccupancyMap map{OccupancyMapOptions{}};
  const SyntheticWorld world = SyntheticWorld::twoRooms();
  std::mt19937_64 random(1);
  for (int pass = 0; pass < 3; ++pass)
  {
    for (double x = 0.5; x < 7.5; x += 0.1)
    {
      const Pose pose{x, 2.0, 0.3 * x};
      map.insertScan(world.scan(pose, random), pose, 0.3, 8.0);
    }
  }
  return {std::move(map), true, kTwoRoomsArea, LiveMapOptions{}};
}

class NavigatorTest : public ::testing::Test
{
protected:
  NavigatorTest() : navigator_(make()) {}

  static Navigator make()
  {
    LiveMap map = twoRoomsMap();
    ParticleFilter filter(map.reference(), ParticleFilterOptions{}, 1);
    return {std::move(map), PoseTracker(std::move(filter), kStart), NavigatorOptions{}};
  }

  LaserScan scan() { return world_.scan(kStart, random_); }

  /// A standing robot: odometry at 50 Hz and scans at 10 Hz.
  void stand(double from_s, double to_s)
  {
    for (int tick = static_cast<int>(from_s * 50.0); tick < static_cast<int>(to_s * 50.0); ++tick)
    {
      navigator_.addOdometry(tick / 50.0, {});
      if (tick % 5 == 0)
        navigator_.addScan(tick / 50.0, scan(), kMount);
    }
  }

  SyntheticWorld world_ = SyntheticWorld::twoRooms();
  std::mt19937_64 random_{2};
  Navigator navigator_;
};

TEST_F(NavigatorTest, LetsNobodyDriveBeforeAScanAndWhenScansStayAway)
{
  navigator_.addOdometry(1.0, {});
  EXPECT_FALSE(navigator_.driveInput(true));
  stand(1.1, 2.0);
  const std::optional<DriveInput> input = navigator_.driveInput(true);
  ASSERT_TRUE(input);
  EXPECT_GT(input->obstacles_base.size(), 300U);
  EXPECT_LT(distance(input->pose.position(), kStart.position()), 0.08);
  navigator_.addOdometry(3.0, {});
  EXPECT_FALSE(navigator_.driveInput(true));
}

TEST_F(NavigatorTest, RefusesWhatIsNotFinite)
{
  EXPECT_THROW(navigator_.addOdometry(kNan, {}), InvalidArgument);
  EXPECT_THROW(navigator_.addOdometry(1.0, {kNan, 0.0, 0.0}), InvalidArgument);
  EXPECT_THROW(navigator_.addOdometry(1.0, {1e300, 0.0, 0.0}), InvalidArgument);
  EXPECT_THROW(navigator_.addOdometry(1.0, {0.0, 0.0, -1e300}), InvalidArgument);
  EXPECT_THROW(navigator_.addScan(1.0, scan(), {{1e300, 0.0, 0.0}, 0.3}), InvalidArgument);
  EXPECT_THROW(navigator_.addKnownPose(1.0, {0.0, kInf, 0.0}), InvalidArgument);
  EXPECT_THROW(navigator_.addScan(kInf, scan(), kMount), InvalidArgument);
  EXPECT_THROW(navigator_.reset({0.0, 0.0, kNan}, PoseSpread{}), InvalidArgument);
  EXPECT_THROW(navigator_.reset(kStart, {kNan, 0.1}), InvalidArgument);
  EXPECT_THROW(navigator_.reset({1e6, 1e6, 0.0}, PoseSpread{}), InvalidArgument);
  stand(1.0, 2.0);
  EXPECT_TRUE(navigator_.driveInput(false));
}

TEST_F(NavigatorTest, SurvivesScansOfNonsense)
{
  stand(1.0, 2.0);
  const Pose before = navigator_.tracker().pose();
  const std::size_t leaves = navigator_.map().map().numLeaves();
  const auto add = [&](float range) {
    LaserScan broken = scan();
    std::fill(broken.ranges_m.begin(), broken.ranges_m.end(), range);
    navigator_.addScan(1.98, broken, kMount);
    EXPECT_LT(distance(navigator_.tracker().pose().position(), before.position()), 0.05) << range;
  };
  for (const float range : {std::numeric_limits<float>::quiet_NaN(),
                            -std::numeric_limits<float>::infinity(), -1.0F, 0.0F})
    add(range);
  EXPECT_EQ(navigator_.map().map().numLeaves(), leaves);
  // Nothing within range all around is an open space, if a strange one.
  add(std::numeric_limits<float>::infinity());
  add(1e30F);
  EXPECT_TRUE(navigator_.driveInput(true));
}

TEST_F(NavigatorTest, RefusesScansThatAreNoScans)
{
  LaserScan none = scan();
  none.ranges_m.clear();
  EXPECT_THROW(navigator_.addScan(1.0, none, kMount), InvalidArgument);
  LaserScan huge = scan();
  huge.ranges_m.assign(1000000, 1.0F);
  EXPECT_THROW(navigator_.addScan(1.0, huge, kMount), InvalidArgument);
  LaserScan winding = scan();
  winding.angle_increment_rad *= 3.0;
  EXPECT_THROW(navigator_.addScan(1.0, winding, kMount), InvalidArgument);
  LaserScan still = scan();
  still.angle_increment_rad = 0.0;
  EXPECT_THROW(navigator_.addScan(1.0, still, kMount), InvalidArgument);
  LaserScan inverted = scan();
  std::swap(inverted.range_min_m, inverted.range_max_m);
  EXPECT_THROW(navigator_.addScan(1.0, inverted, kMount), InvalidArgument);
}

TEST_F(NavigatorTest, IgnoresLateOdometryAndStartsAgainWhenTheClockDoes)
{
  stand(100.0, 101.0);
  EXPECT_EQ(navigator_.addOdometry(100.5, {}), OdometryResult::kStale);
  EXPECT_NEAR(navigator_.tracker().poseTime(), 100.98, 1e-9);
  EXPECT_EQ(navigator_.addOdometry(2.0, {}), OdometryResult::kRestarted);
  EXPECT_FALSE(navigator_.driveInput(true));
  stand(2.1, 3.0);
  EXPECT_TRUE(navigator_.driveInput(true));
  EXPECT_LT(distance(navigator_.tracker().pose().position(), kStart.position()), 0.08);
}

TEST_F(NavigatorTest, DoesNotFollowWheelsThatSlip)
{
  stand(1.0, 2.0);
  Pose odometry;
  int slips = 0;
  for (int tick = 100; tick < 250; ++tick)  // 1.5 m by the wheels
  {
    odometry = odometry * Pose{0.01, 0.0, 0.0};
    navigator_.addOdometry(tick / 50.0, odometry);
    if (tick % 5 == 0)
      navigator_.addScan(tick / 50.0, scan(), kMount);
    const std::optional<DriveInput> input = navigator_.driveInput(true);
    ASSERT_TRUE(input);
    slips += input->slipped ? 1 : 0;
    EXPECT_LT(distance(input->pose.position(), kStart.position()), 0.35) << tick;
  }
  EXPECT_GE(slips, 4);
  EXPECT_LT(distance(navigator_.tracker().pose().position(), kStart.position()), 0.3);
}

TEST_F(NavigatorTest, DropsScansThatNeverGetTheirOdometry)
{
  stand(1.0, 2.0);
  for (int i = 0; i < 20; ++i)
    navigator_.addScan(50.0 + i, scan(), kMount);
  EXPECT_EQ(navigator_.droppedScans(), 15);
  stand(2.0, 3.0);
  EXPECT_FALSE(navigator_.takeEstimates().empty());
}

TEST_F(NavigatorTest, SameInputsGiveSamePoses)
{
  stand(1.0, 3.0);
  const Pose first = navigator_.tracker().pose();
  navigator_ = make();
  random_.seed(2);
  stand(1.0, 3.0);
  const Pose second = navigator_.tracker().pose();
  EXPECT_EQ(first.x, second.x);
  EXPECT_EQ(first.y, second.y);
  EXPECT_EQ(first.yaw, second.yaw);
}

TEST_F(NavigatorTest, NamesTheDoorThatIsShut)
{
  world_.boxes.push_back({3.95, 1.5, 4.05, 2.5});
  stand(1.0, 4.0);
  const std::string why = navigator_.whyUnreachable({6.0, 3.0}, "no path", kPlaces, kDoors);
  EXPECT_EQ(why, "the door between left and right at (4.00, 2.00) is shut or blocked (no path)");
  EXPECT_NE(navigator_.whyUnreachable({6.0, 3.0}, "no path", kPlaces, {})
                .find("between left and right is blocked"),
            std::string::npos);
}

TEST_F(NavigatorTest, SaysNothingMoreWhenTheWayIsFree)
{
  stand(1.0, 2.0);
  EXPECT_EQ(navigator_.whyUnreachable({6.0, 3.0}, "no path", kPlaces, kDoors), "no path");
  EXPECT_EQ(navigator_.whyUnreachable({60.0, 3.0}, "off the map", kPlaces, kDoors), "off the map");
}

TEST(Navigator, MapsARoomWithItsOwnPoses)
{
  const SyntheticWorld world = SyntheticWorld::twoRooms();
  std::mt19937_64 random(3);
  LiveMapOptions options;
  options.planner.unknown_is_free = true;
  LiveMap map(OccupancyMap(OccupancyMapOptions{}), false, kTwoRoomsArea, options);
  ParticleFilter filter(map.planner().field(), ParticleFilterOptions{}, 1);
  Navigator navigator(std::move(map),
                      PoseTracker(std::move(filter), {1.0, 2.5, 0.0}, {0.005, 0.002}), {});
  // From the left room through the door and back; odometry is 3 % too long.
  Pose truth{1.0, 2.5, 0.0};
  Pose odometry;
  double worst_m = 0.0;
  for (int tick = 0; tick < 50 * 60; ++tick)
  {
    const double turn = 0.25 * std::sin(0.02 * tick);
    const double speed = (tick / 750) % 2 == 0 ? 0.3 : -0.3;
    truth = truth * Pose{speed / 50.0, 0.0, turn / 50.0};
    odometry = odometry * Pose{1.03 * speed / 50.0, 0.0, 1.02 * turn / 50.0};
    navigator.addOdometry(tick / 50.0, odometry);
    if (tick % 5 != 0)
      continue;
    navigator.addScan(tick / 50.0, world.scan(truth, random), kMount);
    worst_m = std::max(worst_m, distance(navigator.tracker().pose().position(), truth.position()));
  }
  EXPECT_LT(worst_m, 0.15);
  EXPECT_GT(navigator.map().map().numLeaves(), 1000U);
}

}  // namespace
}  // namespace kr3::navigation
