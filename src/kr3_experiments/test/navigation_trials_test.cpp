#include <filesystem>

#include <gtest/gtest.h>

#include "trials.hpp"

namespace kr3::experiments
{
namespace
{

const std::filesystem::path kOffice = std::filesystem::path(KR3_DOMAINS_DIR) / "office";

class NavigationTrialsTest : public ::testing::Test
{
protected:
  Site site_ = loadSite(kOffice / "building.yaml", kOffice / "objects.yaml");
  RobotOptions robot_;
  navigation::OccupancyMap map_ = navigation::OccupancyMap::load(kOffice / "map.bt", {});
};

TEST_F(NavigationTrialsTest, ARunIsAPureFunctionOfItsSeed)
{
  DriveTrialOptions options;
  options.moved_furniture = 0.5;
  const DriveTrial first = driveTrial(site_, map_, robot_, options, 0);
  const DriveTrial again = driveTrial(site_, map_, robot_, options, 0);
  EXPECT_TRUE(first.succeeded()) << first.from << " -> " << first.to << ": " << first.report.reason;
  EXPECT_EQ(first.report.time_s, again.report.time_s);
  EXPECT_EQ(first.report.end_error_m, again.report.end_error_m);
  EXPECT_EQ(first.report.errors.sum_m, again.report.errors.sum_m);
  EXPECT_GE(first.report.length_m, 0.9 * first.shortest_m);
  EXPECT_LT(first.report.errors.max_m, 0.25);
}

TEST_F(NavigationTrialsTest, NamesTheShutDoor)
{
  DriveTrialOptions options;
  options.shut_doors = 1.0;
  int closed_in = 0;
  for (int run = 0; run < 6 && closed_in < 2; ++run)
  {
    const DriveTrial trial = driveTrial(site_, map_, robot_, options, run);
    EXPECT_EQ(trial.report.contacts, 0U);
    EXPECT_TRUE(trial.succeeded())
        << trial.from << " -> " << trial.to << ": " << trial.report.reason;
    closed_in += trial.possible ? 0 : 1;
  }
  EXPECT_EQ(closed_in, 2);
}

TEST_F(NavigationTrialsTest, RecoversFromAWrongFirstPose)
{
  DriveTrialOptions options;
  options.initial_error_m = 0.3;
  const DriveTrial trial = driveTrial(site_, map_, robot_, options, 3);
  EXPECT_TRUE(trial.succeeded()) << trial.from << " -> " << trial.to << ": " << trial.report.reason;
  EXPECT_LT(trial.report.end_error_m, 0.15);
}

TEST_F(NavigationTrialsTest, GoesRoundABoxThatIsLowerThanTheLaser)
{
  using namespace navigation;
  const Pose start{10.6, 5.0, M_PI};
  Site today = site_;
  today.building.robot_start = {start.x, start.y, start.yaw};
  sim::Furniture box = today.building.furniture.front();
  box.name = "low_box";
  box.place = "corridor";
  box.size = {0.4, 0.4, 0.15};
  box.pose = {7.5, 4.9, 0.0};
  today.building.furniture.push_back(box);
  ASSERT_LT(box.size.z, robot_.world.robot.T_base_laser.position.z);

  LiveMap map(map_.copy(), true, areaOf(site_.places, 0.2), robot_.live_map);
  const CellMap cells(site_.places, robot_.cells, map.planner());
  const Cell& goal = cells.cells()[*cells.find("corridor_c0")];
  ParticleFilter filter(map.reference(), robot_.filter, 1);
  sim::Scenario scenario;
  scenario.building = today.building;
  scenario.models = today.models;
  SimulatedRobot robot(scenario,
                       Navigator(std::move(map), PoseTracker(std::move(filter), start), {}),
                       robot_.driver, robot_.cells, site_.places, site_.doors);
  robot.wait(0.5);
  const DriveReport report = robot.driveTo(goal, 120.0);
  EXPECT_TRUE(report.arrived) << report.reason;
  EXPECT_GE(report.contacts, 1U) << "it cannot know before";
  EXPECT_LE(report.contacts, 6U);
  EXPECT_LT(report.time_s, 90.0);
  EXPECT_LT(report.errors.max_m, 0.35) << "wheels that slip do not carry localisation away";
  EXPECT_FALSE(robot.navigator().map().planner().isFree(Point{7.5, 4.9})) << "it remembers";
}

}  // namespace
}  // namespace kr3::experiments
