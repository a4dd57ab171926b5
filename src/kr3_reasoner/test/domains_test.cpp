// The domains of the repository: each is files only, and each gives the answers its comments
// promise.

#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "kr3_reasoner/reasoner.hpp"
#include "kr3_reasoner/transition_system.hpp"
#include "support.hpp"

namespace kr3::reasoner
{
namespace
{

namespace fs = std::filesystem;

const fs::path kDomains = KR3_DOMAINS_DIR;

Reasoner reasonerOf(const std::string& domain, const std::string& history)
{
  Reasoner reasoner(readDescription(kDomains / domain / "domain.kr3"));
  const std::string text =
      history.find('(') == std::string::npos ? readText(kDomains / domain / history) : history;
  reasoner.setHistory(parseHistory(text, history, reasoner.description()));
  return reasoner;
}

std::vector<std::string> goalsOf(const fs::path& file)
{
  std::istringstream lines(readText(file));
  std::vector<std::string> goals;
  for (std::string line; std::getline(lines, line);)
  {
    if (!line.empty() && line[0] != '%')
    {
      goals.push_back(line);
    }
  }
  return goals;
}

/// The steps of the one plan: actions of a step are separated by '+', steps by ';'.
std::string planOf(const Reasoner& reasoner, const std::string& goal)
{
  const PlanResult result = reasoner.plan(goal);
  if (result.plans.size() != 1)
  {
    return std::to_string(result.plans.size()) + " plans: " + result.reason;
  }
  std::string text;
  for (const auto& step : result.plans[0].steps)
  {
    text += text.empty() ? "" : "; ";
    for (std::size_t i = 0; i < step.size(); ++i)
    {
      text += (i == 0 ? "" : " + ") + step[i];
    }
  }
  return text;
}

TEST(Domains, HaveHistoriesAndGoalsThatFit)
{
  std::size_t num_histories = 0;
  std::size_t num_goals = 0;
  for (const auto& folder : fs::directory_iterator(kDomains))
  {
    const Description description = readDescription(folder.path() / "domain.kr3");
    for (const auto& file : fs::directory_iterator(folder.path()))
    {
      if (file.path().extension() == ".history")
      {
        Reasoner reasoner(description);
        reasoner.setHistory(
            parseHistory(readText(file.path()), file.path().filename(), description));
        EXPECT_TRUE(reasoner.diagnose().consistent) << file.path();
        ++num_histories;
      }
      else if (file.path().filename() == "goals.txt")
      {
        for (const std::string& goal : goalsOf(file.path()))
        {
          EXPECT_NO_THROW(static_cast<void>(parseGoal(goal, description))) << goal;
          ++num_goals;
        }
      }
    }
  }
  EXPECT_GE(num_histories, 8U);
  EXPECT_GE(num_goals, 12U);
}

TEST(Domains, BlocksSolvesSussmansAnomaly)
{
  const Reasoner reasoner = reasonerOf("blocks", "sussman.history");
  EXPECT_EQ(reasoner.entails("on(b) = table", 0), Answer::kTrue);
  EXPECT_EQ(reasoner.entails("above(c, table)", 0), Answer::kTrue);
  const std::string plan = planOf(reasoner, "on(a) = b and on(b) = c");
  EXPECT_TRUE(plan == "put(c, table); put(b, c); put(a, b)" ||
              plan == "put(c, d); put(b, c); put(a, b)")
      << plan;
}

TEST(Domains, BlocksExplainsATowerByAnException)
{
  const Reasoner reasoner = reasonerOf("blocks", "tower.history");
  EXPECT_EQ(reasoner.entails("on(c) = d", 0), Answer::kTrue);
  EXPECT_EQ(reasoner.entails("on(a) = b", 1), Answer::kTrue);
  const Diagnosis diagnosis = reasoner.diagnose();
  EXPECT_EQ(diagnosis.cost, 1);
  EXPECT_EQ(
      diagnosis.in_words,
      std::vector<std::string>{"c is an exception to default t: initially on(c) was not table"});
}

TEST(Domains, HospitalLetsTwoRobotsActAtOnce)
{
  const Reasoner reasoner = reasonerOf("hospital", "start.history");
  EXPECT_EQ(reasoner.entails("supplied(pharmacy, insulin)", 0), Answer::kTrue);
  EXPECT_EQ(reasoner.entails("kept(morphine) = surgery", 0), Answer::kTrue);  // the opiates' habit
  const PlanResult result =
      reasoner.plan("supplied(maternity, antibiotic) and supplied(emergency, insulin)");
  ASSERT_EQ(result.plans.size(), 1U) << result.reason;
  ASSERT_EQ(result.plans[0].steps.size(), 3U);
  for (const auto& step : result.plans[0].steps)
  {
    EXPECT_EQ(step.size(), 2U);
  }
}

TEST(Domains, HospitalBlamesABorrower)
{
  const Diagnosis diagnosis = reasonerOf("hospital", "borrowed.history").diagnose();
  ASSERT_EQ(diagnosis.explanations.size(), 3U);  // to any of the three other wards
  for (const auto& explanation : diagnosis.explanations)
  {
    ASSERT_EQ(explanation.size(), 1U);
    EXPECT_EQ(explanation[0].find("borrow(insulin, "), 0U) << explanation[0];
  }
}

TEST(Domains, CircuitDoesNotFeedARingByItself)
{
  const Reasoner reasoner = reasonerOf("circuit", "start.history");
  EXPECT_EQ(reasoner.entails("connected(north, clinic)", 0), Answer::kTrue);
  EXPECT_EQ(reasoner.entails("-live(clinic)", 0), Answer::kTrue);
  EXPECT_EQ(reasoner.entails("blackout", 0), Answer::kTrue);
  EXPECT_EQ(planOf(reasoner, "live(clinic)"), "switch_on(l1)");
  EXPECT_EQ(planOf(reasoner, "live(south) and -switched_on(l1)"), "switch_on(l2)");
  EXPECT_NE(planOf(reasoner, "live(south) and live(north)"), "switch_on(l1); switch_on(l2)");
}

TEST(Domains, CircuitFindsTheLineThatTripped)
{
  const Reasoner reasoner = reasonerOf("circuit", "surprise.history");
  const Diagnosis diagnosis = reasoner.diagnose();
  ASSERT_EQ(diagnosis.explanations.size(), 1U);
  EXPECT_EQ(diagnosis.explanations[0], std::vector<std::string>{"trip(l1) at 1"});
  EXPECT_EQ(reasoner.entails("live(clinic)", 1), Answer::kTrue);
  EXPECT_EQ(reasoner.entails("-live(clinic)", 2), Answer::kTrue);
}

TEST(Domains, Floor15KnowsHabitsOfClassesAndSubclasses)
{
  const Reasoner reasoner = reasonerOf("floor15", "start.history");
  EXPECT_EQ(reasoner.entails("loc(logic_book) = library", 0), Answer::kTrue);
  EXPECT_EQ(reasoner.entails("loc(atlas) = lounge", 0), Answer::kTrue);
  EXPECT_EQ(reasoner.entails("loc(drill) = workshop", 0), Answer::kTrue);
  EXPECT_EQ(reasoner.entails("loc(camera) = vision_lab", 0), Answer::kTrue);
  EXPECT_EQ(planOf(reasoner, "loc(atlas) = office3"),
            "move(rob1, lounge); grasp(rob1, atlas); move(rob1, office3)");
}

TEST(Domains, Floor15LooksInTheNextUsualRoom)
{
  const Reasoner reasoner = reasonerOf("floor15", "missing_book.history");
  EXPECT_EQ(reasoner.entails("loc(logic_book) = reading_room", 1), Answer::kTrue);
  EXPECT_EQ(reasoner.entails("loc(robotics_book) = library", 1), Answer::kTrue);
  EXPECT_EQ(reasoner.diagnose().in_words.at(0),
            "logic_book is an exception to default b1: initially loc(logic_book) was not library");
}

}  // namespace
}  // namespace kr3::reasoner
