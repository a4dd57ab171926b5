// Traps in progressing a history (docs/semantics_tests.md, row 11), each as a test; laws on random
// histories are in progression_property_test.cpp.

#include <algorithm>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_reasoner/reasoner.hpp"
#include "support.hpp"

namespace kr3::reasoner
{
namespace
{

const std::string kBooks = readText(std::string(KR3_TEST_DIR) + "/data/books.kr3");

const std::string kMug = R"(
sorts
  place = {kitchen, office, hall}.
  mug = {m1, m2}.
fluents
  inertial at(mug) : place.
  inertial clean(mug).
actions
  carry(mug, place).
  exogenous tidy(mug).
axioms
  carry(M, P) causes at(M) = P.
  tidy(M) causes at(M) = kitchen.
  impossible tidy(M) if at(M) = kitchen.
  impossible A, B if A != B.
defaults
  d1(M): at(M) = kitchen.
)";

Reasoner reasonerOf(const std::string& description, const std::string& history,
                    const ReasonerOptions& options = {})
{
  Reasoner reasoner(parseDescription(description, "domain"), options);
  reasoner.setHistory(parseHistory(history, "history", reasoner.description()));
  return reasoner;
}

void tell(Reasoner& reasoner, const std::string& records)
{
  reasoner.addRecords(parseHistory(records, "history", reasoner.description()));
}

using Sets = std::vector<std::vector<std::string>>;

// H4, and then aux_library is refuted, too: today's minimal explanation was not the last word.
TEST(Progression, ALaterObservationRefutesTheMinimalExplanationOfThePrefix)
{
  Reasoner reasoner = reasonerOf(kBooks, "obs(loc(tb1) = main_library, false, 1).");
  EXPECT_EQ(reasoner.progress(1).first_step, 1);
  EXPECT_EQ(reasoner.entails("loc(tb1) = aux_library", 1), Answer::kTrue);
  EXPECT_EQ(reasoner.diagnose().cost, 1);
  tell(reasoner, "obs(loc(tb1) = aux_library, false, 1).");
  EXPECT_EQ(reasoner.entails("loc(tb1) = office", 1), Answer::kTrue);
  EXPECT_EQ(reasoner.diagnose().cost, 2);
  EXPECT_EQ(
      reasoner.diagnose().explanations,
      (Sets{{"init(loc(tb1) = aux_library, false)", "init(loc(tb1) = main_library, false)"}}));
}

TEST(Progression, RecordsThatAreNoLongerKeptStillCount)
{
  Reasoner reasoner = reasonerOf(kBooks, "obs(loc(tb1) = main_library, false, 1).");
  tell(reasoner, "obs(loc(tb1) = office, false, 2).");
  const Progress progress = reasoner.progress(2);
  EXPECT_EQ(progress.num_records, 1U);
  EXPECT_TRUE(progress.kept_because.empty());
  EXPECT_EQ(reasoner.firstStep(), 2);
  EXPECT_EQ(reasoner.history().size(), 1U);
  EXPECT_EQ(reasoner.diagnose().explanations, (Sets{{"init(loc(tb1) = main_library, false)"}}));
  tell(reasoner, "obs(loc(tb1) = aux_library, false, 2).");
  // Only the kitchen is left, and no default speaks of it; the whole history says the same.
  EXPECT_EQ(reasoner.entails("loc(tb1) = kitchen", 2), Answer::kTrue);
  const Reasoner whole =
      reasonerOf(kBooks,
                 "obs(loc(tb1) = main_library, false, 1). obs(loc(tb1) = office, false, 2). "
                 "obs(loc(tb1) = aux_library, false, 2).");
  EXPECT_EQ(reasoner.diagnose().explanations, whole.diagnose().explanations);
}

// What no exception explains needs the next level, which the alternatives of the beginning have.
TEST(Progression, TheAlternativeOfARefutedDefaultMayNeedAnExogenousAction)
{
  Reasoner reasoner = reasonerOf(kMug, "init(at(m1) = office, true). hpd(carry(m2, hall), 0).");
  EXPECT_EQ(reasoner.progress(1).first_step, 1);
  EXPECT_EQ(reasoner.entails("at(m1) = office", 1), Answer::kTrue);
  tell(reasoner, "obs(at(m1) = office, false, 1).");
  EXPECT_EQ(reasoner.entails("at(m1) = kitchen", 1), Answer::kTrue);
  EXPECT_EQ(reasoner.diagnose().explanations, (Sets{{"tidy(m1) at 0"}}));
  tell(reasoner, "obs(at(m1) = kitchen, false, 1).");
  EXPECT_FALSE(reasoner.diagnose().consistent);
}

TEST(Progression, ADoubtfulRecordThatIsNoLongerKeptMayStillBeWrong)
{
  Reasoner reasoner = reasonerOf(kMug, "obs(clean(m1), true, 0) [0.8]. hpd(carry(m2, hall), 0).");
  EXPECT_EQ(reasoner.progress(1).first_step, 1);
  EXPECT_EQ(reasoner.entails("clean(m1)", 1), Answer::kTrue);
  tell(reasoner, "obs(clean(m1), false, 1).");
  const Diagnosis diagnosis = reasoner.diagnose();
  EXPECT_TRUE(diagnosis.consistent);
  EXPECT_EQ(diagnosis.explanations, (Sets{{"wrong(obs(clean(m1), true, 0) [0.8])"}}));
  EXPECT_EQ(diagnosis.cost, 139);
  EXPECT_EQ(reasoner.entails("clean(m1)", 1), Answer::kFalse);
  // It stays possible when the history is progressed once more.
  tell(reasoner, "hpd(carry(m2, office), 1).");
  EXPECT_EQ(reasoner.progress(2).first_step, 2);
  EXPECT_EQ(reasoner.diagnose().explanations, diagnosis.explanations);
}

// Neither alone has two values in all models in which the other has its own.
TEST(Progression, ObjectsThatAConstraintCouplesStayTogether)
{
  const std::string one_place = R"(
sorts
  place = {kitchen, office, hall}.
  mug = {m1, m2}.
fluents
  inertial at(mug) : place.
actions
  wait.
axioms
  impossible wait if at(m1) = office, at(m2) = hall.
  false if at(X) = P, at(Y) = P, X != Y.
)";
  Reasoner reasoner = reasonerOf(one_place, "obs(at(m1) = kitchen, false, 0). hpd(wait, 0).");
  const Reasoner whole = reasonerOf(one_place, "obs(at(m1) = kitchen, false, 0). hpd(wait, 0).");
  EXPECT_EQ(reasoner.progress(1).first_step, 1);
  EXPECT_EQ(reasoner.models().size(), 3U);
  EXPECT_EQ(whole.models().size(), 3U);
  tell(reasoner, "obs(at(m1) = office, true, 1).");
  EXPECT_EQ(reasoner.entails("at(m2) = kitchen", 1), Answer::kTrue);
}

TEST(Progression, TooManyCombinationsAreRefusedInWords)
{
  ReasonerOptions options;
  options.max_combinations = 4;
  const std::string apart = R"(
sorts
  place = {p1, p2, p3, p4}.
  mug = {m1, m2}.
fluents
  inertial at(mug) : place.
actions
  wait.
axioms
  false if at(X) = P, at(Y) = P, X != Y.
)";
  Reasoner reasoner = reasonerOf(apart, "hpd(wait, 0). hpd(wait, 1).", options);
  Progress progress = reasoner.progress(2);
  EXPECT_EQ(progress.first_step, 0);
  EXPECT_EQ(progress.num_records, 2U);
  ASSERT_EQ(progress.kept_because.size(), 1U);
  EXPECT_EQ(progress.kept_because[0],
            "at(m1) and at(m2) hang together and have more than 4 combinations of values at step "
            "2");
  tell(reasoner, "obs(at(m1) = p1, true, 2).");
  progress = reasoner.progress(2);
  EXPECT_EQ(progress.first_step, 0) << "what is observed at the new first step stays a record";
  tell(reasoner, "hpd(wait, 2).");
  EXPECT_EQ(reasoner.progress(3).first_step, 3) << "it is known by now";
}

TEST(Progression, TheHistoryBeginsAtTheLatestStepThatCanBeRepresented)
{
  ReasonerOptions options;
  options.max_combinations = 3;
  const std::string spread = R"(
sorts
  place = {p1, p2, p3, p4}.
  mug = {m1}.
fluents
  inertial at(mug) : place.
actions
  push(mug).
axioms
  push(M) causes at(M) = p1 [o1] or at(M) = p2 [o2] or at(M) = p3 [o3] or at(M) = p4 [o4].
)";
  Reasoner reasoner =
      reasonerOf(spread, "init(at(m1) = p1, true). hpd(push(m1), 2). hpd(push(m1), 3).", options);
  const Progress progress = reasoner.progress(4);
  EXPECT_EQ(progress.first_step, 2);
  EXPECT_EQ(progress.num_records, 2U);
  ASSERT_EQ(progress.kept_because.size(), 1U);
  EXPECT_NE(progress.kept_because[0].find("more than 3 combinations"), std::string::npos);
}

TEST(Progression, RecordsBeforeTheFirstStepAreRefused)
{
  Reasoner reasoner = reasonerOf(kMug, "hpd(carry(m1, hall), 0). hpd(carry(m1, office), 1).");
  reasoner.progress(2);
  const std::string early = "found step 1, but the history begins at step 2";
  EXPECT_NE(errorOf([&] { tell(reasoner, "obs(at(m1) = hall, true, 1)."); }).find(early),
            std::string::npos);
  EXPECT_NE(errorOf([&] { tell(reasoner, "init(at(m1) = hall, true)."); }).find("found step 0"),
            std::string::npos);
  EXPECT_NE(errorOf([&] {
              static_cast<void>(reasoner.entails("at(m1) = hall", 1));
            }).find("expected one from 2 to the current step 2"),
            std::string::npos);
  EXPECT_EQ(errorOf([&] { reasoner.progress(1); }),
            "found step 1 to progress to, expected one from 2 to the current step 2");
  EXPECT_EQ(reasoner.history().size(), 0U);
  reasoner.setHistory({});
  EXPECT_EQ(reasoner.firstStep(), 0);
}

TEST(Progression, AnInconsistentHistoryIsNotProgressed)
{
  Reasoner reasoner =
      reasonerOf(kMug,
                 "hpd(carry(m1, hall), 0). obs(at(m1) = office, true, 1). obs(at(m1) = "
                 "kitchen, true, 1).");
  EXPECT_NE(errorOf([&] { reasoner.progress(1); }).find("the history is inconsistent"),
            std::string::npos);
}

TEST(Progression, AConflictWithWhatIsNoLongerKeptSaysSo)
{
  Reasoner reasoner = reasonerOf(kMug, "hpd(carry(m1, hall), 0). hpd(carry(m2, hall), 1).");
  reasoner.progress(2);
  tell(reasoner, "obs(at(m1) = office, true, 2).");
  const Diagnosis diagnosis = reasoner.diagnose();
  EXPECT_FALSE(diagnosis.consistent);
  EXPECT_EQ(diagnosis.conflict_records, std::vector<std::size_t>{0});
  EXPECT_NE(diagnosis.conflict_in_words.find("given what is known since step 2 began"),
            std::string::npos);
}

TEST(Progression, ExplanationsCiteTheBeginningWhereItIsNeeded)
{
  Reasoner reasoner = reasonerOf(kMug, "hpd(carry(m1, hall), 0). hpd(carry(m2, office), 1).");
  reasoner.progress(1);
  const Explanation carried = reasoner.explain("at(m1) = hall", 2);
  ASSERT_TRUE(carried.entailed);
  EXPECT_TRUE(carried.records.empty());
  ASSERT_EQ(carried.proof.children.size(), 1U);
  EXPECT_EQ(carried.proof.children[0].kind, ReasonKind::kCarried);
  const Explanation recorded = reasoner.explain("at(m2) = office", 2);
  ASSERT_TRUE(recorded.entailed);
  EXPECT_EQ(recorded.records, std::vector<std::string>{"hpd(carry(m2, office), 1)"});
  EXPECT_TRUE(
      std::none_of(recorded.proof.children.begin(), recorded.proof.children.end(),
                   [](const Reason& reason) { return reason.kind == ReasonKind::kCarried; }));
}

TEST(Progression, PlansDependOnWhatTheBeginningLeavesOpen)
{
  Reasoner reasoner = reasonerOf(kMug, "obs(at(m1) = kitchen, false, 0). hpd(carry(m2, hall), 0).");
  reasoner.progress(1);
  const PlanResult plan = reasoner.plan("at(m1) = hall");
  ASSERT_EQ(plan.plans.size(), 1U);
  EXPECT_EQ(plan.plans[0].steps, (std::vector<std::vector<std::string>>{{"carry(m1, hall)"}}));
  EXPECT_LT(plan.considered.fluents, plan.whole.fluents) << "the other mug does not matter";
  EXPECT_TRUE(reasoner.plan("at(m2) = hall").goal_entailed);
}

TEST(Progression, WhatIfBeginsWhereTheHistoryDoes)
{
  Reasoner reasoner = reasonerOf(kBooks, "obs(loc(tb1) = main_library, false, 1).");
  reasoner.progress(1);
  const Record seen =
      parseHistory("obs(loc(tb1) = aux_library, false, 1).", "what_if", reasoner.description())[0];
  EXPECT_EQ(reasoner.supposing({seen}).entails("loc(tb1) = office", 1), Answer::kTrue);
  EXPECT_EQ(reasoner.entails("loc(tb1) = aux_library", 1), Answer::kTrue);
}

TEST(Progression, AWindowKeepsTheHistoryShort)
{
  ReasonerOptions options;
  options.window = 4;
  Reasoner reasoner = reasonerOf(kMug, "", options);
  const char* const places[] = {"kitchen", "office", "hall"};
  for (int step = 0; step < 40; ++step)
  {
    tell(reasoner,
         "hpd(carry(m1, " + std::string(places[step % 3]) + "), " + std::to_string(step) + ").");
    EXPECT_LE(reasoner.currentStep() - reasoner.firstStep(), 6);
    EXPECT_EQ(reasoner.entails("at(m1) = " + std::string(places[step % 3]), step + 1),
              Answer::kTrue);
    EXPECT_EQ(reasoner.entails("at(m2) = kitchen", step + 1), Answer::kTrue);
  }
  EXPECT_GE(reasoner.firstStep(), 34);
}

TEST(Progression, TheWindowOfAnOptionIsChecked)
{
  ReasonerOptions options;
  options.window = -1;
  EXPECT_NE(errorOf([&] { reasonerOf(kMug, "", options); }).find("found window -1"),
            std::string::npos);
}

}  // namespace
}  // namespace kr3::reasoner
