// What methods earn, against what is known to be possible.

#include "kr3_executive/method_values.hpp"

#include <cmath>
#include <cstdlib>
#include <optional>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_executive/work_rates.hpp"

namespace kr3::executive
{
namespace
{

std::string floorOf(const std::string& name, const std::string& options)
{
  const std::string directory = testing::TempDir() + "/method_values_test_" + name;
  const std::string command = std::string("/usr/bin/python3 ") + KR3_DOMAINS_DIR +
                              "/../scripts/make_floor.py " + directory + " " + options;
  if (std::system(command.c_str()) != 0)
    throw Unavailable("'" + command + "' failed");
  return directory;
}

ValueOptions optionsFor(std::uint64_t trials)
{
  ValueOptions options;
  options.trials = trials;
  options.reference = {0.05, 0.0, 2000};
  options.mission.driver.budget = {0.5, 0.0, 400};
  options.mission.baseline.budget = {0.5, 0.0, 2000};
  options.mission.baseline.option_samples = 40;
  return options;
}

// Two rooms of a cell, 2 m apart, no noise; the robot begins in r1, the book is to be in r2. Half
// the time it is there: looking in r1 takes 2 s and shows it. Else it is grasped (4 s), carried
// (1 + 2 * 2 s) and put down (3 s). With discount .98:
// .5 (-2 + .98 * 100) + .5 (-2 - .98 * 4 - .98^2 * 5 - .98^3 * 3 + .98^4 * 100) = 87.9.
TEST(MethodValues, AreThoseOfTheKnownOptimumWithoutNoise)
{
  const std::string floor = floorOf("exact", "--rooms 2 --cells 1 --layout line --exact");
  const ValueTable table =
      methodValues(floor, {Method::kPomdp1, Method::kHierarchical}, optionsFor(60));
  double d = 1.0;
  double carried = 0.0;
  for (const double reward : {-2.0, -4.0, -5.0, -3.0, 100.0})
  {
    carried += d * reward;
    d *= 0.98;
  }
  const double known = 0.5 * (-2.0 + 0.98 * 100.0) + 0.5 * carried;
  EXPECT_LE(table.lower, known + 1e-6);
  EXPECT_GE(table.upper, known - 1e-6);
  EXPECT_NEAR(table.lower, known, 0.06);
  for (const MethodValue& method : table.methods)
  {
    EXPECT_EQ(method.wrong + method.silent, 0U) << method.name;
    EXPECT_TRUE(isNearBest(table, method)) << method.name;
    for (const double value : method.discounted)
      EXPECT_TRUE(std::abs(value - 96.0) < 1e-6 || std::abs(value - carried) < 1e-6) << value;
  }
}

TEST(MethodValues, NoMethodEarnsMoreThanTheUpperBound)
{
  const ValueTable table =
      methodValues(floorOf("noisy", "--rooms 2 --cells 2"), allMethods(), optionsFor(40));
  ASSERT_EQ(table.methods.size(), allMethods().size() + 1);
  for (const MethodValue& method : table.methods)
    EXPECT_LE(meanOf(method.discounted).low, table.upper) << method.name;
  std::ostringstream text;
  print(text, table);
  for (const Method method : allMethods())
    EXPECT_NE(text.str().find(std::string("\n") + toString(method) + " "), std::string::npos);
  std::ostringstream courses;
  printDifferences(courses, table, 1);
  EXPECT_EQ(courses.str().rfind("trial ", 0), 0U);
  EXPECT_NE(courses.str().find("declared"), std::string::npos);
  EXPECT_EQ(courses.str().find("\ntrial "), std::string::npos);
}

// With noise: rooms of one cell, where all is decided above, and of two, where the order of cells
// depends on which room is next.
TEST(MethodValues, TheHierarchyIsNearTheBestOnSmallFloors)
{
  for (const char* const options :
       {"--rooms 2 --cells 1 --defaults 0", "--rooms 3 --cells 2 --layout line --defaults 0"})
  {
    ValueOptions limits = optionsFor(150);
    limits.first_seed = 501;
    limits.mission.driver.budget.max_backups = 3000;
    const ValueTable table =
        methodValues(floorOf("near", options), {Method::kHierarchical}, limits);
    EXPECT_TRUE(isNearBest(table, table.methods.back()))
        << options << ": " << meanOf(table.methods.back().discounted).value << " of "
        << meanOf(table.methods.front().discounted).value;
  }
}

/// What the upper level holds the start for worth.
class UpperLevelValue : public MissionObserver
{
public:
  void onEvent(const ReportedEvent& event) override
  {
    const std::string& text = event.narration.text;
    const auto at = text.find("value in [");
    if (event.kind == EventKind::kPolicy && at != std::string::npos)
      lower = std::stod(text.substr(at + std::string("value in [").size()));
  }
  void onBelief(const ReportedBelief& /*belief*/) override {}
  void onSnapshot(const Snapshot& /*snapshot*/) override {}
  std::optional<double> lower;
};

// Its policies are policies of the whole domain: it can promise no more than the best of these.
// What it promises is made of simulated runs, so a little more is let pass.
TEST(MethodValues, TheUpperLevelPromisesNoMoreThanTheFlatModelAllows)
{
  for (const char* const options :
       {"--rooms 2 --cells 1 --defaults 0", "--rooms 2 --cells 2 --defaults 0",
        "--rooms 3 --cells 2 --defaults 0", "--rooms 2 --cells 4 --defaults 0"})
  {
    const std::string floor = floorOf("promise", options);
    ValueOptions limits = optionsFor(1);
    limits.mission.method = Method::kHierarchical;
    const ValueTable table = methodValues(floor, {}, limits);
    AbstractMissions missions(floor, limits.mission);
    UpperLevelValue promised;
    static_cast<void>(missions.run(missions.scenario().goal, {}, 1, promised));
    ASSERT_TRUE(promised.lower) << options;
    EXPECT_LE(*promised.lower, table.upper + 0.02 * 200.0) << options;
    EXPECT_GE(*promised.lower, table.lower - 0.05 * 200.0) << options;
  }
}

// The solver of the flat model begins with a policy that searches: with next to no work it does not
// give up at once (which earned -203 here), and it earns no less than its bound says.
TEST(MethodValues, LittleWorkSearchesToo)
{
  ValueOptions options = optionsFor(60);
  options.reference.max_backups = 5;
  const ValueTable table =
      methodValues(floorOf("little", "--rooms 4 --cells 4 --defaults 0"), {}, options);
  const MethodValue& reference = table.methods.front();
  EXPECT_GT(table.lower, 0.0);
  EXPECT_GT(meanOf(reference.discounted).value, 50.0);
  EXPECT_GE(meanOf(reference.discounted).high, table.lower);
  EXPECT_EQ(reference.silent, 0U);
}

// A belief that the goal holds by default is no reason to declare it.
TEST(MethodValues, BiasedByDefaultsTheGoalIsMadeSureOf)
{
  ValueOptions options = optionsFor(100);
  options.mission.baseline.default_probability = 0.95;
  const ValueTable table =
      methodValues(floorOf("default", "--rooms 2 --cells 1 --layout line --defaults 1 --exact"),
                   {Method::kPomdp2}, options);
  EXPECT_EQ(table.methods.back().wrong, 0U);
}

TEST(MethodValues, RefuseUnequalNumbersOfTrials)
{
  EXPECT_THROW(static_cast<void>(pairedDifference({1.0}, {1.0, 2.0})), InvalidArgument);
}

TEST(WorkRates, MoreSecondsAreWorthMore)
{
  WorkRateOptions options;
  options.cpu_s = {0.05, 0.1};
  options.missions = 2;
  const WorkRates rates = workRates(floorOf("rates", "--rooms 3 --cells 3 --defaults 0"), options);
  ASSERT_EQ(rates.backups.size(), 2U);
  ASSERT_EQ(rates.prospects.size(), 2U);
  EXPECT_GT(rates.backups[0], 0U);
  EXPECT_LT(rates.backups[0], rates.backups[1]);
  EXPECT_NEAR(static_cast<double>(rates.prospects[1]),
              2.0 * static_cast<double>(rates.prospects[0]), 2.0);
  EXPECT_GT(rates.most_used, 0U);
  EXPECT_GE(rates.decisions, 1.0);
  std::ostringstream line;
  print(line, rates);
  EXPECT_NE(line.str().find("\"most_used\""), std::string::npos);
  // Too large to be solved ahead: online alone.
  options.mission.baseline.max_rows = 10;
  EXPECT_TRUE(
      workRates(floorOf("rates", "--rooms 3 --cells 3 --defaults 0"), options).backups.empty());
  options.cpu_s = {2.0, 1.0};
  EXPECT_THROW(static_cast<void>(workRates("nowhere", options)), InvalidArgument);
}

}  // namespace
}  // namespace kr3::executive
