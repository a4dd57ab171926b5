#include <atomic>
#include <set>

#include <gtest/gtest.h>

#include "kr3_reasoner/reasoner.hpp"
#include "support.hpp"

namespace kr3::reasoner
{
namespace
{

const char* const kStart =
    "init(loc(rob1) = office, true). init(in_hand(rob1, mug1), false). init(in_hand(rob1, mug2), "
    "false). "
    "init(in_hand(rob1, pot1), false). init(in_hand(rob1, tb1), false). init(in_hand(rob1, tb2), "
    "false). "
    "init(in_hand(rob1, tb3), false). init(in_hand(rob1, printer1), false). "
    "init(in_hand(rob1, printer2), false). ";
const char* const kGoal = "loc(tb1) = study_corner and not in_hand(rob1, tb1)";

Reasoner office(const std::string& history)
{
  Reasoner reasoner(readDescription(std::string(KR3_DOMAINS_DIR) + "/office/domain.kr3"));
  reasoner.setHistory(parseHistory(kStart + history, "history", reasoner.description()));
  return reasoner;
}

std::string text(const Plan& plan)
{
  std::string line;
  for (const std::string& literal : plan.hypothesis)
  {
    line += "[" + literal + "] ";
  }
  for (const auto& step : plan.steps)
  {
    for (const std::string& action : step)
    {
      line += action + "; ";
    }
  }
  return line;
}

TEST(Planner, FetchesTheBookFromWhereTheDefaultPutsIt)
{
  const PlanResult result = office("").plan(kGoal);
  ASSERT_EQ(result.plans.size(), 1U);
  EXPECT_EQ(
      text(result.plans[0]),
      "move(rob1, main_library); grasp(rob1, tb1); move(rob1, study_corner); putdown(rob1, tb1); ");
}

TEST(Planner, GoesWhereTheNextDefaultSaysAfterASurprise)
{
  const PlanResult result =
      office("hpd(move(rob1, main_library), 0). obs(loc(tb1) = main_library, false, 1).")
          .plan(kGoal);
  ASSERT_EQ(result.plans.size(), 1U);
  EXPECT_EQ(
      text(result.plans[0]),
      "move(rob1, aux_library); grasp(rob1, tb1); move(rob1, study_corner); putdown(rob1, tb1); ");
}

TEST(Planner, MakesAPlanForEachPlaceThatIsLeft)
{
  const Reasoner reasoner = office(
      "obs(loc(tb1) = main_library, false, 1). obs(loc(tb1) = aux_library, false, 1). "
      "obs(loc(tb1) = office, false, 1).");
  std::set<std::string> plans;
  for (const Plan& plan : reasoner.plan(kGoal).plans)
  {
    plans.insert(text(plan));
  }
  EXPECT_EQ(
      plans,
      (std::set<std::string>{
          "[loc(tb1) = kitchen] move(rob1, kitchen); grasp(rob1, tb1); move(rob1, study_corner); "
          "putdown(rob1, tb1); ",
          "[loc(tb1) = corridor] move(rob1, corridor); grasp(rob1, tb1); move(rob1, study_corner); "
          "putdown(rob1, tb1); ",
          "[loc(tb1) = study_corner] move(rob1, study_corner); grasp(rob1, tb1); putdown(rob1, "
          "tb1); "}));
}

TEST(Planner, DoesNotRefuteADefaultToReachItsGoalSooner)
{
  // Were the book in the office, where the robot is, the plan would be a step shorter.
  const PlanResult result = office("").plan("in_hand(rob1, tb1)");
  ASSERT_EQ(result.plans.size(), 1U);
  EXPECT_EQ(text(result.plans[0]), "move(rob1, main_library); grasp(rob1, tb1); ");
}

TEST(Planner, HasNothingToDoOnlyWhenTheGoalIsEntailed)
{
  EXPECT_TRUE(office("").plan("loc(tb1) = main_library").goal_entailed);
  const PlanResult open = office("").plan("loc(printer1) = office");
  EXPECT_FALSE(open.goal_entailed);
  for (const Plan& plan : open.plans)
  {
    EXPECT_FALSE(plan.steps.empty());
  }
}

TEST(Planner, SaysWhyThereIsNoPlan)
{
  const PlanResult contradiction = office("").plan("loc(tb1) = office and loc(tb1) = kitchen");
  EXPECT_TRUE(contradiction.plans.empty());
  EXPECT_NE(contradiction.reason.find("no state of the domain satisfies the goal"),
            std::string::npos);
  PlanOptions short_sighted;
  short_sighted.max_horizon = 2;
  const PlanResult too_far = office("").plan(kGoal, short_sighted);
  EXPECT_TRUE(too_far.plans.empty());
  EXPECT_NE(too_far.reason.find("no plan of at most 2 steps"), std::string::npos);
}

TEST(Planner, StopsWhenCancelled)
{
  const std::atomic<bool> cancel{true};
  PlanOptions far;
  far.max_horizon = 60;
  try
  {
    // Three robots' worth of work for one: far beyond what is found before the first look at the
    // flag.
    static_cast<void>(
        office("").plan("loc(tb1) = corridor and loc(tb2) = kitchen and loc(tb3) = office and "
                        "loc(mug1) = office and "
                        "loc(mug2) = corridor and loc(pot1) = office and not in_hand(rob1, pot1)",
                        far, &cancel));
    FAIL() << "expected Cancelled";
  }
  catch (const Cancelled& e)
  {
    EXPECT_STREQ(e.what(), "planning was cancelled");
  }
}

// No plan may count on a lucky outcome.
TEST(Planner, DoesNotRelyOnLuck)
{
  Reasoner reasoner(readDescription(std::string(KR3_TEST_DIR) + "/data/lamps.kr3"));
  reasoner.setHistory(
      parseHistory("init(on(left), false). init(on(right), false). init(shows(d) = 2, true). ",
                   "history", reasoner.description()));
  PlanOptions options;
  options.max_horizon = 2;
  EXPECT_TRUE(reasoner.plan("shows(d) = 1", options).plans.empty());
  ASSERT_EQ(reasoner.plan("shows(d) != 2", options).plans.size(), 1U);
  ASSERT_EQ(reasoner.plan("lit(red) and lit(green)", options).plans.size(), 1U);
}

}  // namespace
}  // namespace kr3::reasoner
