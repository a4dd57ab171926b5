#include "kr3_sim_ode/world.hpp"

#include <cmath>
#include <limits>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_sim_ode/scenario.hpp"

namespace kr3::sim
{

namespace
{
const std::string kData = std::string(KR3_TEST_DIR) + "/data/";

class WorldTest : public testing::Test
{
protected:
  WorldTest()
  {
    scenario.building = loadBuilding(kData + "two_rooms.yaml");
    scenario.models = loadObjectModels(kData + "objects.yaml");
    scenario.world.grasp_failure_rate = 0.0;
  }

  static void run(World& world, double seconds)
  {
    const auto steps = static_cast<int>(std::lround(seconds / WorldConfig{}.time_step_s));
    for (int i = 0; i < steps; ++i)
    {
      world.step();
    }
  }

  static ObjectState object(const World& world, const std::string& name)
  {
    for (const ObjectState& state : world.objects())
    {
      if (state.name == name)
      {
        return state;
      }
    }
    throw NotFound(name);
  }

  static Pose at(double x, double y, double z) { return {{x, y, z}, {}}; }

  Scenario scenario;
};
}  // namespace

TEST_F(WorldTest, RepeatsExactlyWithTheSameSeed)
{
  const auto trajectory = [&](std::uint64_t seed) {
    scenario.world.seed = seed;
    const auto world = makeWorld(scenario);
    world->setCommand(0.5, 0.4);
    run(*world, 4.0);  // bumps into things on the way
    const std::vector<double> scan = world->scan();
    std::vector<double> state{world->robotPose().position.x, world->robotPose().position.y,
                              world->odometryPose().x, world->odometryPose().yaw, scan[7]};
    for (const ObjectState& o : world->objects())
    {
      state.insert(state.end(), {o.pose.position.x, o.pose.position.y, o.pose.position.z});
    }
    return state;
  };
  const auto first = trajectory(3);
  EXPECT_EQ(first, trajectory(3));
  EXPECT_NE(first, trajectory(4));
}

TEST_F(WorldTest, IsNotDisturbedByAnotherWorldInTheProcess)
{
  const auto alone = makeWorld(scenario);
  alone->setCommand(0.5, 0.0);
  run(*alone, 1.0);
  const auto together = makeWorld(scenario);
  const auto other = makeWorld(scenario);
  together->setCommand(0.5, 0.0);
  for (int i = 0; i < 500; ++i)
  {
    other->step();
    together->step();
  }
  EXPECT_EQ(alone->robotPose().position.x, together->robotPose().position.x);
}

TEST_F(WorldTest, DrivesStraight)
{
  const auto world = makeWorld(scenario);
  const Pose start = world->robotPose();
  world->setCommand(0.5, 0.0);
  run(*world, 2.0);
  world->setCommand(0.0, 0.0);
  run(*world, 1.5);
  // v t, less the ramp up, plus the ramp down, which are equal.
  EXPECT_NEAR(world->robotPose().position.x - start.position.x, 1.0, 0.02);
  EXPECT_NEAR(world->robotPose().position.y, start.position.y, 0.02);
  EXPECT_NEAR(world->robotVelocity().speed_m_s, 0.0, 1e-3);
  EXPECT_EQ(world->robotContacts(), 0U);
}

TEST_F(WorldTest, TurnsInPlace)
{
  const auto world = makeWorld(scenario);
  const Pose start = world->robotPose();
  world->setCommand(0.0, 1.0);
  run(*world, M_PI / 2.0);
  world->setCommand(0.0, 0.0);
  run(*world, 1.0);
  EXPECT_NEAR(yawOf(world->robotPose().orientation), M_PI / 2.0, 0.05);
  EXPECT_NEAR(world->robotPose().position.x, start.position.x, 0.02);
  EXPECT_NEAR(world->robotPose().position.y, start.position.y, 0.02);
}

TEST_F(WorldTest, LimitsTheSpeedAndRefusesWhatIsNotFinite)
{
  const auto world = makeWorld(scenario);
  world->setCommand(100.0, 0.0);
  run(*world, 1.5);
  EXPECT_NEAR(world->robotVelocity().speed_m_s, scenario.world.robot.max_speed_m_s, 0.02);
  EXPECT_THROW(world->setCommand(std::nan(""), 0.0), InvalidArgument);
  EXPECT_THROW(world->setCommand(0.0, std::numeric_limits<double>::infinity()), InvalidArgument);
}

TEST_F(WorldTest, AWallStopsTheRobotAndCounts)
{
  const auto world = makeWorld(scenario);
  world->setRobotPose({1.0, 2.0, M_PI});
  world->setCommand(0.5, 0.0);
  run(*world, 5.0);
  // The wall's face is at 0.05, the robot's front 0.2 before its centre.
  EXPECT_NEAR(world->robotPose().position.x, 0.25, 0.03);
  EXPECT_GE(world->robotContacts(), 1U);
  EXPECT_LE(world->robotContacts(), 3U) << "one contact, not one per step";
}

TEST_F(WorldTest, OdometryFollowsTheRobotAndDrifts)
{
  const auto world = makeWorld(scenario);
  const double start_x = world->robotPose().position.x;
  world->setCommand(0.4, 0.0);
  run(*world, 3.0);
  const double travelled = world->robotPose().position.x - start_x;
  EXPECT_NEAR(world->odometryPose().x, travelled, 0.05);
  EXPECT_NE(world->odometryPose().x, travelled);
}

TEST_F(WorldTest, LaserMeasuresTheDistanceToWalls)
{
  scenario.world.laser.noise_stddev_m = 0.0;
  scenario.world.laser.dropout_rate = 0.0;
  const auto world = makeWorld(scenario);
  world->setRobotPose({1.0, 3.0, 0.0});
  run(*world, 0.1);
  const std::vector<double> scan = world->scan();
  ASSERT_EQ(scan.size(), 360U);
  EXPECT_NEAR(scan[0], 0.95, 0.01) << "behind: x = 0.05";
  EXPECT_NEAR(scan[270], 0.95, 0.01) << "left: y = 3.95";
  EXPECT_NEAR(scan[180], 2.95, 0.01) << "ahead: x = 3.95";
}

TEST_F(WorldTest, LaserHasNoiseDropoutsAndAMaximum)
{
  scenario.world.laser.max_range_m = 2.0;
  scenario.world.laser.dropout_rate = 0.1;
  const auto world = makeWorld(scenario);
  int infinite = 0;
  for (int i = 0; i < 20; ++i)
  {
    const double behind = world->scan()[0];
    infinite += std::isinf(behind) ? 1 : 0;
    EXPECT_TRUE(std::isinf(behind) || std::abs(behind - 0.95) < 0.06) << behind;
  }
  EXPECT_GE(infinite, 1);
  EXPECT_LE(infinite, 8);
  EXPECT_TRUE(std::isinf(world->scan()[180])) << "2.95 m to the wall, 2 m of range";
}

TEST_F(WorldTest, ObjectsStayWhereTheyWerePut)
{
  const auto world = makeWorld(scenario);
  const Vector3 before = object(*world, "book").pose.position;
  run(*world, 5.0);
  const Vector3 after = object(*world, "book").pose.position;
  EXPECT_NEAR(after.x, before.x, 1e-3);
  EXPECT_NEAR(after.y, before.y, 1e-3);
  EXPECT_NEAR(after.z, 0.40 + 0.14, 5e-3);
}

TEST_F(WorldTest, GraspsWithinReachOnly)
{
  const auto world = makeWorld(scenario);
  world->setObjectPose("book", at(2.0, 0.45, 0.545));
  world->setRobotPose({2.0, 1.35, -M_PI / 2.0});
  run(*world, 0.1);
  EXPECT_FALSE(world->closeGripper()) << "0.9 m away";
  world->setRobotPose({2.0, 1.1, 0.0});
  EXPECT_FALSE(world->closeGripper()) << "beside the robot";
  world->setRobotPose({2.0, 1.1, -M_PI / 2.0});
  EXPECT_TRUE(world->closeGripper());
  EXPECT_EQ(world->held(), "book");
  EXPECT_THROW((void)world->closeGripper(), FailedPrecondition);
}

TEST_F(WorldTest, DoesNotGraspThroughAWall)
{
  const auto world = makeWorld(scenario);
  world->setObjectPose("cup", at(4.25, 0.7, 0.06));
  world->setRobotPose({3.65, 0.7, 0.0});
  run(*world, 0.1);
  EXPECT_FALSE(world->closeGripper());
}

TEST_F(WorldTest, CarriesWhatItHoldsOutOfTheLasersSight)
{
  const auto world = makeWorld(scenario);
  world->setObjectPose("book", at(2.0, 0.45, 0.545));
  world->setRobotPose({2.0, 1.1, -M_PI / 2.0});
  ASSERT_TRUE(world->closeGripper());
  world->setCommand(-0.3, 0.6);
  run(*world, 2.0);
  const Pose robot = world->robotPose();
  const Pose book = object(*world, "book").pose;
  const double offset = scenario.world.robot.carry_position.x;
  const double yaw = yawOf(robot.orientation);
  EXPECT_NEAR(book.position.x, robot.position.x + offset * std::cos(yaw), 0.02);
  EXPECT_NEAR(book.position.y, robot.position.y + offset * std::sin(yaw), 0.02);
  EXPECT_GT(book.position.z, 0.8);
}

TEST_F(WorldTest, WheelsKeepTheirGripUnderALoad)
{
  scenario.world.odometry = {0.0, 0.0, 0.0};
  const auto world = makeWorld(scenario);
  world->setObjectPose("book", at(2.0, 0.45, 0.545));
  world->setRobotPose({2.0, 1.1, -M_PI / 2.0});
  ASSERT_TRUE(world->closeGripper());
  world->setRobotPose({2.0, 2.0, M_PI});
  const double start = yawOf(world->robotPose().orientation) - world->odometryPose().yaw;
  for (int i = 0; i < 3; ++i)
  {
    world->setCommand(0.0, -1.2);
    run(*world, 1.2);
    world->setCommand(0.5, -0.3);  // speeds up while it still turns
    run(*world, 0.6);
    world->setCommand(-0.5, 0.0);
    run(*world, 0.6);
  }
  ASSERT_EQ(world->robotContacts(), 0U) << "the way was meant to be free";
  const double end = yawOf(world->robotPose().orientation) - world->odometryPose().yaw;
  EXPECT_NEAR(wrapped(end - start), 0.0, 0.05);
}

TEST_F(WorldTest, PutsDownOnTheFurnitureInFrontElseOnTheFloor)
{
  const auto world = makeWorld(scenario);
  world->setObjectPose("book", at(2.0, 0.45, 0.545));
  world->setRobotPose({2.0, 1.1, -M_PI / 2.0});
  ASSERT_TRUE(world->closeGripper());
  EXPECT_TRUE(world->openGripper());
  EXPECT_FALSE(world->held());
  run(*world, 2.0);
  EXPECT_NEAR(object(*world, "book").pose.position.z, 0.40 + 0.14, 5e-3) << "on the table";

  ASSERT_TRUE(world->closeGripper());
  world->setRobotPose({6.0, 2.0, 0.0});
  EXPECT_TRUE(world->openGripper());
  run(*world, 2.0);
  const Vector3 p = object(*world, "book").pose.position;
  EXPECT_NEAR(p.z, 0.14, 5e-3) << "on the floor";
  EXPECT_EQ(scenario.building.placeAt(p.x, p.y)->name, "right");
  EXPECT_FALSE(world->openGripper()) << "nothing is held any more";
}

TEST_F(WorldTest, KeepsWhatItHoldsWhenNothingIsFreeInFront)
{
  const auto world = makeWorld(scenario);
  world->setObjectPose("book", at(2.0, 0.45, 0.545));
  world->setRobotPose({2.0, 1.1, -M_PI / 2.0});
  ASSERT_TRUE(world->closeGripper());
  world->setRobotPose({3.7, 0.3, 0.0});  // the wall right ahead
  EXPECT_THROW((void)world->openGripper(), FailedPrecondition);
  EXPECT_EQ(world->held(), "book");
}

TEST_F(WorldTest, GraspsFailAtTheirRate)
{
  scenario.world.grasp_failure_rate = 0.3;
  const auto world = makeWorld(scenario);
  world->setObjectPose("book", at(2.0, 0.45, 0.545));
  world->setRobotPose({2.0, 1.1, -M_PI / 2.0});
  int failures = 0;
  for (int i = 0; i < 200; ++i)
  {
    if (world->closeGripper())
    {
      world->setObjectPose("book", at(2.0, 0.45, 0.545));  // which makes the gripper let go
    }
    else
    {
      ++failures;
    }
  }
  EXPECT_GE(failures, 35);
  EXPECT_LE(failures, 85);
}

TEST_F(WorldTest, SpawnsMovesAndRemovesObjects)
{
  const auto world = makeWorld(scenario);
  world->spawn("crate1", "crate", at(6.0, 1.0, 0.5));
  run(*world, 2.0);
  EXPECT_NEAR(object(*world, "crate1").pose.position.z, 0.15, 5e-3) << "it fell on the floor";
  EXPECT_THROW(world->spawn("crate1", "crate", at(6.0, 3.0, 0.5)), InvalidArgument);
  EXPECT_THROW(world->spawn("x", "sofa", at(6.0, 3.0, 0.5)), NotFound);
  EXPECT_THROW(world->setObjectPose("crate1", {{0, 0, 0}, {0, 0, 0, 0}}), InvalidArgument);
  EXPECT_THROW(world->setObjectPose("nothing", at(0, 0, 0)), NotFound);
  world->remove("crate1");
  EXPECT_THROW(world->remove("crate1"), NotFound);
  run(*world, 0.1);
}

TEST_F(WorldTest, RemovingWhatIsHeldEmptiesTheGripper)
{
  const auto world = makeWorld(scenario);
  world->setObjectPose("book", at(2.0, 0.45, 0.545));
  world->setRobotPose({2.0, 1.1, -M_PI / 2.0});
  ASSERT_TRUE(world->closeGripper());
  world->remove("book");
  EXPECT_FALSE(world->held());
  run(*world, 0.1);
}

TEST_F(WorldTest, StartsAtTheRequestedPose)
{
  scenario.robot_pose = Pose2{2.0, 1.1, 0.5};
  const Vector3 p = makeWorld(scenario)->robotPose().position;
  EXPECT_NEAR(p.x, 2.0, 0.02);
  EXPECT_NEAR(p.y, 1.1, 0.02);
}

TEST_F(WorldTest, StartsInTheRequestedPlace)
{
  scenario.robot_start = "right";
  const auto world = makeWorld(scenario);
  const Vector3 p = world->robotPose().position;
  EXPECT_EQ(scenario.building.placeAt(p.x, p.y)->name, "right");
  scenario.robot_start = "attic";
  EXPECT_THROW((void)makeWorld(scenario), NotFound);
}

}  // namespace kr3::sim
