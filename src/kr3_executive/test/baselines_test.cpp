// The baselines beside the architecture: whole missions in process, on floors of a few rooms.

#include <cstdlib>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_executive/abstract_mission.hpp"
#include "kr3_executive/comparison.hpp"
#include "kr3_executive/method.hpp"

namespace kr3::executive
{
namespace
{

/// Notes the actions, and checks that beliefs are distributions.
class Watcher : public MissionObserver
{
public:
  void onEvent(const ReportedEvent& event) override
  {
    if (event.kind == EventKind::kLowLevelAction)
      actions.push_back(event.narration.text);
  }
  void onBelief(const ReportedBelief& belief) override
  {
    for (const auto& [fluent, values] : belief.fluents)
    {
      double sum = 0.0;
      for (const auto& value : values)
        sum += value.second;
      EXPECT_NEAR(sum, 1.0, 1e-9) << fluent;
    }
  }
  void onSnapshot(const Snapshot& /*snapshot*/) override {}

  std::vector<std::string> actions;
};

/// Counted work only, so that a run repeats exactly.
AbstractMissionConfig configFor(Method method)
{
  AbstractMissionConfig config;
  config.method = method;
  config.driver.budget = {0.5, 0.0, 400};
  config.baseline.budget = {0.5, 0.0, 3000};
  config.baseline.option_samples = 40;
  return config;
}

/// Files of a floor as scripts/make_floor.py writes them.
std::string floorOf(const std::string& name, const std::string& options)
{
  const std::string directory = testing::TempDir() + "/baselines_test_" + name;
  const std::string command = std::string("/usr/bin/python3 ") + KR3_DOMAINS_DIR +
                              "/../scripts/make_floor.py " + directory + " " + options;
  if (std::system(command.c_str()) != 0)
    throw Unavailable("'" + command + "' failed");
  return directory;
}

class Baseline : public testing::TestWithParam<Method>
{
};

// Rooms of one cell in a line, 2 m apart, no noise: where the robot looks is all there is to
// decide.
TEST_P(Baseline, SucceedsWithoutNoiseInAsFewActionsAsPossible)
{
  const std::string floor =
      floorOf("exact", "--rooms 3 --cells 1 --layout line --defaults 0 --exact");
  AbstractMissions missions(floor, configFor(GetParam()));
  const std::string goal = missions.scenario().goal;
  // From r1 to r3: look in r1; if it is not there move, look in r2; grasp, move to r3, put down.
  const struct
  {
    const char* at;
    std::size_t actions;
  } kCases[] = {{"r1", 4}, {"r2", 6}};
  for (const auto& known : kCases)
  {
    Watcher watcher;
    const auto result = missions.run(goal, {std::string("loc(b1) = ") + known.at}, 1, watcher);
    EXPECT_TRUE(result.mission.achieved && result.goal_is_true)
        << known.at << ": " << result.mission.reason;
    const bool costs_time_alone = GetParam() != Method::kPa && GetParam() != Method::kPaStar;
    if (costs_time_alone)
    {
      EXPECT_EQ(watcher.actions.size(), known.actions) << known.at;
    }
  }
}

TEST_P(Baseline, RepeatsExactlyWithItsSeed)
{
  const std::string floor = floorOf("noisy", "--rooms 2 --cells 2");
  std::vector<std::string> runs[2];
  for (auto& run : runs)
  {
    AbstractMissions missions(floor, configFor(GetParam()));
    Watcher watcher;
    static_cast<void>(missions.run(missions.scenario().goal, {"loc(b1) = r1"}, 5, watcher));
    run = watcher.actions;
  }
  EXPECT_EQ(runs[0], runs[1]);
}

TEST_P(Baseline, DoesNothingForAGoalThatHolds)
{
  AbstractMissions missions(floorOf("noisy", "--rooms 2 --cells 2"), configFor(GetParam()));
  Watcher watcher;
  const auto result = missions.run("loc(rob1) = r1", {}, 1, watcher);
  EXPECT_TRUE(result.mission.achieved);
  EXPECT_TRUE(watcher.actions.empty());
}

TEST_P(Baseline, EndsWithAReasonWhereTheGoalIsUnreachable)
{
  AbstractMissions missions(floorOf("two", "--rooms 2 --cells 1 --objects 2"),
                            configFor(GetParam()));
  Watcher watcher;
  const auto result = missions.run("in_hand(rob1, b1) and in_hand(rob1, b2)", {}, 1, watcher);
  EXPECT_FALSE(result.mission.achieved);
  EXPECT_FALSE(result.mission.reason.empty());
}

TEST_P(Baseline, RefusesAnUnknownObject)
{
  AbstractMissions missions(floorOf("noisy", "--rooms 2 --cells 2"), configFor(GetParam()));
  Watcher watcher;
  EXPECT_THROW(static_cast<void>(missions.run("loc(b9) = r1", {}, 1, watcher)), InvalidArgument);
}

TEST_P(Baseline, MendsAnApplianceWithNoOtherCode)
{
  AbstractMissions missions(std::string(KR3_DOMAINS_DIR) + "/workbench", configFor(GetParam()));
  Watcher watcher;
  const auto result = missions.run("resolved(hum)", {"cause(hum) = amplifier"}, 3, watcher);
  EXPECT_TRUE(result.mission.achieved && result.goal_is_true) << result.mission.reason;
}

INSTANTIATE_TEST_SUITE_P(Methods, Baseline, testing::ValuesIn(allMethods()),
                         [](const testing::TestParamInfo<Method>& parameter) {
  return std::string(toString(parameter.param));
});

/// Mean low-level actions over some seeds.
double meanActions(const std::string& floor, Method method, double bias, const std::string& at)
{
  AbstractMissionConfig config = configFor(method);
  config.baseline.default_probability = bias;
  config.baseline.planning = FlatPlanning::kOnline;
  AbstractMissions missions(floor, config);
  double actions = 0.0;
  constexpr int kTrials = 30;
  for (int seed = 1; seed <= kTrials; ++seed)
  {
    Watcher watcher;
    actions += missions.run(missions.scenario().goal, {"loc(b1) = " + at}, seed, watcher)
                   .mission.ll_actions;
  }
  return actions / kTrials;
}

// The default says r2 and nothing else: bias helps when it is right and costs when it is wrong.
TEST(Pomdp2, GainsFromARightDefaultAndLosesByAWrongOne)
{
  const std::string floor = floorOf("biased", "--rooms 4 --cells 2 --layout line --defaults 1");
  const double without_at_default = meanActions(floor, Method::kPomdp1, 0.5, "r2");
  const double with_at_default = meanActions(floor, Method::kPomdp2, 0.95, "r2");
  EXPECT_LT(with_at_default, without_at_default);
  const double without_elsewhere = meanActions(floor, Method::kPomdp1, 0.5, "r1");
  const double with_elsewhere = meanActions(floor, Method::kPomdp2, 0.95, "r1");
  EXPECT_GT(with_elsewhere, without_elsewhere);
}

// What is kept from mission to mission changes no decision.
TEST(OnlinePlanning, DoesNotDependOnEarlierMissions)
{
  const std::string floor = floorOf("kept", "--rooms 4 --cells 4 --defaults 0");
  AbstractMissionConfig config = configFor(Method::kPomdp1);
  config.baseline.planning = FlatPlanning::kOnline;
  AbstractMissions used(floor, config);
  for (const std::uint64_t seed : {1U, 2U, 3U})
  {
    AbstractMissions fresh(floor, config);
    Watcher with;
    Watcher without;
    static_cast<void>(used.run(used.scenario().goal, {"loc(b1) = r3"}, seed, with));
    static_cast<void>(fresh.run(fresh.scenario().goal, {"loc(b1) = r3"}, seed, without));
    EXPECT_EQ(with.actions, without.actions) << seed;
  }
}

// The solved upper level has beliefs for which it has no good plan: robots drove to and fro there.
TEST(Hierarchy, DrivesNoCirclesWhenNothingNewIsLearned)
{
  const std::string floor = floorOf("circles", "--rooms 6 --layout grid");
  AbstractMissionConfig config = configFor(Method::kHierarchical);
  config.driver.budget = {0.5, 0.0, 20000};
  config.baseline.budget = {0.5, 0.0, 20000};
  AbstractMissions missions(floor, config);
  constexpr std::size_t kRooms = 6;
  for (std::uint64_t seed = 5; seed < 13; ++seed)
  {
    Watcher watcher;
    const std::string room = "r" + std::to_string(1 + seed % kRooms);
    const auto trial = missions.run(missions.scenario().goal, {"loc(b1) = " + room}, seed, watcher);
    EXPECT_TRUE(trial.mission.achieved) << seed << ": " << trial.mission.reason;
    std::size_t drives = 0;
    for (const std::string& action : watcher.actions)
    {
      drives = action.rfind("move(", 0) == 0 ? drives + 1 : 0;
      EXPECT_LE(drives, 2 * kRooms) << seed << ": nothing but drives up to " << action;
    }
  }
}

TEST(Methods, AreNamed)
{
  for (const Method method : allMethods())
    EXPECT_EQ(methodNamed(toString(method)), method);
  EXPECT_THROW(static_cast<void>(methodNamed("pomdp3")), InvalidArgument);
}

// Wilson's interval for 8 of 10: (0.490, 0.943).
TEST(Comparison, GivesKnownIntervals)
{
  const Estimate share = shareOf(8, 10);
  EXPECT_NEAR(share.low, 0.490, 5e-4);
  EXPECT_NEAR(share.high, 0.943, 5e-4);
  const Estimate mean = meanOf({1.0, 3.0});  // standard error 1
  EXPECT_DOUBLE_EQ(mean.value, 2.0);
  EXPECT_NEAR(mean.high, 2.0 + 1.96, 1e-3);
}

}  // namespace
}  // namespace kr3::executive
