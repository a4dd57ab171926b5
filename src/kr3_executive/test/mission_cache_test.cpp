// What missions keep from trial to trial: caches that change nothing but the time.

#include <atomic>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_executive/abstract_mission.hpp"
#include "kr3_executive/cached_reasoner.hpp"
#include "kr3_executive/content_cache.hpp"
#include "kr3_executive/scenario.hpp"

namespace kr3::executive
{
namespace
{

using reasoner::Record;
using reasoner::RecordKind;

const std::string kOffice = std::string(KR3_DOMAINS_DIR) + "/office";
const std::atomic<bool> kGoOn{false};

/// Wants everything, or nothing; what it is told of decisions is kept.
class Listener : public MissionObserver
{
public:
  explicit Listener(Interest interest) : interest_(interest) {}
  [[nodiscard]] Interest interest() const override { return interest_; }
  void onEvent(const ReportedEvent& /*event*/) override { ++events; }
  void onBelief(const ReportedBelief& /*belief*/) override { ++events; }
  void onSnapshot(const Snapshot& /*snapshot*/) override { ++events; }
  void onInput(const Input& /*input*/) override { ++inputs; }
  void onDecision(const ReportedDecision& decision) override
  {
    decisions.push_back(decision.kind);
    decisions.insert(decisions.end(), decision.details.begin(), decision.details.end());
    decisions.insert(decisions.end(), decision.basis.begin(), decision.basis.end());
  }

  int events = 0;
  int inputs = 0;
  std::vector<std::string> decisions;

private:
  Interest interest_;
};

AbstractMissionConfig counted()
{
  AbstractMissionConfig config;
  config.driver.budget = {0.5, 0.0, 400};
  config.components_per_whole = 3;
  return config;
}

const std::vector<std::string> kPlaces{"main_library", "office", "kitchen"};

/// A trial, as far as it can be told from outside.
std::vector<std::string> trial(AbstractMissions& missions, std::uint64_t seed,
                               MissionObserver& observer)
{
  const std::string& goal = missions.scenario().goal;
  const std::string truth = missions.targetFluent(goal) + " = " + kPlaces[seed % kPlaces.size()];
  const TrialResult result = missions.run(goal, {truth}, seed, observer);
  std::vector<std::string> told{std::to_string(result.mission.achieved),
                                std::to_string(result.goal_is_true), result.mission.reason,
                                std::to_string(result.mission.ll_actions),
                                std::to_string(result.mission.duration_s)};
  for (const auto& record : result.history)
    told.push_back(reasoner::toString(record) + " " + std::to_string(record.confidence));
  return told;
}

TEST(ContentCache, KeepsTheFirstValueAndForgetsTheOldest)
{
  ContentCache<int> cache(16 * 300);  // two entries a part, with what they cost besides
  const auto key = [](std::uint64_t i) { return Fingerprint{16 * i, i}; };
  EXPECT_EQ(cache.find(key(1)), nullptr);
  EXPECT_EQ(*cache.keep(key(1), 10, 8), 10);
  EXPECT_EQ(*cache.keep(key(1), 20, 8), 10);
  cache.keep(key(2), 2, 8);
  EXPECT_EQ(*cache.find(key(1)), 10);  // the more recently used now
  cache.keep(key(3), 3, 8);
  EXPECT_EQ(cache.find(key(2)), nullptr);
  EXPECT_EQ(*cache.find(key(1)), 10);
  const ContentCacheStats stats = cache.stats();
  EXPECT_EQ(stats.entries, 2U);
  EXPECT_EQ(stats.evictions, 1U);
  EXPECT_EQ(stats.hits, 2U);
  EXPECT_EQ(stats.misses, 2U);
  EXPECT_DOUBLE_EQ(stats.hitRate(), 0.5);
}

TEST(MissionCaches, ATrialGoesAsIfItWereTheFirst)
{
  AbstractMissions kept(kOffice, counted());
  for (std::uint64_t seed = 1; seed <= 6; ++seed)
  {
    AbstractMissions alone(kOffice, counted());
    Listener silent({false, false, false});
    Listener all({true, true});
    const auto first = trial(alone, seed, all);
    EXPECT_EQ(trial(kept, seed, silent), first) << seed;
    EXPECT_EQ(silent.events + silent.inputs, 0);
    EXPECT_TRUE(silent.decisions.empty());
    Listener again({true, true});
    Listener log({false, true, false});
    EXPECT_EQ(trial(kept, seed, again), first) << seed;
    EXPECT_EQ(trial(kept, seed, log), first) << seed;
    EXPECT_EQ(again.decisions, all.decisions) << seed;
    EXPECT_EQ(log.decisions, all.decisions) << seed;
    EXPECT_EQ(log.events, 0);
  }
  for (const auto& [name, stats] : kept.cacheStats())
  {
    static const std::set<std::string> kRarelyAsked{"retractions", "efforts", "plan costs",
                                                    "exceptions", "values at any price"};
    if (kRarelyAsked.count(name) == 0)
    {
      EXPECT_GT(stats.hits, stats.misses / 4) << name;
    }
  }
}

TEST(MissionCaches, ThreadsComeToTheSame)
{
  constexpr std::uint64_t kTrials = 8;
  Listener silent({false, false, false});
  std::vector<std::vector<std::string>> expected;
  AbstractMissions one(kOffice, counted());
  for (std::uint64_t seed = 0; seed < kTrials; ++seed)
    expected.push_back(trial(one, seed, silent));

  AbstractMissions first(kOffice, counted());
  const auto second = first.another();
  std::vector<std::vector<std::string>> found(kTrials);
  const auto work = [&found](AbstractMissions& missions, std::uint64_t from) {
    Listener own({false, false, false});
    for (std::uint64_t seed = from; seed < kTrials; seed += 2)
      found[seed] = trial(missions, seed, own);
  };
  std::thread other(work, std::ref(*second), 1);
  work(first, 0);
  other.join();
  EXPECT_EQ(found, expected);
}

class CachedReasonerTest : public ::testing::Test
{
protected:
  static std::vector<Record> refuted(double confidence)
  {
    return {{RecordKind::kHappened, "move(rob1, main_library)", true, 0},
            {RecordKind::kObserved, "loc(tb1) = main_library", false, 1, confidence}};
  }

  reasoner::Description description = reasoner::readDescription(kOffice + "/domain.kr3");
  const std::string goal = "loc(tb1) = kitchen";
  std::shared_ptr<ReasonerCache> cache = std::make_shared<ReasonerCache>();
};

TEST_F(CachedReasonerTest, AnswersAreThoseOfTheReasoner)
{
  const std::vector<Record> start{{RecordKind::kInitially, "loc(rob1) = office"}};
  InProcessReasoner plain(description, {});
  plain.setHistory(start);
  plain.addRecords(refuted(0.9));
  for (int round = 0; round < 2; ++round)  // the second time from the cache
  {
    CachedReasoner cached(description, {}, cache);
    cached.setHistory(start);
    cached.addRecords(refuted(0.9));
    EXPECT_EQ(cached.diagnose().explanations, plain.diagnose().explanations);
    EXPECT_EQ(cached.entailedAt(1), plain.entailedAt(1));
    for (const char* literal : {"loc(tb1) = aux_library", "loc(tb1) = office"})
    {
      EXPECT_EQ(cached.entails(literal, 1), plain.entails(literal, 1)) << literal;
      EXPECT_EQ(cached.possible(literal, 1), plain.possible(literal, 1)) << literal;
    }
    const auto why = cached.explain("loc(tb1) = aux_library", 1);
    EXPECT_EQ(why.reasons, plain.explain("loc(tb1) = aux_library", 1).reasons);
    const auto plans = cached.plan(goal, 1, kGoOn);
    const auto others = plain.plan(goal, 1, kGoOn);
    ASSERT_EQ(plans.plans.size(), others.plans.size());
    for (std::size_t i = 0; i < plans.plans.size(); ++i)
      EXPECT_EQ(plans.plans[i].steps, others.plans[i].steps);
  }
  EXPECT_EQ(cache->plans.stats().hits, 1U);
  EXPECT_EQ(cache->explanations.stats().hits, 1U);
  EXPECT_EQ(cache->diagnoses.stats().hits, 1U);
}

TEST_F(CachedReasonerTest, AnotherConfidenceCountsOnlyWhereItMatters)
{
  const auto start = readScenario(kOffice + "/scenario.yaml", description).initial_records;
  CachedReasoner sure(description, {}, cache);
  sure.restart(ConfidenceMatch::kBelowOne);
  sure.addRecords(start);
  sure.addRecords(refuted(0.99));
  const auto first = sure.explain("loc(tb1) != main_library", 1);
  const auto least = sure.retractions("loc(tb1) = main_library", 1);
  CachedReasoner doubtful(description, {}, cache);
  doubtful.restart(ConfidenceMatch::kBelowOne);
  doubtful.addRecords(start);
  doubtful.addRecords(refuted(0.6));
  const auto second = doubtful.explain("loc(tb1) != main_library", 1);
  EXPECT_EQ(cache->explanations.stats().hits, 1U);
  EXPECT_EQ(second.record_indices, first.record_indices);
  ASSERT_EQ(second.records.size(), 1U);
  EXPECT_EQ(second.records[0], reasoner::toString(refuted(0.6)[1]));
  const auto more = doubtful.retractions("loc(tb1) = main_library", 1);
  ASSERT_EQ(more.size(), least.size());
  EXPECT_LT(more[0].log_odds, least[0].log_odds);

  doubtful.restart(ConfidenceMatch::kExact);
  doubtful.addRecords(refuted(0.7));
  static_cast<void>(doubtful.diagnose());
  sure.restart(ConfidenceMatch::kExact);
  sure.addRecords(refuted(0.71));
  static_cast<void>(sure.diagnose());
  EXPECT_EQ(cache->diagnoses.stats().hits, 0U);
}

TEST_F(CachedReasonerTest, WhichRecordIsWrongDependsOnHowDoubtfulEachIs)
{
  const auto seenInBoth = [](double in_kitchen, double in_office) -> std::vector<Record> {
    return {{RecordKind::kObserved, "loc(rob1) = corridor", true, 0},
            {RecordKind::kObserved, "loc(tb1) = kitchen", true, 0, in_kitchen},
            {RecordKind::kObserved, "loc(tb1) = office", true, 0, in_office}};
  };
  CachedReasoner cached(description, {}, cache);
  cached.restart(ConfidenceMatch::kBelowOne);
  cached.addRecords(seenInBoth(0.9, 0.6));
  EXPECT_EQ(cached.entails("loc(tb1) = kitchen", 0), reasoner::Answer::kTrue);
  const auto there = cached.plan("in_hand(rob1, tb1)", 1, kGoOn);
  cached.restart(ConfidenceMatch::kBelowOne);
  cached.addRecords(seenInBoth(0.6, 0.9));
  EXPECT_EQ(cached.entails("loc(tb1) = office", 0), reasoner::Answer::kTrue);
  EXPECT_EQ(cached.entails("loc(tb1) = kitchen", 0), reasoner::Answer::kFalse);
  const auto here = cached.plan("in_hand(rob1, tb1)", 1, kGoOn);
  ASSERT_FALSE(there.plans.empty());
  ASSERT_FALSE(here.plans.empty());
  EXPECT_NE(here.plans[0].steps, there.plans[0].steps);
}

/// Longer than what a reasoner keeps step by step.
std::vector<Record> walkedOnAndOn()
{
  constexpr int kSteps = kDefaultHistoryWindow * 3 / 2 + 4;
  std::vector<Record> steps;
  for (int step = 0; step < kSteps; ++step)
  {
    steps.push_back({RecordKind::kHappened,
                     step % 2 == 0 ? "move(rob1, kitchen)" : "move(rob1, corridor)", true, step});
  }
  return steps;
}

reasoner::Description twoPlaces()
{
  return reasoner::parseDescription(
      "sorts\n  place = {kitchen, corridor}.\n  robot = {rob1}.\n"
      "fluents\n  inertial loc(robot) : place.  inertial lit(place).\n"
      "actions\n  move(robot, place).\n"
      "axioms\n  move(R, P) causes loc(R) = P.\n"
      "defaults\n  d1(P): lit(P).\n",
      "two_places.kr3");
}

TEST_F(CachedReasonerTest, WhatIsSupposedIsNotProgressed)
{
  std::vector<Record> steps = walkedOnAndOn();
  steps.push_back({RecordKind::kObserved, "lit(kitchen)", false, 1});
  InProcessReasoner plain(twoPlaces(), {});
  CachedReasoner cached(twoPlaces(), {}, cache);
  for (HighLevelReasoner* reasoner :
       {static_cast<HighLevelReasoner*>(&plain), static_cast<HighLevelReasoner*>(&cached)})
  {
    reasoner->setHistory(steps);
    const auto told = reasoner->minimalExplanations().explanations;
    EXPECT_EQ(told, (std::vector<std::vector<std::string>>{{"init(lit(kitchen), false)"}}));
    EXPECT_THROW(reasoner->entailedAt(1), Error) << "it is progressed over";
    reasoner->suppose(steps);
    EXPECT_EQ(reasoner->minimalExplanations().explanations, told);
    EXPECT_FALSE(reasoner->entailedAt(1).empty());
    reasoner->setHistory(steps);
    EXPECT_THROW(reasoner->entailedAt(1), Error);
  }
}

TEST_F(CachedReasonerTest, WhatIsSupposedIsLeftBehind)
{
  std::vector<Record> steps = walkedOnAndOn();
  steps.insert(steps.begin() + 1, {RecordKind::kObserved, "lit(kitchen)", false, 1});
  const int now = currentStep(steps);
  const Record seen{RecordKind::kObserved, "lit(corridor)", false, now};
  InProcessReasoner plain(twoPlaces(), {});
  CachedReasoner cached(twoPlaces(), {}, cache);
  cached.restart(ConfidenceMatch::kBelowOne);
  for (HighLevelReasoner* reasoner :
       {static_cast<HighLevelReasoner*>(&plain), static_cast<HighLevelReasoner*>(&cached)})
  {
    reasoner->suppose({steps.begin(), steps.end() - 1});
    reasoner->setHistory(steps);
  }
  EXPECT_EQ(cached.entailedAt(now), plain.entailedAt(now));
  for (HighLevelReasoner* reasoner :
       {static_cast<HighLevelReasoner*>(&plain), static_cast<HighLevelReasoner*>(&cached)})
  {
    reasoner->suppose(steps);
    reasoner->addRecords({seen});
  }
  EXPECT_EQ(cached.entailedAt(now), plain.entailedAt(now));
  EXPECT_EQ(cached.minimalExplanations().explanations, plain.minimalExplanations().explanations);
  EXPECT_EQ(cached.entails("lit(corridor)", now), reasoner::Answer::kFalse);
}

TEST_F(CachedReasonerTest, ALongHistoryIsNotLookedUp)
{
  constexpr int kWindow = kDefaultHistoryWindow;
  const std::vector<Record> steps = walkedOnAndOn();
  const auto corridor = twoPlaces();
  InProcessReasoner plain(corridor, {});
  CachedReasoner cached(corridor, {}, cache);
  for (const Record& record : steps)
  {
    plain.addRecords({record});
    cached.addRecords({record});
  }
  const int now = currentStep(steps);
  const std::size_t taken = cache->histories.stats().entries;
  EXPECT_LE(taken, static_cast<std::size_t>(kWindow * 3 / 2));
  EXPECT_EQ(cached.entailedAt(now), plain.entailedAt(now));
  EXPECT_EQ(cached.diagnose().explanations, plain.diagnose().explanations);
  EXPECT_EQ(cache->entailed.stats().entries, 0U);
  Record wrong = steps.back();
  wrong.statement = "move(rob1, nowhere)";
  EXPECT_THROW(cached.addRecords({wrong}), InvalidArgument);
  EXPECT_EQ(cached.entailedAt(now), plain.entailedAt(now));
  cached.restart(ConfidenceMatch::kExact);
  cached.addRecords({steps.front()});
  EXPECT_EQ(cached.entails("loc(rob1) = kitchen", 1), reasoner::Answer::kTrue);
  EXPECT_EQ(cache->answers.stats().entries, 1U);
}

TEST_F(CachedReasonerTest, AWrongRecordIsRefusedAtOnceAndNothingWasTold)
{
  CachedReasoner cached(description, {}, cache);
  cached.addRecords(refuted(0.9));
  const auto before = cached.entailedAt(1);
  Record wrong = refuted(0.9)[1];
  wrong.statement = "loc(tb1) = nowhere";
  EXPECT_THROW(cached.addRecords({wrong}), InvalidArgument);
  wrong = refuted(0.9)[1];
  wrong.confidence = 1.5;
  EXPECT_THROW(cached.addRecords({wrong}), InvalidArgument);
  EXPECT_THROW(cached.setHistory({wrong}), InvalidArgument);
  EXPECT_EQ(cached.entailedAt(1), before);
  cached.restart(ConfidenceMatch::kExact);
  EXPECT_NE(cached.entailedAt(0), before);
}

}  // namespace
}  // namespace kr3::executive
