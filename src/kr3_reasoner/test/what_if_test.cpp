#include <cmath>

#include <gtest/gtest.h>

#include "kr3_reasoner/reasoner.hpp"
#include "support.hpp"

// What-if queries, retraction of doubtful records, and prices of explanations.
namespace kr3::reasoner
{
namespace
{

const std::string kOffice = std::string(KR3_DOMAINS_DIR) + "/office/domain.kr3";

Reasoner office(const std::string& history, ReasonerOptions options = {})
{
  Reasoner reasoner(readDescription(kOffice), std::move(options));
  reasoner.setHistory(parseHistory(history, "mission.hist", reasoner.description()));
  return reasoner;
}

TEST(WhatIf, AnswersUnderHypotheticalRecordsAndChangesNothing)
{
  const Reasoner reasoner = office("obs(loc(tb1) = main_library, false, 1).");
  const Reasoner supposed =
      reasoner.supposing({{RecordKind::kObserved, "loc(tb1) = aux_library", false, 1}});
  EXPECT_EQ(supposed.entails("loc(tb1) = office", 1), Answer::kTrue);
  EXPECT_EQ(supposed.diagnose().cost, 2);
  EXPECT_EQ(reasoner.entails("loc(tb1) = aux_library", 1), Answer::kTrue);
  EXPECT_EQ(reasoner.history().size(), 1U);
  EXPECT_NE(errorOf([&] {
              static_cast<void>(reasoner.supposing({{RecordKind::kObserved, "loc(tb9) = office"}}));
            }).find("tb9"),
            std::string::npos);
}

TEST(WhyUnknown, NamesValuesDefaultsAndWhatWouldSettleIt)
{
  const OpenQuestion printer = office("").whyUnknown("loc(printer1) = office", 0);
  EXPECT_TRUE(printer.open);
  EXPECT_EQ(printer.values.size(), 6U);
  EXPECT_EQ(printer.deciding, std::vector<std::string>{"loc(printer1)"});
  // an exception that nothing follows from: two values are left, and no default chooses
  const OpenQuestion mug =
      office("obs(loc(mug1) = kitchen, false, 1).").whyUnknown("loc(mug1) = office", 1);
  EXPECT_TRUE(mug.open);
  EXPECT_EQ(mug.values.size(), 5U);
  ASSERT_GE(mug.reasons.size(), 2U);
  EXPECT_NE(mug.reasons[1].find("default k1(mug1)"), std::string::npos) << mug.reasons[1];
  EXPECT_NE(mug.reasons[1].find("excluded"), std::string::npos) << mug.reasons[1];
  EXPECT_FALSE(office("").whyUnknown("loc(tb1) = main_library", 0).open);
}

TEST(Diagnosis, SaysWhichRecordsContradictWhichDefault)
{
  const Diagnosis diagnosis =
      office("init(loc(rob1) = office, true). obs(loc(tb1) = main_library, false, 1).").diagnose();
  ASSERT_EQ(diagnosis.alternatives.size(), 1U);
  const Assumption& assumption = diagnosis.alternatives[0].assumptions.at(0);
  EXPECT_EQ(assumption.defaults, std::vector<std::string>{"d1(tb1)"});
  EXPECT_EQ(assumption.because, std::vector<std::size_t>{1});
  EXPECT_NE(assumption.because_in_words.find("suppose that default d1(tb1) applied"),
            std::string::npos)
      << assumption.because_in_words;
}

TEST(Diagnosis, GivesEachAlternativeItsPriceAndDefaults)
{
  ReasonerOptions options;
  options.diagnose_exogenous = true;
  options.default_weights["d1"] = 3;
  options.exogenous_weight = 3;
  const Diagnosis diagnosis = office("obs(loc(tb1) = aux_library, true, 1).", options).diagnose();
  ASSERT_EQ(diagnosis.alternatives.size(), 2U);
  for (const ExplanationAlternative& alternative : diagnosis.alternatives)
  {
    EXPECT_EQ(alternative.price, 3);
    ASSERT_EQ(alternative.assumptions.size(), 1U);
    const Assumption& assumption = alternative.assumptions[0];
    EXPECT_EQ(assumption.price, 3);
    EXPECT_EQ(assumption.defaults, assumption.kind == AssumptionKind::kException
                                       ? std::vector<std::string>{"d1(tb1)"}
                                       : std::vector<std::string>{});
  }
}

TEST(Diagnosis, NamesTheLinesOfConflictingRecords)
{
  const Reasoner reasoner = office(
      "init(loc(mug1) = kitchen, true).\n"
      "init(loc(rob1) = kitchen, true).\n\n"
      "obs(loc(rob1) = office, true, 1).");
  const Diagnosis diagnosis = reasoner.diagnose();
  EXPECT_EQ(diagnosis.conflict_records, (std::vector<std::size_t>{1, 2}));
  EXPECT_NE(diagnosis.conflict_in_words.find("mission.hist:2"), std::string::npos)
      << diagnosis.conflict_in_words;
  EXPECT_NE(diagnosis.conflict_in_words.find("mission.hist:4"), std::string::npos);
}

TEST(Retraction, NamesTheLeastCertainOfTheConflictingRecordsFirst)
{
  const Reasoner reasoner = office(
      "init(loc(rob1) = kitchen, true) [0.99]. obs(loc(rob1) = office, true, 1) [0.8]. "
      "obs(loc(mug1) = kitchen, true, 1) [0.6].");
  const std::vector<Retraction> retractions = reasoner.retractions();
  ASSERT_EQ(retractions.size(), 2U);
  EXPECT_EQ(retractions[0].records, std::vector<std::size_t>{1});
  EXPECT_NEAR(retractions[0].log_odds, std::log(4.0), 0.01);
  EXPECT_EQ(retractions[1].records, std::vector<std::size_t>{0});
  EXPECT_TRUE(office("init(loc(rob1) = kitchen, true).").retractions().empty());
  // what nobody doubts is not given up
  EXPECT_TRUE(office("init(loc(rob1) = kitchen, true). obs(loc(rob1) = office, true, 1).")
                  .retractions()
                  .empty());
}

TEST(Retraction, SaysWhatToGiveUpForALiteral)
{
  const Reasoner reasoner = office(
      "obs(loc(tb1) = main_library, false, 1) [0.9]. obs(loc(tb1) = aux_library, false, 2) [0.8]. "
      "obs(loc(tb2) = main_library, false, 2) [0.6].");
  EXPECT_EQ(reasoner.entails("loc(tb1) = office", 2), Answer::kTrue);
  const std::vector<Retraction> aux = reasoner.retractionsFor("loc(tb1) = aux_library", 2);
  ASSERT_EQ(aux.size(), 1U);
  EXPECT_EQ(aux[0].records, std::vector<std::size_t>{1});
  EXPECT_EQ(aux[0].opens, "loc(tb1) = aux_library");
  EXPECT_TRUE(reasoner.retractionsFor("loc(tb1) = office", 2).empty());  // possible as it is
  // not refuted by a record, only less plausible
  EXPECT_TRUE(reasoner.retractionsFor("loc(tb1) = kitchen", 2).empty());
}

// DESIGN.md 3.2 point 6: one false negative must not end a mission.
TEST(Retraction, FindsTheLeastCertainRefutationOfAFluent)
{
  std::string all;
  for (const char* place : {"main_library", "aux_library", "office", "kitchen", "study_corner"})
  {
    all += std::string("obs(loc(tb1) = ") + place + ", false, 1) " +
           (std::string(place) == "office" ? "[0.7]. " : "[0.95]. ");
  }
  const Reasoner refuted = office(all + "obs(loc(tb1) = corridor, false, 1) [0.9]. " +
                                  "obs(loc(tb2) = main_library, false, 1) [0.55].");
  const Retraction retraction = refuted.leastCertainRefutation("loc(tb1)");
  EXPECT_EQ(retraction.records, std::vector<std::size_t>{2});
  EXPECT_EQ(retraction.opens, "loc(tb1) = office");
  EXPECT_TRUE(office("").leastCertainRefutation("loc(tb1)").records.empty());
}

}  // namespace
}  // namespace kr3::reasoner
