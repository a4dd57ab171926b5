#include "kr3_reasoner/reasoner.hpp"

#include <gtest/gtest.h>

#include "support.hpp"

namespace kr3::reasoner
{
namespace
{

const std::string kOffice = std::string(KR3_DOMAINS_DIR) + "/office/domain.kr3";
const std::string kLamps = std::string(KR3_TEST_DIR) + "/data/lamps.kr3";

Reasoner reasonerOf(const std::string& path, const std::string& history,
                    ReasonerOptions options = {})
{
  Reasoner reasoner(readDescription(path), std::move(options));
  reasoner.setHistory(parseHistory(history, "history", reasoner.description()));
  return reasoner;
}

Reasoner reasonerOfText(const std::string& description, const std::string& history)
{
  Reasoner reasoner(parseDescription(description, "text"));
  reasoner.setHistory(parseHistory(history, "history", reasoner.description()));
  return reasoner;
}

// Zhang et al. (2014), Example 1.
TEST(Reasoner, GivesThePapersAnswersOnH1ToH4)
{
  const Reasoner h1 = reasonerOf(kOffice, "");
  EXPECT_EQ(h1.diagnose().cost, 0);
  EXPECT_EQ(h1.entails("loc(tb1) = main_library", 0), Answer::kTrue);

  const Reasoner h2 = reasonerOf(kOffice, "init(loc(tb1) = main_library, false).");
  EXPECT_EQ(h2.diagnose().cost, 0);
  EXPECT_EQ(h2.entails("loc(tb1) = aux_library", 0), Answer::kTrue);

  const Reasoner h3 = reasonerOf(
      kOffice, "init(loc(tb1) = main_library, false). init(loc(tb1) = aux_library, false).");
  EXPECT_EQ(h3.diagnose().cost, 0);
  EXPECT_EQ(h3.entails("loc(tb1) = office", 0), Answer::kTrue);

  const Reasoner h4 = reasonerOf(kOffice, "obs(loc(tb1) = main_library, false, 1).");
  const Diagnosis diagnosis = h4.diagnose();
  EXPECT_EQ(diagnosis.cost, 1);
  ASSERT_EQ(diagnosis.explanations.size(), 1U);
  EXPECT_EQ(diagnosis.explanations[0],
            std::vector<std::string>{"init(loc(tb1) = main_library, false)"});
  EXPECT_EQ(diagnosis.in_words[0],
            "tb1 is an exception to default d1: initially loc(tb1) was not main_library");
  EXPECT_EQ(h4.entails("loc(tb1) = aux_library", 1), Answer::kTrue);
  EXPECT_EQ(h4.entails("loc(tb2) = main_library", 1), Answer::kTrue);
}

TEST(Reasoner, LeavesUnknownWhatNothingSettles)
{
  const Reasoner reasoner = reasonerOf(kOffice, "");
  EXPECT_EQ(reasoner.entails("loc(printer1) = office", 0), Answer::kUnknown);
  EXPECT_EQ(reasoner.possibleValues("loc(printer1)", 0).size(), 6U);
  EXPECT_TRUE(reasoner.possible("loc(printer1) = office", 0));
  EXPECT_FALSE(reasoner.possible("loc(tb1) = office", 0));
}

// A body literal that is merely unknown does not fire a default (Definition 1: the body must be in
// the closure).
TEST(Reasoner, DoesNotFireADefaultOnAnUnknownBody)
{
  const std::string description =
      "sorts\n thing = {a}.\n"
      "fluents\n inertial wet(thing).\n inertial cold(thing).\n"
      "defaults\n d(X): cold(X) if -wet(X).\n";
  EXPECT_EQ(reasonerOfText(description, "").entails("cold(a)", 0), Answer::kUnknown);
  EXPECT_EQ(reasonerOfText(description, "init(wet(a), false).").entails("cold(a)", 0),
            Answer::kTrue);
}

// Were defaults rules about complete states, a state where the contrary holds would simply block
// them.
TEST(Reasoner, KeepsTheClosureApartFromTheCompletedState)
{
  const std::string description =
      "sorts\n thing = {a}.\n place = {p, q, r}.\n"
      "fluents\n inertial at(thing) : place.\n"
      "defaults\n d(X): at(X) = p.\n";
  EXPECT_EQ(reasonerOfText(description, "").possibleValues("at(a)", 0),
            std::vector<std::string>{"p"});
  EXPECT_EQ(reasonerOfText(description, "init(at(a) = p, false).").possibleValues("at(a)", 0),
            (std::vector<std::string>{"q", "r"}));
}

TEST(Reasoner, ObeysPreferencesAmongDefaults)
{
  const std::string description =
      "sorts\n book = {novel, cookbook}.\n cooking = {cookbook}.\n place = {library, kitchen}.\n"
      "fluents\n inertial at(book) : place.\n"
      "defaults\n b(X): at(X) = library if book(X).\n c(X): at(X) = kitchen if cooking(X).\n";
  EXPECT_EQ(reasonerOfText(description, "").entails("at(cookbook) = kitchen", 0), Answer::kUnknown);
  const Reasoner ranked = reasonerOfText(description + " prefer c(X) over b(X).\n", "");
  EXPECT_EQ(ranked.entails("at(cookbook) = kitchen", 0), Answer::kTrue);
  EXPECT_EQ(ranked.entails("at(novel) = library", 0), Answer::kTrue);
  // b is blocked only while c fires
  const Reasoner refuted = reasonerOfText(description + " prefer c(X) over b(X).\n",
                                          "init(at(cookbook) = kitchen, false).");
  EXPECT_EQ(refuted.entails("at(cookbook) = library", 0), Answer::kTrue);
}

TEST(Reasoner, AssumesExogenousActionsOnlyWhenExceptionsDoNotExplain)
{
  const std::string moved = "init(loc(mug1) = kitchen, true). obs(loc(mug1) = office, true, 1).";
  const Diagnosis diagnosis = reasonerOf(kOffice, moved).diagnose();
  EXPECT_TRUE(diagnosis.consistent);
  ASSERT_EQ(diagnosis.explanations.size(), 1U);
  EXPECT_EQ(diagnosis.explanations[0], std::vector<std::string>{"exo_move(mug1, office) at 0"});

  ReasonerOptions competing;
  competing.diagnose_exogenous = true;
  const Diagnosis either =
      reasonerOf(kOffice, "obs(loc(tb1) = aux_library, true, 1).", competing).diagnose();
  EXPECT_EQ(either.cost, 1);
  EXPECT_EQ(either.explanations.size(), 2U);  // never in the main library, or moved
}

TEST(Reasoner, NamesAMinimalConflict)
{
  const Reasoner reasoner = reasonerOf(kOffice,
                                       "init(loc(rob1) = kitchen, true). init(loc(mug1) = kitchen, "
                                       "true). obs(loc(rob1) = office, true, 1).");
  const Diagnosis diagnosis = reasoner.diagnose();
  EXPECT_FALSE(diagnosis.consistent);
  EXPECT_EQ(diagnosis.conflict, (std::vector<std::string>{"init(loc(rob1) = kitchen, true)",
                                                          "obs(loc(rob1) = office, true, 1)"}));
  EXPECT_NE(errorOf([&] {
              static_cast<void>(reasoner.entails("loc(rob1) = office", 1));
            }).find("obs(loc(rob1) = office, true, 1)"),
            std::string::npos);
}

TEST(Reasoner, RetractsTheLeastCertainRecordLast)
{
  const Diagnosis diagnosis =
      reasonerOf(kOffice,
                 "init(loc(rob1) = kitchen, true) [0.99]. obs(loc(rob1) = office, true, 1) [0.8].")
          .diagnose();
  ASSERT_TRUE(diagnosis.consistent);
  ASSERT_EQ(diagnosis.explanations.size(), 1U);
  EXPECT_EQ(diagnosis.explanations[0],
            std::vector<std::string>{"wrong(obs(loc(rob1) = office, true, 1) [0.8])"});
}

TEST(Reasoner, CarriesObjectsAlong)
{
  const Reasoner reasoner =
      reasonerOf(kOffice,
                 "init(loc(rob1) = office, true). init(in_hand(rob1, tb1), true). "
                 "hpd(move(rob1, kitchen), 0).");
  EXPECT_EQ(reasoner.currentStep(), 1);
  EXPECT_EQ(reasoner.entails("loc(tb1) = office", 0), Answer::kTrue);
  EXPECT_EQ(reasoner.entails("loc(tb1) = kitchen", 1), Answer::kTrue);
  EXPECT_EQ(reasoner.diagnose().cost, 0);  // direct knowledge is no exception
}

TEST(Reasoner, TakesAFailedAttemptForWhatItIs)
{
  const std::string start =
      "init(loc(rob1) = kitchen, true). init(loc(mug1) = kitchen, true). "
      "attempt(grasp(rob1, mug1), 0). ";
  const std::string empty =
      "init(in_hand(rob1, mug1), false). init(in_hand(rob1, mug2), false). "
      "init(in_hand(rob1, pot1), false). init(in_hand(rob1, tb1), false). "
      "init(in_hand(rob1, tb2), false). init(in_hand(rob1, tb3), false). "
      "init(in_hand(rob1, printer1), false). init(in_hand(rob1, printer2), false). ";
  EXPECT_EQ(reasonerOf(kOffice, start + empty).entails("in_hand(rob1, mug1)", 1), Answer::kTrue);
  const Reasoner failed =
      reasonerOf(kOffice, start + empty + "obs(in_hand(rob1, mug1), false, 1).");
  EXPECT_EQ(failed.diagnose().explanations.at(0),
            std::vector<std::string>{"failed(grasp(rob1, mug1), 0)"});
}

TEST(Reasoner, ExplainsWhatItBelieves)
{
  const Reasoner reasoner = reasonerOf(
      kOffice, "obs(loc(tb1) = main_library, false, 1). init(loc(rob1) = office, true).");
  const Explanation explanation = reasoner.explain("loc(tb1) = aux_library", 1);
  EXPECT_TRUE(explanation.entailed);
  EXPECT_EQ(explanation.records,
            std::vector<std::string>{"obs(loc(tb1) = main_library, false, 1)"});
  std::string reasons;
  for (const std::string& reason : explanation.reasons)
  {
    reasons += reason + "\n";
  }
  EXPECT_NE(reasons.find("by inertia since step 0"), std::string::npos) << reasons;
  EXPECT_NE(reasons.find("tb1 is an exception to default d1"), std::string::npos) << reasons;
  EXPECT_NE(reasons.find("by default d2(tb1)"), std::string::npos) << reasons;
  EXPECT_FALSE(reasoner.explain("loc(printer1) = office", 1).entailed);
}

TEST(Reasoner, ReasonsAboutADomainWithoutPlaces)
{
  const Reasoner reasoner =
      reasonerOf(kLamps,
                 "init(on(left), false). init(on(right), false). init(shows(d) = 2, true). "
                 "hpd(flip(left), 0). hpd(roll(d), 1).");
  EXPECT_EQ(reasoner.entails("dark", 0), Answer::kTrue);
  EXPECT_EQ(reasoner.entails("lit(red)", 1), Answer::kTrue);
  EXPECT_EQ(reasoner.entails("-dark", 1), Answer::kTrue);
  EXPECT_EQ(reasoner.entails("wired(left, green)", 0), Answer::kFalse);
  EXPECT_EQ(reasoner.possibleValues("shows(d)", 2), (std::vector<std::string>{"1", "3"}));
  const Reasoner surprised =
      reasonerOf(kLamps, "init(on(left), false). hpd(flip(left), 0). obs(lit(red), false, 1).");
  EXPECT_EQ(surprised.diagnose().in_words.at(0),
            "red is an exception to default sound: initially broken(red) was true");
}

TEST(Reasoner, RefusesBadRecordsAndKeepsItsHistory)
{
  Reasoner reasoner = reasonerOf(kOffice, "init(loc(rob1) = office, true).");
  EXPECT_NE(errorOf([&] {
              reasoner.addRecords({{RecordKind::kObserved, "loc(rob9) = office", true, 1}});
            }).find("rob9"),
            std::string::npos);
  EXPECT_EQ(reasoner.history().size(), 1U);
  EXPECT_NE(
      errorOf([&] { static_cast<void>(reasoner.entails("loc(rob1) = office", 5)); }).find("step 5"),
      std::string::npos);
}

}  // namespace
}  // namespace kr3::reasoner
