// Situations against the histories that come to them, on random descriptions: the answers about the
// current step are the same, step by step, under whatever names. The number of cases is 30, or what
// KR3_REASONER_CASES says; the first seed is 1, or KR3_REASONER_SEED.

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_reasoner/situation.hpp"
#include "support/random_case.hpp"

namespace kr3::reasoner
{
namespace
{

long numberFrom(const char* variable, long otherwise)
{
  const char* text = std::getenv(variable);
  return text == nullptr ? otherwise : std::strtol(text, nullptr, 10);
}

bool isAction(const Record& record)
{
  return record.kind == RecordKind::kHappened || record.kind == RecordKind::kAttempted;
}

/// The records that are known when a step is the current one.
std::vector<Record> knownAt(const std::vector<Record>& records, int step)
{
  std::vector<Record> known;
  for (const Record& record : records)
  {
    if (record.step < step || (record.step == step && !isAction(record)))
    {
      known.push_back(record);
      known.back().confidence = 1.0;  // no situation says which record may be wrong
    }
  }
  return known;
}

std::vector<Record> atStep(const std::vector<Record>& records, int step, bool actions,
                           const Renaming& renaming)
{
  std::vector<Record> found;
  for (const Record& record : records)
  {
    if (record.step == step && isAction(record) == actions)
    {
      found.push_back(record);
      found.back().statement = renaming.ofText(record.statement);
    }
  }
  return found;
}

std::vector<std::string> texts(const std::vector<Literal>& literals)
{
  std::vector<std::string> texts;
  for (const Literal& literal : literals)
  {
    texts.push_back(toString(literal));
  }
  return texts;
}

/// What any search for plans comes to, whichever of equally good ones it finds.
std::string summaryOf(const PlanResult& result)
{
  std::size_t shortest = 1000;
  for (const Plan& plan : result.plans)
  {
    shortest = std::min(shortest, plan.steps.size());
  }
  const bool sure = result.plans.size() == 1 && result.plans[0].hypothesis.empty();
  return std::to_string(result.goal_entailed) + " " + std::to_string(result.covers_all) + " " +
         std::to_string(result.plans.empty() ? 0 : shortest) + " " + std::to_string(sure);
}

TEST(Situations, AnswerAsTheHistoriesThatComeToThem)
{
  const long first = numberFrom("KR3_REASONER_SEED", 1);
  const long cases = numberFrom("KR3_REASONER_CASES", 30);
  long compared = 0;
  long renamed = 0;
  long inconsistent = 0;
  for (long seed = first; seed < first + cases && !testing::Test::HasFailure(); ++seed)
  {
    CaseSize size;
    size.max_places = 4;
    size.max_steps = 4;
    size.max_records = 6;
    const RandomCase drawn = randomCase(static_cast<std::uint64_t>(seed), size);
    const Description description = parseDescription(drawn.description, "random");
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    const std::string history =
        random() % 3 == 0 ? drawn.history
                          : randomHistory(description, random(), 1 + static_cast<int>(random() % 4),
                                          static_cast<int>(random() % 9));
    SCOPED_TRACE(toString(drawn) + "\n" + history);
    const auto records = parseHistory(history, "history", description);
    Situations situations(description, drawn.options);
    RenamedSituation now;
    int last = 0;
    for (const Record& record : records)
    {
      last = std::max(last, record.step + (isAction(record) ? 1 : 0));
    }
    for (int step = 0; step <= last; ++step)
    {
      SCOPED_TRACE("step " + std::to_string(step));
      const auto rename = [&](const Situation& situation) {
        const RenamedSituation canonical = situations.canonical(situation);
        // Named once, it keeps its names.
        EXPECT_EQ(situations.canonical(canonical.situation).situation.text(),
                  canonical.situation.text());
        now = {canonical.situation, now.renaming.then(canonical.renaming)};
      };
      rename(now.situation.with(atStep(records, step, false, now.renaming)));
      Reasoner whole(description, drawn.options);
      whole.setHistory(knownAt(records, step));
      if (whole.currentStep() < step)
      {
        break;  // nothing happened at the step before
      }
      const auto values = situations.possibleValues(now.situation);
      ASSERT_EQ(values.has_value(), whole.isConsistent());
      if (!values)
      {
        ++inconsistent;
        break;
      }
      ++compared;
      const Renaming back = now.renaming.inverse();
      const auto here = situations.renamed(*values, back);
      renamed += here != *values ? 1 : 0;
      EXPECT_EQ(texts(situations.entailed(here)), texts(whole.entailedAt(step)));
      const auto entailed = situations.entailed(here);
      if (!entailed.empty())
      {
        const Literal& literal = entailed[random() % entailed.size()];
        EXPECT_EQ(situations.entails(here, literal), Answer::kTrue);
        PlanOptions options;
        options.max_horizon = 2;
        options.time_limit = std::chrono::milliseconds(2000);
        const std::string goal = "not (" + toString(literal, description) + ")";
        try
        {
          const PlanResult found = situations.renamed(
              situations.plan(now.situation, now.renaming.ofText(goal), options, nullptr), back);
          EXPECT_EQ(summaryOf(found), summaryOf(whole.plan(goal, options))) << goal;
        }
        catch (const DeadlineExceeded&)
        {
          break;  // too much for a test of many cases
        }
      }
      const auto next =
          situations.next(now.situation.with(atStep(records, step, true, now.renaming)));
      if (!next)
      {
        break;
      }
      rename(next->situation);
    }
  }
  std::cout << compared << " situations compared, " << renamed << " of them under other names, "
            << inconsistent << " histories inconsistent\n";
  EXPECT_GT(compared, cases / 2);
}

Description floorOf(int rooms)
{
  std::string places;
  for (int i = 1; i <= rooms; ++i)
  {
    places += (i == 1 ? "r" : ", r") + std::to_string(i);
  }
  return parseDescription("sorts\n  place = {" + places +
                              "}.\n  robot = {rob1}.\n  thing = {t1} + robot.\n"
                              "fluents\n  inertial loc(thing) : place.\n"
                              "actions\n  move(robot, place).\n"
                              "axioms\n  move(R, P) causes loc(R) = P.\n"
                              "defaults\n  d1: loc(t1) = r2.\n",
                          "floor.kr3");
}

/// A search that looks into rooms in vain.
RenamedSituation searched(Situations& situations, const std::vector<std::string>& rooms)
{
  RenamedSituation now;
  const auto tell = [&](RecordKind kind, const std::string& statement, bool value) {
    const RenamedSituation next = situations.canonical(
        now.situation.with({{kind, now.renaming.ofText(statement), value, 0}}));
    now = {next.situation, now.renaming.then(next.renaming)};
  };
  tell(RecordKind::kObserved, "loc(rob1) = r1", true);
  for (const std::string& room : rooms)
  {
    tell(RecordKind::kHappened, "move(rob1, " + room + ")", true);
    const RenamedSituation next = situations.canonical(situations.next(now.situation)->situation);
    now = {next.situation, now.renaming.then(next.renaming)};
    tell(RecordKind::kObserved, "loc(t1) = " + room, false);
  }
  return now;
}

TEST(Situations, OtherRoomsInAnotherOrderAreTheSameSituation)
{
  Situations situations(floorOf(8));
  const auto one = searched(situations, {"r2", "r3", "r4"});
  const auto other = searched(situations, {"r2", "r7", "r5"});
  const auto longer = searched(situations, {"r6", "r2", "r6", "r8"});
  EXPECT_EQ(one.situation.text(), other.situation.text());
  EXPECT_EQ(one.situation.text(), longer.situation.text());
  // r2 has a name of its own: the default tells it apart.
  const auto elsewhere = searched(situations, {"r3", "r4", "r5"});
  EXPECT_NE(one.situation.text(), elsewhere.situation.text());
  const auto values =
      situations.renamed(*situations.possibleValues(other.situation), other.renaming.inverse());
  EXPECT_EQ(texts(situations.entailed(values)),
            (std::vector<std::string>{"loc(t1) != r2", "loc(t1) != r5", "loc(t1) != r7",
                                      "loc(rob1) = r5"}));
}

TEST(Situations, WhatComparesConstantsByTheirOrderTellsThemApart)
{
  const auto ordered = parseDescription(
      "sorts\n  place = {a, b, c}.\n"
      "fluents\n  inertial at : place.\n"
      "actions\n  go(place).\n"
      "axioms\n  go(P) causes at = P.\n  impossible go(P) if at = Q, P < Q.\n",
      "ordered.kr3");
  Situations situations(ordered);
  const auto at = [&](const char* place) {
    return situations
        .canonical(
            Situation().with({{RecordKind::kObserved, std::string("at = ") + place, true, 0}}))
        .situation.text();
  };
  EXPECT_NE(at("a"), at("b"));
}

TEST(Renaming, ChangesWholeNamesAndCanBeTurnedBack)
{
  Renaming swap;
  swap.set("r1", "r10");
  swap.set("r10", "r1");
  EXPECT_EQ(swap.ofText("loc(r1) = r10, r100"), "loc(r10) = r1, r100");
  EXPECT_EQ(swap.inverse().ofText(swap.ofText("f(r1, r10)")), "f(r1, r10)");
  Renaming shift;
  shift.set("r1", "r2");
  shift.set("r2", "r1");
  EXPECT_EQ(swap.then(shift).ofText("r1 r2 r10"), shift.ofText(swap.ofText("r1 r2 r10")));
}

}  // namespace
}  // namespace kr3::reasoner
