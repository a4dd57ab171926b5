#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>

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

/// Things on twelve shelves that somebody moves; questions end after a minute.
/// @param definition  of the fluent `together`; none: there is no such fluent
Reasoner shelves(const std::string& things, const std::string& definition = "")
{
  Reasoner reasoner(parseDescription(
      "sorts\n thing = " + things + ".\n shelf = 1..12.\nfluents\n inertial on(thing) : shelf.\n" +
          (definition.empty() ? "" : " defined together.\n") +
          "actions\n exogenous slip(thing, shelf).\n" +
          "axioms\n slip(T, S) causes on(T) = S.\n impossible slip(T, S) if on(T) = S.\n" +
          definition,
      "f"));
  reasoner.setLimits({std::chrono::seconds(60), nullptr});
  return reasoner;
}

constexpr int kSteps = 8;

/// Each thing is on the first shelf, halfway on the second, and in the end on the third.
std::string movedTwice(int num_things)
{
  std::string history;
  for (int thing = 1; thing <= num_things; ++thing)
  {
    const std::string on = "obs(on(" + std::to_string(thing) + ") = ";
    history += on + "1, true, 0). " + on + "2, true, " + std::to_string(kSteps / 2) + "). " + on +
               "3, true, " + std::to_string(kSteps) + "). ";
  }
  return history;
}

/// All of them are on one shelf.
std::string definitionOfTogether(int num_things)
{
  std::string body;
  for (int thing = 1; thing <= num_things; ++thing)
  {
    body += (thing == 1 ? "on(" : ", on(") + std::to_string(thing) + ") = S";
  }
  return " together if " + body + ".\n";
}

// Explanations of things that do not hang together are put together from those of each thing; a
// search that takes all their prices as one sum does not end within the limit.
TEST(Diagnosis, ExplainsThingsThatDoNotHangTogetherEachForItself)
{
  constexpr int kThings = 10;
  Reasoner reasoner = shelves("1..10");
  reasoner.setHistory(parseHistory(movedTwice(kThings), "h", reasoner.description()));
  const Diagnosis diagnosis = reasoner.diagnose();
  EXPECT_EQ(diagnosis.cost, 2 * kThings);
  ASSERT_EQ(diagnosis.parts.size(), static_cast<std::size_t>(kThings));
  for (const ExplanationPart& part : diagnosis.parts)
  {
    EXPECT_EQ(part.price, 2);
    EXPECT_EQ(part.explanations.size(), 16U);  // it slipped at one of four steps, and again so
    EXPECT_TRUE(part.complete);
  }
  EXPECT_EQ(diagnosis.explanations.size(), 200U);
  EXPECT_FALSE(diagnosis.complete);
  using Values = std::vector<std::string>;
  EXPECT_EQ(reasoner.possibleValues("on(1)", 1), (Values{"1", "2"}));
  EXPECT_EQ(reasoner.possibleValues("on(10)", kSteps - 1), (Values{"2", "3"}));
  EXPECT_EQ(reasoner.entails("on(5) != 12", 1), Answer::kTrue);
  EXPECT_TRUE(reasoner.plan("on(1) = 3").goal_entailed);
}

// What is defined over things makes them hang together once something depends on it.
TEST(Diagnosis, ADefinitionOfWhichNothingIsKnownLeavesThingsApart)
{
  constexpr int kThings = 10;
  Reasoner reasoner = shelves("1..10", definitionOfTogether(kThings));
  reasoner.setHistory(parseHistory(movedTwice(kThings), "h", reasoner.description()));
  const Diagnosis diagnosis = reasoner.diagnose();
  EXPECT_EQ(diagnosis.cost, 2 * kThings);
  EXPECT_EQ(diagnosis.parts.size(), static_cast<std::size_t>(kThings));
  EXPECT_EQ(reasoner.entails("together", kSteps), Answer::kTrue);
  EXPECT_EQ(reasoner.entails("together", 1), Answer::kUnknown);

  Reasoner few = shelves("1..3", definitionOfTogether(3));
  const std::string seen = movedTwice(3) + "obs(together, false, 2). obs(together, false, 3).";
  few.setHistory(parseHistory(seen, "h", few.description()));
  const Diagnosis joint = few.diagnose();
  EXPECT_EQ(joint.cost, 2 * 3);
  EXPECT_EQ(joint.parts.size(), 1U);
  EXPECT_EQ(few.entails("together", 3), Answer::kFalse);
  EXPECT_EQ(few.entails("together", 1), Answer::kUnknown);
}

// Whatever is dearer than a thing that is moved ten times has to be ruled out; that nothing else is
// as cheap follows from the ten gaps in which it must have been moved, not from trying.
TEST(Diagnosis, CountsWhatHappenedToOneThingAgainAndAgain)
{
  constexpr int kMoves = 10;
  constexpr int kGap = 4;
  Reasoner reasoner = shelves("{cup}");
  std::string history;
  for (int i = 0; i <= kMoves; ++i)
  {
    history += "obs(on(cup) = " + std::to_string(1 + i % 2) + ", true, " +
               std::to_string(i * kGap) + "). ";
  }
  reasoner.setHistory(parseHistory(history, "h", reasoner.description()));
  EXPECT_EQ(reasoner.entails("on(cup) != 3", kGap / 2), Answer::kTrue);
  EXPECT_EQ(reasoner.possible("on(cup) = 2", kGap / 2), true);
  EXPECT_EQ(reasoner.models(10).size(), 10U);
  EXPECT_EQ(reasoner.minimalExplanations().cost, kMoves);
  EXPECT_EQ(reasoner.progress(kMoves * kGap).first_step, kMoves * kGap);
  EXPECT_EQ(reasoner.entails("on(cup) = 1", kMoves * kGap), Answer::kTrue);
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

TEST(Retraction, WhatContradictsByItselfIsAllOfItAndCertainRecordsStay)
{
  const std::string earlier = "obs(loc(tb1) = main_library, false, 1) [0.6]. ";
  const Reasoner twice = office(earlier +
                                "obs(loc(tb1) = aux_library, false, 2) [0.8]. "
                                "obs(loc(tb1) = aux_library, false, 2) [0.9].");
  const auto aux = twice.retractionsFor("loc(tb1) = aux_library", 2);
  ASSERT_EQ(aux.size(), 1U);
  EXPECT_EQ(aux[0].records, (std::vector<std::size_t>{1, 2}));
  EXPECT_NEAR(aux[0].log_odds, std::log(4.0) + std::log(9.0), 0.01);
  EXPECT_TRUE(office(earlier + "obs(loc(tb1) = aux_library, false, 2).")
                  .retractionsFor("loc(tb1) = aux_library", 2)
                  .empty());
}

/// Where a book is, by records that may be wrong; the last one says where it is not now.
std::vector<Record> drawnRecords(std::uint64_t seed)
{
  static const char* const kPlaces[] = {"main_library", "aux_library", "office"};
  constexpr int kNow = 2;
  std::mt19937_64 random(seed);
  std::vector<Record> records{{RecordKind::kInitially, "in_hand(rob1, tb1)", false, 0}};
  const auto add = [&](bool value, int step) {
    records.push_back({RecordKind::kObserved, std::string("loc(tb1) = ") + kPlaces[random() % 3],
                       value, step, 0.55 + 0.1 * static_cast<double>(random() % 5)});
  };
  for (std::uint64_t i = random() % 4; i > 0; --i)
  {
    add(random() % 3 == 0, static_cast<int>(random() % (kNow + 1)));
  }
  add(false, kNow);
  return records;
}

TEST(Retraction, WhatContradictsNowIsGivenUpAndAllThatIsGivenUpIsNeeded)
{
  std::size_t found = 0;
  Reasoner reasoner(readDescription(kOffice));
  for (std::uint64_t seed = 1; seed <= 30; ++seed)
  {
    const std::vector<Record> records = drawnRecords(seed);
    const std::string& literal = records.back().statement;
    SCOPED_TRACE("seed " + std::to_string(seed) + " " + literal);
    reasoner.setHistory(records);
    const int now = records.back().step;
    const auto possibleWithout = [&](const std::vector<std::size_t>& given_up) {
      std::vector<Record> kept;
      for (std::size_t i = 0; i < records.size(); ++i)
      {
        if (std::find(given_up.begin(), given_up.end(), i) == given_up.end())
        {
          kept.push_back(records[i]);
        }
      }
      ReasonerOptions options;
      options.least_step = now;
      Reasoner other(reasoner.description(), options);
      other.setHistory(kept);
      return other.isConsistent() && other.possible(literal, now);
    };
    const std::vector<Retraction> retractions = reasoner.retractionsFor(literal, now);
    found += retractions.size();
    for (const Retraction& retraction : retractions)
    {
      EXPECT_EQ(
          std::count(retraction.records.begin(), retraction.records.end(), records.size() - 1), 1);
      EXPECT_TRUE(possibleWithout(retraction.records));
      for (std::size_t i = 0; retractions.size() == 1 && i < retraction.records.size(); ++i)
      {
        std::vector<std::size_t> fewer = retraction.records;
        fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(i));
        EXPECT_FALSE(possibleWithout(fewer)) << "record " << retraction.records[i];
      }
    }
  }
  EXPECT_GT(found, 10U);
}

// docs/semantics_tests.md, row 6: one false negative must not end a mission.
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
