// Regression tests for the traps in the semantics of what happens after the initial state
// (docs/semantics_tests.md, rows 3 and 5 to 9). Every history is compared with the enumeration of
// the definitions as well.

#include <algorithm>

#include <gtest/gtest.h>

#include "support.hpp"
#include "support/expectations.hpp"

namespace kr3::reasoner
{
namespace
{

const std::string kBooks = readText(std::string(KR3_TEST_DIR) + "/data/books.kr3");

ReasonerOptions prices(bool exogenous, int exception, int exogenous_weight)
{
  ReasonerOptions options;
  options.diagnose_exogenous = exogenous;
  options.exception_weight = exception;
  options.exogenous_weight = exogenous_weight;
  return options;
}

// ---- Point 3: exogenous actions ----

TEST(Point3, ThePreferenceBetweenExceptionsAndExogenousActionsIsAnOption)
{
  const std::string seen = "obs(loc(tb1) = main_library, false, 1).";
  const std::string exception = "because init(loc(tb1) = main_library, false)";
  const std::vector<std::string> moves = {"because carry(tb1, aux_library) at 0",
                                          "because carry(tb1, office) at 0",
                                          "because carry(tb1, kitchen) at 0"};
  expectOfHistory(kBooks, seen, {"cost 1", exception});
  std::vector<std::string> either = {"cost 1", exception, "unknown loc(tb1) = main_library at 0"};
  either.insert(either.end(), moves.begin(), moves.end());
  expectOfHistory(kBooks, seen, either, prices(true, 1, 1));
  std::vector<std::string> moved = {"cost 1", "true loc(tb1) = main_library at 0"};
  moved.insert(moved.end(), moves.begin(), moves.end());
  expectOfHistory(kBooks, seen, moved, prices(true, 2, 1));
  expectOfHistory(kBooks, seen, {"cost 1", exception, "true loc(tb1) = aux_library at 1"},
                  prices(true, 1, 2));
}

TEST(Point3, WhatNoExceptionExplainsIsExogenous)
{
  expectOfHistory(kBooks, "init(loc(tb1) = office, true). obs(loc(tb1) = kitchen, true, 1).",
                  {"cost 1", "because carry(tb1, kitchen) at 0", "true loc(tb1) = office at 0"});
}

TEST(Point3, AnExogenousActionAtTheCurrentStepExplainsNothing)
{
  expectOfHistory(kBooks, "init(loc(tb1) = office, true). obs(loc(tb1) = kitchen, true, 0).",
                  {"inconsistent"});
}

TEST(Point3, OneActionAtATimeIsAboutTheRobotOnly)
{
  const std::string description = R"(
fluents
  inertial on.
  inertial wet.
actions
  press.
  wait.
  exogenous rain.
axioms
  press causes on.
  rain causes wet.
  impossible A, B if A != B.
)";
  expectOfHistory(description, "init(wet, false). hpd(press, 0). obs(wet, true, 1).",
                  {"cost 1", "because rain at 0", "true on at 1"});
  expectOfHistory(description, "hpd(press, 0). hpd(wait, 0).", {"inconsistent"});
}

// ---- Point 5: failed actions ----

const std::string kGrasp = R"(
sorts
  thing = {mug, cup}.
fluents
  inertial held(thing).
  inertial near(thing).
actions
  grasp(thing).
axioms
  grasp(X) causes held(X).
  impossible grasp(X) if -near(X).
  impossible A, B if A != B.
)";

TEST(Point5, AnAttemptSucceedsUnlessItHasFailed)
{
  const std::string start =
      "init(near(mug), true). init(held(mug), false). attempt(grasp(mug), 0). ";
  expectOfHistory(kGrasp, start, {"cost 0", "true held(mug) at 1"});
  expectOfHistory(kGrasp, start + "obs(held(mug), false, 1).",
                  {"cost 1", "because failed(grasp(mug), 0)", "false held(mug) at 1"});
  expectOfHistory(kGrasp,
                  "init(near(mug), true). init(held(mug), false). hpd(grasp(mug), 0). "
                  "obs(held(mug), false, 1).",
                  {"inconsistent"});
  expectOfHistory(kGrasp, start + "obs(held(mug), false, 1).", {"cost 3"}, prices(false, 1, 3));
}

TEST(Point5, WhatIsImpossibleHasFailedAtNoPrice)
{
  expectOfHistory(kGrasp, "init(near(mug), false). init(held(mug), false). attempt(grasp(mug), 0).",
                  {"cost 0", "false held(mug) at 1"});
  // Not knowing whether it was near, the failure is explained by that.
  expectOfHistory(kGrasp,
                  "init(held(mug), false). attempt(grasp(mug), 0). obs(held(mug), false, 1).",
                  {"cost 0", "false near(mug) at 0"});
  const std::string any = kGrasp + "  impossible A if held(cup).\n";
  expectOfHistory(any,
                  "init(near(mug), true). init(held(cup), true). init(held(mug), false). "
                  "attempt(grasp(mug), 0).",
                  {"cost 0", "false held(mug) at 1"});
}

TEST(Point5, OneOfTwoAttemptsThatExcludeEachOtherFailed)
{
  expectOfHistory(
      kGrasp,
      "init(near(mug), true). init(near(cup), true). init(held(mug), false). "
      "init(held(cup), false). attempt(grasp(mug), 0). attempt(grasp(cup), 0).",
      {"cost 1", "because failed(grasp(mug), 0)", "because failed(grasp(cup), 0)", "models 2"});
}

// ---- Point 6: uncertain observations ----

TEST(Point6, ARecordIsRetractedOnlyWhenNothingElseExplains)
{
  expectOfHistory(kBooks, "obs(loc(tb1) = main_library, false, 1) [0.6].",
                  {"cost 1", "because init(loc(tb1) = main_library, false)"});
  const std::string still = "fluents\n inertial on.\n";
  expectOfHistory(still, "init(on, true) [0.9]. obs(on, false, 1) [0.8].",
                  {"because wrong(obs(on, false, 1) [0.8])", "true on at 1"});
  expectOfHistory(still, "init(on, true). obs(on, false, 1) [0.99].",
                  {"because wrong(obs(on, false, 1) [0.99])"});
}

TEST(Point6, LogOddsAddUp)
{
  // Two witnesses of .8 (odds 4 each) outweigh one of .9 (odds 9).
  expectOfHistory("fluents\n inertial on.\n",
                  "obs(on, true, 1) [0.9]. obs(on, false, 1) [0.8]. obs(on, false, 2) [0.8].",
                  {"because wrong(obs(on, true, 1) [0.9])", "false on at 1"});
}

// ---- Point 7: entailment ----

TEST(Point7, EntailmentIsAboutMinimalExplanationsOnly)
{
  const std::string seen = "obs(loc(tb1) = main_library, false, 1).";
  expectOfHistory(kBooks, seen,
                  {"true loc(tb1) = aux_library at 1", "false loc(tb1) = office at 1",
                   "false loc(tb1) = kitchen at 1"});
  const Reasoner reasoner = reasonerOfTexts(kBooks, "");
  EXPECT_TRUE(reasoner.possible("loc(tb1) != kitchen", 0));
  EXPECT_FALSE(reasoner.possible("loc(tb1) = kitchen", 0));
}

// ---- Point 8: planning ----

/// `[-wet] make_p; make_q;` for each plan.
std::vector<std::string> plansFor(const std::string& description, const std::string& history,
                                  const std::string& goal)
{
  std::vector<std::string> texts;
  for (const Plan& plan : reasonerOfTexts(description, history).plan(goal).plans)
  {
    std::string text;
    for (const std::string& literal : plan.hypothesis)
    {
      text += "[" + literal + "] ";
    }
    for (const auto& step : plan.steps)
    {
      for (std::size_t i = 0; i < step.size(); ++i)
      {
        text += (i == 0 ? "" : " and ") + step[i];
      }
      text += "; ";
    }
    texts.push_back(text);
  }
  std::sort(texts.begin(), texts.end());
  return texts;
}

TEST(Point8, APlanThatActionsMakeImpossibleTogetherIsNoPlan)
{
  const std::string description = R"(
fluents
  inertial p.
  inertial q.
  inertial wet.
actions
  make_p.
  make_q.
axioms
  make_p causes p.
  make_q causes q.
  impossible make_p, make_q if wet.
)";
  const std::string start = "init(p, false). init(q, false). ";
  EXPECT_EQ(plansFor(description, start + "init(wet, false).", "p and q"),
            std::vector<std::string>{"make_p and make_q; "});
  const auto one_by_one = plansFor(description, start + "init(wet, true).", "p and q");
  ASSERT_EQ(one_by_one.size(), 1U);
  EXPECT_TRUE(one_by_one[0] == "make_p; make_q; " || one_by_one[0] == "make_q; make_p; ")
      << one_by_one[0];
  // Not knowing whether it is wet, doing both at once is good for one hypothesis only.
  const auto either = plansFor(description, start, "p and q");
  ASSERT_FALSE(either.empty());
  for (const std::string& plan : either)
  {
    EXPECT_TRUE(plan.find(" and ") == std::string::npos || plan.find("[-wet]") == 0) << plan;
  }
}

TEST(Point8, APlanHasToBeExecutableWhereAConstraintForbidsWhatFollows)
{
  const std::string description =
      "fluents\n inertial p.\n inertial wet.\nactions\n make_p.\naxioms\n make_p causes p.\n"
      " false if p, wet.\n";
  EXPECT_EQ(plansFor(description, "init(p, false).", "p"),
            std::vector<std::string>{"[-wet] make_p; "});
}

TEST(Point8, MinimalExplanationsComeFromTheHistoryWithoutTheGoal)
{
  const std::string description =
      kBooks +
      "actions\n  read(textbook).\nfluents\n  inertial known(textbook).\n"
      "axioms\n  read(X) causes known(X).\n"
      "  impossible read(X) if loc(X) != kitchen.\n";
  const PlanResult result =
      reasonerOfTexts(description, "init(known(tb1), false).").plan("known(tb1)");
  EXPECT_TRUE(result.plans.empty());
}

// ---- Point 9: inconsistent histories ----

TEST(Point9, TheConflictIsMinimalAndWhatMayBeRetractedIsNoPartOfIt)
{
  const Reasoner reasoner = reasonerOfTexts("fluents\n inertial p.\n inertial q.\n",
                                            "obs(p, true, 0) [0.9]. obs(p, false, 1). obs(q, true, "
                                            "0). obs(q, false, 1). obs(q, true, 2).");
  const Diagnosis diagnosis = reasoner.diagnose();
  EXPECT_FALSE(diagnosis.consistent);
  EXPECT_EQ(diagnosis.conflict, (std::vector<std::string>{"obs(q, false, 1)", "obs(q, true, 2)"}));
}

// ---- Point 10: why ----

TEST(Point10, WhatIsCitedSufficesAndNothingIsSuperfluous)
{
  const std::string description =
      "fluents\n inertial p.\n inertial q.\n inertial r.\nactions\n nod.\naxioms\n nod causes p if "
      "q.\ndefaults\n d: -r.\n";
  const std::string history = "init(q, true). init(p, false). hpd(nod, 0). obs(r, true, 1).";
  const Reasoner reasoner = reasonerOfTexts(description, history);
  const Explanation why = reasoner.explain("p", 1);
  ASSERT_TRUE(why.entailed);
  EXPECT_EQ(why.records, (std::vector<std::string>{"init(q, true)", "hpd(nod, 0)"}));
  EXPECT_TRUE(why.defaults.empty());
  EXPECT_EQ(reasonerOfTexts(description, "init(q, true). hpd(nod, 0).").entails("p", 1),
            Answer::kTrue);
  EXPECT_NE(reasonerOfTexts(description, "hpd(nod, 0).").entails("p", 1), Answer::kTrue);
  EXPECT_NE(reasonerOfTexts(description, "init(q, true). obs(r, true, 1).").entails("p", 1),
            Answer::kTrue);
}

// ---- Transitions ----

TEST(Transitions, WhatAFluentIsNotPersistsAsWell)
{
  const std::string description = R"(
sorts
  place = {u, v, w}.
fluents
  inertial at : place.
  inertial tilted.
actions
  tilt.
axioms
  tilt causes tilted.
  at = v if at != u, tilted.
)";
  expectOfHistory(description, "init(at = w, true). init(tilted, false). hpd(tilt, 0).",
                  {"cost 0", "true at = v at 1"});
  expectOfHistory(description, "init(at = u, true). init(tilted, false). hpd(tilt, 0).",
                  {"cost 0", "true at = u at 1"});
}

TEST(Transitions, NothingSupportsItself)
{
  const std::string description =
      "fluents\n inertial p.\n inertial q.\nactions\n nod.\naxioms\n p if q.\n q if p.\n nod "
      "causes p.\n";
  expectOfHistory(description, "init(p, false). obs(p, true, 1).", {"inconsistent"});
  expectOfHistory(description, "init(p, false). hpd(nod, 0).", {"true q at 1"});
}

TEST(Transitions, RecordsAboutStaticsAreReadAsTheyStand)
{
  const std::string description =
      "sorts\n thing = {a, b}.\nstatics\n near(thing, thing).\nfacts\n near(a, b).\nfluents\n "
      "inertial p.\n";
  expectOfHistory(description, "obs(near(b, a), false, 0). obs(near(a, b), true, 1).", {"cost 0"});
  expectOfHistory(description, "obs(near(b, a), true, 0).", {"inconsistent"});
  expectOfHistory(description, "obs(near(a, b), false, 0).", {"inconsistent"});
}

}  // namespace
}  // namespace kr3::reasoner
