// Histories of whole domains with what they are required to entail, how they are explained, and
// what plans follow.

#include <set>

#include <gtest/gtest.h>

#include "support.hpp"
#include "support/expectations.hpp"

namespace kr3::reasoner
{
namespace
{

std::string office()
{
  return readText(std::string(KR3_DOMAINS_DIR) + "/office/domain.kr3");
}

std::string lamps()
{
  return readText(std::string(KR3_TEST_DIR) + "/data/lamps.kr3");
}

/// `-in_hand(rob1, X)` for all things of the office.
std::string emptyHanded()
{
  std::string text = "init(loc(rob1) = corridor, true). ";
  for (const char* thing : {"tb1", "tb2", "tb3", "mug1", "mug2", "pot1", "printer1", "printer2"})
  {
    text += "init(in_hand(rob1, " + std::string(thing) + "), false). ";
  }
  return text;
}

/// Hypothesis and steps of each plan, as `[loc(tb1) = office] move(rob1, office) ...`.
std::vector<std::string> plansFor(const std::string& history, const std::string& goal)
{
  std::vector<std::string> texts;
  for (const Plan& plan : reasonerOfTexts(office(), history).plan(goal).plans)
  {
    std::string text;
    for (const std::string& literal : plan.hypothesis)
    {
      text += "[" + literal + "] ";
    }
    for (const auto& step : plan.steps)
    {
      for (const std::string& action : step)
      {
        text += action + "; ";
      }
    }
    texts.push_back(text);
  }
  return texts;
}

TEST(Histories, EachObjectHasItsOwnExceptions)
{
  expectOfHistory(
      office(),
      "obs(loc(tb1) = main_library, false, 1). obs(loc(tb2) = main_library, false, 1). "
      "obs(loc(tb2) = aux_library, false, 1). obs(loc(mug1) = kitchen, false, 1).",
      {"cost 4",
       "because init(loc(mug1) = kitchen, false); init(loc(tb1) = main_library, false); "
       "init(loc(tb2) = aux_library, false); init(loc(tb2) = main_library, false)",
       "true loc(tb1) = aux_library at 1", "true loc(tb2) = office at 1",
       "true loc(tb3) = main_library at 1", "true loc(mug2) = kitchen at 1",
       "false loc(mug1) = kitchen at 0", "unknown loc(mug1) = office at 1",
       "unknown loc(printer1) = office at 1"});
}

TEST(Histories, WhatTheRobotHoldsIsAnIndirectExceptionAtNoPrice)
{
  expectOfHistory(office(),
                  "init(loc(rob1) = corridor, true). init(in_hand(rob1, tb1), true). "
                  "hpd(move(rob1, kitchen), 0). obs(loc(tb1) = kitchen, true, 1).",
                  {"cost 0", "true loc(tb1) = corridor at 0", "true loc(tb1) = kitchen at 1",
                   "true loc(tb2) = main_library at 1"});
}

TEST(Histories, AnObservationOfTheRobotsHandExplainsWhereAThingIs)
{
  // The book is in the robot's hand, so it is where the robot is: no default can have held.
  expectOfHistory(office(), "init(loc(rob1) = corridor, true). obs(in_hand(rob1, tb1), true, 1).",
                  {"cost 3", "true loc(tb1) = corridor at 0",
                   "because init(loc(tb1) = aux_library, false); "
                   "init(loc(tb1) = main_library, false); init(loc(tb1) = office, false)"});
}

TEST(Histories, ALaterDefaultRestsOnTheFailureOfAnEarlierOne)
{
  const std::string start = "obs(loc(tb1) = main_library, false, 1). ";
  expectOfHistory(office(), start + "obs(loc(tb1) = aux_library, false, 2).",
                  {"cost 2", "true loc(tb1) = office at 2", "true loc(tb1) = office at 0"});
  expectOfHistory(
      office(), start + "obs(loc(tb1) = aux_library, false, 2). obs(loc(tb1) = office, false, 2).",
      {"cost 3", "unknown loc(tb1) = kitchen at 2", "false loc(tb1) = office at 0"});
  expectOfHistory(office(), start + "obs(loc(tb1) = office, true, 3).",
                  {"cost 2", "true loc(tb1) = office at 0"});
}

TEST(Histories, AThingThatWasMovedIsNoException)
{
  expectOfHistory(office(),
                  "init(loc(rob1) = main_library, true). init(in_hand(rob1, tb1), false). "
                  "hpd(grasp(rob1, tb1), 0). hpd(move(rob1, office), 1). "
                  "obs(loc(tb1) = office, true, 2).",
                  {"cost 0", "true loc(tb1) = main_library at 0", "true in_hand(rob1, tb1) at 2"});
}

TEST(Histories, AGraspFailedOrTheThingWasNotThere)
{
  const std::string tried = emptyHanded() +
                            "hpd(move(rob1, main_library), 0). attempt(grasp(rob1, tb1), 1). "
                            "obs(in_hand(rob1, tb1), false, 2). hpd(move(rob1, office), 2). ";
  expectOfHistory(office(), tried,
                  {"cost 1", "because failed(grasp(rob1, tb1), 1)",
                   "because init(loc(tb1) = main_library, false)",
                   "unknown loc(tb1) = main_library at 3", "false in_hand(rob1, tb1) at 3"});
  expectOfHistory(
      office(), tried + "obs(loc(tb1) = main_library, true, 1).",
      {"cost 1", "because failed(grasp(rob1, tb1), 1)", "true loc(tb1) = main_library at 3"});
}

TEST(Histories, AnAttemptWhereTheThingIsNotFailsOfItself)
{
  expectOfHistory(office(), emptyHanded() + "attempt(grasp(rob1, tb1), 0).",
                  {"cost 0", "false in_hand(rob1, tb1) at 1", "true loc(tb1) = main_library at 1"});
}

TEST(Histories, SomebodyMovedWhatWasSeen)
{
  expectOfHistory(
      office(),
      "obs(loc(mug1) = kitchen, true, 1). obs(loc(mug1) = office, true, 2). "
      "obs(loc(mug2) = kitchen, true, 2).",
      {"cost 1", "because exo_move(mug1, office) at 1", "true loc(mug1) = kitchen at 0"});
  // When nobody looked in between, it may have happened at either step.
  expectOfHistory(office(), "init(loc(pot1) = office, true). obs(loc(pot1) = corridor, true, 2).",
                  {"cost 1", "because exo_move(pot1, corridor) at 0",
                   "because exo_move(pot1, corridor) at 1", "unknown loc(pot1) = office at 1"});
}

TEST(Histories, ADoubtfulReportGivesWay)
{
  expectOfHistory(office(),
                  "init(loc(rob1) = office, true). obs(loc(rob1) = kitchen, true, 1) [0.7]. "
                  "obs(loc(rob1) = corridor, true, 1) [0.6].",
                  {"true loc(rob1) = office at 1",
                   "because wrong(obs(loc(rob1) = corridor, true, 1) [0.6]); "
                   "wrong(obs(loc(rob1) = kitchen, true, 1) [0.7])"});
}

TEST(Histories, AContradictionNamesItsRecords)
{
  const Diagnosis diagnosis =
      reasonerOfTexts(office(),
                      "init(loc(mug1) = office, true).\ninit(loc(rob1) = office, true).\n"
                      "hpd(move(rob1, office), 0).\nobs(loc(tb1) = office, true, 1).\n")
          .diagnose();
  EXPECT_FALSE(diagnosis.consistent);
  EXPECT_EQ(diagnosis.conflict, (std::vector<std::string>{"init(loc(rob1) = office, true)",
                                                          "hpd(move(rob1, office), 0)"}));
  EXPECT_NE(diagnosis.conflict_in_words.find("3"), std::string::npos)
      << diagnosis.conflict_in_words;
}

TEST(Histories, DefinitionsFollowWhatChanges)
{
  const std::string start = "init(on(left), false). init(on(right), false). ";
  expectOfHistory(
      lamps(), start + "hpd(flip(left), 0).",
      {"true dark at 0", "true lit(red) at 1", "false dark at 1", "false lit(green) at 1"});
  expectOfHistory(lamps(), start + "hpd(flip(left), 0). obs(dark, true, 1).",
                  {"cost 1", "because init(broken(red), true)", "true broken(red) at 1"});
  expectOfHistory(lamps(),
                  start + "hpd(flip(left), 0). obs(lit(red), true, 1). obs(dark, true, 2).",
                  {"cost 1", "because break_down(red) at 1", "false broken(red) at 1"});
}

TEST(Histories, OneOfSeveralOutcomesHappened)
{
  const std::string start =
      "init(on(left), true). init(broken(red), true). hpd(repair(red), 0). init(shows(d) = 2, "
      "true). ";
  expectOfHistory(lamps(), start, {"unknown lit(red) at 1"});
  expectOfHistory(lamps(), start + "obs(lit(red), true, 2).", {"false broken(red) at 1"});
  expectOfHistory(lamps(), "init(shows(d) = 2, true). hpd(roll(d), 0).",
                  {"false shows(d) = 2 at 1", "unknown shows(d) = 1 at 1"});
}

TEST(Histories, PlansGoWhereTheDefaultsPointAndThenEverywhere)
{
  const std::string seen = emptyHanded() + "obs(loc(tb1) = main_library, false, 1). ";
  EXPECT_EQ(plansFor(seen, "in_hand(rob1, tb1)"),
            std::vector<std::string>{"move(rob1, aux_library); grasp(rob1, tb1); "});
  const auto plans =
      plansFor(seen + "obs(loc(tb1) = aux_library, false, 1). obs(loc(tb1) = office, false, 1).",
               "in_hand(rob1, tb1)");
  EXPECT_EQ(std::set<std::string>(plans.begin(), plans.end()),
            (std::set<std::string>{
                "[loc(tb1) = corridor] grasp(rob1, tb1); ",
                "[loc(tb1) = kitchen] move(rob1, kitchen); grasp(rob1, tb1); ",
                "[loc(tb1) = study_corner] move(rob1, study_corner); grasp(rob1, tb1); "}));
}

TEST(Histories, GoalsMayBeEntailedOrOutOfReach)
{
  PlanOptions options;
  options.max_horizon = 3;
  const Reasoner reasoner = reasonerOfTexts(office(), emptyHanded());
  EXPECT_TRUE(reasoner.plan("loc(tb1) = main_library", options).goal_entailed);
  EXPECT_FALSE(reasoner.plan("loc(tb1) != kitchen and in_hand(rob1, mug1)", options).goal_entailed);
  const PlanResult never = reasoner.plan("in_hand(rob1, tb1) and in_hand(rob1, tb2)", options);
  EXPECT_TRUE(never.plans.empty());
  EXPECT_FALSE(never.goal_entailed);
  EXPECT_NE(never.reason, "");
}

}  // namespace
}  // namespace kr3::reasoner
