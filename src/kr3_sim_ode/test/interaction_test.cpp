// What bodies do to one another: contacts, pushing, dropping, and poses that are refused.
#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_sim_ode/scenario.hpp"

namespace kr3::sim
{

namespace
{
const std::string kData = std::string(KR3_TEST_DIR) + "/data/";

class Interaction : public testing::Test
{
protected:
  Interaction()
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

  static Pose at(double x, double y, double z) { return {{x, y, z}, {}}; }

  static Pose poseOfObject(const World& world, const std::string& name)
  {
    for (const ObjectState& state : world.objects())
    {
      if (state.name == name)
      {
        return state.pose;
      }
    }
    throw NotFound(name);
  }

  /// The contact of two bodies; one with an impulse of 0 when they did not touch.
  static ContactReport between(World& world, const std::string& a, const std::string& b)
  {
    for (const ContactReport& report : world.takeContacts())
    {
      if (report.body_a == a && report.body_b == b)
      {
        return report;
      }
    }
    return {};
  }

  /// A world in which the robot holds the book, at (2, 1.1), facing the table.
  std::unique_ptr<World> holding()
  {
    auto world = makeWorld(scenario);
    world->setObjectPose("book", at(2.0, 0.45, 0.545));
    world->setRobotPose({2.0, 1.1, -M_PI / 2.0});
    EXPECT_TRUE(world->closeGripper());
    return world;
  }

  Scenario scenario;
};
}  // namespace

TEST_F(Interaction, TheImpulseOfAnObjectThatLandsIsItsMomentum)
{
  const auto world = makeWorld(scenario);
  run(*world, 1.0);
  (void)world->takeContacts();
  world->spawn("crate1", "crate", at(6.0, 1.0, 0.15 + 0.2));  // 3 kg, 0.2 m above the floor
  run(*world, 0.19);
  EXPECT_EQ(between(*world, "crate1", "floor").impulse_ns, 0.0) << "it falls for 0.202 s";
  run(*world, 0.02);
  const ContactReport landing = between(*world, "crate1", "floor");
  // m sqrt(2 g h) = 5.94 N s, and the weight during the rest of the period.
  EXPECT_NEAR(landing.impulse_ns, 3.0 * std::sqrt(2.0 * 9.81 * 0.2), 0.8);
  EXPECT_NEAR(std::abs(landing.normal.z), 1.0, 1e-6);
  EXPECT_NEAR(landing.position.z, 0.0, 0.02);
}

TEST_F(Interaction, WhatRestsIsNotReported)
{
  const auto world = makeWorld(scenario);
  run(*world, 2.0);
  (void)world->takeContacts();
  run(*world, 0.5);
  EXPECT_TRUE(world->takeContacts().empty());
}

TEST_F(Interaction, AWallStopsTheRobotAndIsReported)
{
  const auto world = makeWorld(scenario);
  world->setRobotPose({1.0, 2.0, M_PI});
  world->setCommand(0.5, 0.0);
  run(*world, 3.0);
  const ContactReport contact = between(*world, "robot", "wall");
  EXPECT_GT(contact.impulse_ns, 1.0);
  EXPECT_NEAR(contact.normal.x, 1.0, 1e-3) << "from the wall towards the robot";
  EXPECT_NEAR(contact.position.x, 0.05, 0.01);
  EXPECT_NEAR(world->robotVelocity().speed_m_s, 0.0, 0.02);
}

TEST_F(Interaction, TheRobotPushesWhatIsInItsWay)
{
  const auto world = makeWorld(scenario);
  world->spawn("crate1", "crate", at(6.0, 1.0, 0.15));
  world->setRobotPose({5.3, 1.0, 0.0});
  run(*world, 0.5);
  world->setCommand(0.4, 0.0);
  run(*world, 2.0);
  EXPECT_GT(poseOfObject(*world, "crate1").position.x, 6.1);
  EXPECT_GT(between(*world, "crate1", "robot").impulse_ns, 0.0);
  EXPECT_GE(world->robotContacts(), 1U);
}

TEST_F(Interaction, VelocitiesAreTheDerivativesOfThePoses)
{
  const auto world = makeWorld(scenario);
  world->setCommand(0.4, 0.5);
  run(*world, 1.5);
  const Pose before = world->robotPose();
  const BodyTwist twist = world->twists().front();
  run(*world, 0.01);
  const Pose after = world->robotPose();
  ASSERT_EQ(twist.name, "robot");
  EXPECT_NEAR((after.position.x - before.position.x) / 0.01, twist.linear_m_s.x, 0.02);
  EXPECT_NEAR((after.position.y - before.position.y) / 0.01, twist.linear_m_s.y, 0.02);
  EXPECT_NEAR((yawOf(after.orientation) - yawOf(before.orientation)) / 0.01, twist.angular_rad_s.z,
              0.02);
  world->spawn("crate1", "crate", at(6.0, 1.0, 1.0));
  run(*world, 0.2);
  EXPECT_EQ(world->twists().back().name, "crate1");
  EXPECT_NEAR(world->twists().back().linear_m_s.z, -9.81 * 0.2, 0.05);
}

TEST_F(Interaction, DropsWhatItHoldsOnRequest)
{
  const auto world = holding();
  world->setRobotPose({6.0, 2.0, M_PI});
  EXPECT_EQ(world->dropHeld(), "book");
  EXPECT_FALSE(world->held());
  run(*world, 2.0);
  const Vector3 p = poseOfObject(*world, "book").position;
  EXPECT_LT(p.z, 0.2) << "on the floor";
  EXPECT_LT(p.x, 5.8) << "in front of the robot";
  EXPECT_FALSE(world->dropHeld()) << "nothing is held any more";
}

TEST_F(Interaction, DropsOnTheWayAtItsRate)
{
  // Exponential distances: with 0.5 drops a metre a share of exp(-0.5) carries it over 1 m.
  scenario.world.drop_rate_per_m = 0.5;
  int kept = 0;
  constexpr int kTrials = 60;
  for (int i = 0; i < kTrials; ++i)
  {
    scenario.world.seed = static_cast<std::uint64_t>(100 + i);
    const auto world = holding();
    world->setRobotPose({1.0, 2.6, 0.0});
    world->setCommand(0.5, 0.0);
    double travelled = 0.0;
    while (travelled < 1.0 && world->held())
    {
      world->step();
      travelled = world->robotPose().position.x - 1.0;
    }
    kept += world->held() ? 1 : 0;
  }
  // 36.4 expected, standard deviation 3.8.
  EXPECT_GE(kept, 24);
  EXPECT_LE(kept, 49);
}

TEST_F(Interaction, DropsNothingWhileItStands)
{
  scenario.world.drop_rate_per_m = 10.0;
  const auto world = holding();
  run(*world, 3.0);
  EXPECT_EQ(world->held(), "book");
}

TEST_F(Interaction, RefusesPosesInsideOfThings)
{
  const auto world = makeWorld(scenario);
  const auto messageOf = [](const auto& action) -> std::string {
    try
    {
      action();
    }
    catch (const InvalidArgument& e)
    {
      return e.what();
    }
    return "";
  };
  const Pose before = poseOfObject(*world, "cup");
  EXPECT_NE(messageOf([&] {
              world->setObjectPose("cup", at(4.0, 1.0, 0.5));
            }).find("'cup' would be inside of 'wall'"),
            std::string::npos);
  EXPECT_EQ(poseOfObject(*world, "cup").position.x, before.position.x) << "it stays";
  EXPECT_NE(messageOf([&] {
              world->spawn("c", "crate", at(2.0, 0.35, 0.3));
            }).find("inside of 'left_table'"),
            std::string::npos);
  EXPECT_THROW(world->remove("c"), NotFound) << "nothing was spawned";
  EXPECT_NE(
      messageOf([&] { world->spawn("c", "crate", at(6.0, 1.0, -0.1)); }).find("inside of 'floor'"),
      std::string::npos);
  const Vector3 robot = world->robotPose().position;
  EXPECT_NE(messageOf([&] {
              world->setRobotPose({4.0, 0.8, 0.0});
            }).find("the robot would be inside of 'wall'"),
            std::string::npos);
  EXPECT_NE(messageOf([&] {
              world->setRobotPose({-3.0, 0.8, 0.0});
            }).find("outside"),
            std::string::npos);
  EXPECT_EQ(world->robotPose().position.x, robot.x) << "it stays";
  EXPECT_NE(messageOf([&] {
              world->spawn("c", "crate", at(robot.x, robot.y, 0.2));
            }).find("inside of 'robot'"),
            std::string::npos);
}

TEST_F(Interaction, KeepsWhatItHoldsWhenTheNewPoseIsRefused)
{
  const auto world = holding();
  EXPECT_THROW(world->setObjectPose("book", at(4.0, 1.0, 0.5)), InvalidArgument);
  EXPECT_EQ(world->held(), "book");
  world->setCommand(0.0, 1.0);
  run(*world, 1.0);
  EXPECT_GT(poseOfObject(*world, "book").position.z, 0.9);
}

TEST_F(Interaction, FallsWhenItsSupportIsTakenAway)
{
  const auto world = makeWorld(scenario);
  world->spawn("low", "crate", at(6.0, 1.0, 0.15));
  world->spawn("high", "crate", at(6.0, 1.0, 0.452));
  run(*world, 2.0);
  ASSERT_NEAR(poseOfObject(*world, "high").position.z, 0.45, 0.01);
  world->remove("low");
  run(*world, 1.0);
  EXPECT_NEAR(poseOfObject(*world, "high").position.z, 0.15, 0.01);
}

}  // namespace kr3::sim
