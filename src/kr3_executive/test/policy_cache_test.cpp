#include "kr3_executive/policy_cache.hpp"

#include <atomic>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>
#include <kr3_common/testing/temporary_folder.hpp>
#include <kr3_pomdp/belief.hpp>
#include <kr3_pomdp/simulation.hpp>
#include <kr3_refinement/low_level_domain.hpp>
#include <kr3_refinement/models.hpp>
#include <kr3_refinement/pomdp_task.hpp>

#include "kr3_executive/in_process.hpp"

namespace kr3::executive
{
namespace
{

using test_support::TemporaryFolder;

const std::string kDomains = KR3_DOMAINS_DIR;
const SolveBudget kCounted{0.0, 0.0, 150};
const std::atomic<bool> kGoOn{false};

std::string contentsOf(const std::string& path)
{
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The office on a grid of four cells a place.
class Office
{
public:
  explicit Office(double pitch_m = 1.0)
    : high_(reasoner::readDescription(kDomains + "/office/domain.kr3"))
    , domain_(high_,
              reasoner::parseRefinement(contentsOf(kDomains + "/office/refinement.kr3"),
                                        "refinement.kr3", high_),
              refinement::gridMap(high_.findSort("place")->elements, 4, pitch_m))
    , models_(refinement::readModels(kDomains + "/office/models.yaml", domain_.description()))
  {
  }

  /// To grasp an object in the robot's place.
  [[nodiscard]] refinement::PomdpTask grasp(const std::string& place, const std::string& object,
                                            const std::string& cell, double belief) const
  {
    const std::vector<reasoner::Literal> state{
        reasoner::parseGroundLiteral("loc(rob1) = " + place, high_),
        reasoner::parseGroundLiteral("loc(" + object + ") = " + place, high_)};
    const refinement::Zoom zoom = refinement::zoom(
        domain_, state, reasoner::parseGroundAction("grasp(rob1, " + object + ")", high_));
    refinement::InitialKnowledge knowledge;
    knowledge.fine["loc(rob1)"] = {{place + "_" + cell, 1.0}};
    knowledge.coarse["loc(" + object + ")"] = {{place, belief}};
    return refinement::generatePomdp(domain_, models_, zoom, knowledge);
  }

private:
  reasoner::Description high_;
  refinement::LowLevelDomain domain_;
  refinement::Models models_;
};

const Office& office()
{
  static const Office instance;
  return instance;
}

std::string onlyFileIn(const TemporaryFolder& folder)
{
  return std::filesystem::directory_iterator(folder.path())->path().string();
}

/// A policy of one vector, made without solving.
CachedPolicy madeUp(std::size_t num_states, double value)
{
  return {pomdp::Policy(num_states, {{0, {}, std::vector<double>(num_states, value)}}), value,
          value + 1.0, 7, 0.0};
}

PolicyCache::Key keyOf(std::uint64_t number)
{
  Fingerprinter fingerprinter;
  fingerprinter.add(number);
  return fingerprinter.result();
}

TEST(PolicyCache, AHitIsThePolicyThatWasFound)
{
  InProcessPolicyServer server;
  const refinement::PomdpTask task = office().grasp("kitchen", "tb1", "c0", 0.8);
  const SolvedPolicy first = server.solve(task.model(), kCounted, kGoOn);
  const SolvedPolicy second = server.solve(task.model(), kCounted, kGoOn);
  EXPECT_FALSE(first.cached);
  EXPECT_TRUE(second.cached);
  EXPECT_EQ(first.id, second.id);
  EXPECT_EQ(first.lower, second.lower);
  EXPECT_EQ(first.upper, second.upper);
  EXPECT_EQ(first.backups, second.backups);
  EXPECT_EQ(server.stats().hits, 1U);
  EXPECT_EQ(server.stats().misses, 1U);
  EXPECT_DOUBLE_EQ(server.stats().hitRate(), 0.5);
}

TEST(PolicyCache, TheSameTaskWithOtherNamesHitsAndItsIndicesMeanTheSame)
{
  InProcessPolicyServer server;
  const refinement::PomdpTask kitchen = office().grasp("kitchen", "tb1", "c0", 0.8);
  const refinement::PomdpTask library = office().grasp("main_library", "mug1", "c0", 0.8);
  const SolvedPolicy solved = server.solve(kitchen.model(), kCounted, kGoOn);
  const SolvedPolicy found = server.solve(library.model(), kCounted, kGoOn);
  EXPECT_TRUE(found.cached);
  EXPECT_EQ(found.id, solved.id);

  const auto renamed = [](std::string text) {
    for (const auto& [from, to] :
         {std::pair<std::string, std::string>{"kitchen", "main_library"}, {"tb1", "mug1"}})
    {
      for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
    }
    return text;
  };
  // The same trial in both: every action, observation and state is the other's under renaming.
  std::mt19937_64 random(3);
  for (int trial = 0; trial < 30; ++trial)
  {
    pomdp::Belief here = kitchen.model().initialBelief();
    pomdp::Belief there = library.model().initialBelief();
    std::size_t state = pomdp::sampleState(here, random);
    for (int step = 0; step < 30; ++step)
    {
      const std::size_t action = server.actionAt(solved.id, here);
      ASSERT_EQ(server.actionAt(found.id, there), action);
      ASSERT_EQ(renamed(kitchen.actionText(action)), library.actionText(action));
      if (action == kitchen.finishAction())
        break;
      const auto sampled = pomdp::sampleStep(kitchen.model(), state, action, random);
      const std::string observation = renamed(kitchen.model().observationName(sampled.observation));
      ASSERT_EQ(observation, library.model().observationName(sampled.observation));
      state = sampled.next_state;
      ASSERT_EQ(renamed(kitchen.model().stateName(state)), library.model().stateName(state));
      here = pomdp::updated(kitchen.model(), here, action, sampled.observation).posterior;
      there = pomdp::updated(library.model(), there, action, sampled.observation).posterior;
    }
  }
}

TEST(PolicyCache, OtherNumbersStartsAndBudgetsNeverHit)
{
  const Office wide(1.5);
  const std::vector<refinement::PomdpTask> tasks{
      office().grasp("kitchen", "tb1", "c0", 0.8), office().grasp("kitchen", "tb1", "c1", 0.8),
      office().grasp("kitchen", "tb1", "c0", 0.81), wide.grasp("kitchen", "tb1", "c0", 0.8)};
  std::set<std::string> keys;
  std::size_t count = 0;
  for (const refinement::PomdpTask& task : tasks)
  {
    for (const SolveBudget& budget :
         {SolveBudget{0.5, 0.0, 150}, SolveBudget{1e-12, 0.0, 150}, SolveBudget{2e-12, 0.0, 150},
          SolveBudget{0.5, 1.0, 150}, SolveBudget{0.5, 0.0, 151}})
    {
      keys.insert(toString(PolicyCache::keyOf(task.model(), budget)));
      ++count;
    }
  }
  EXPECT_EQ(keys.size(), count);
}

TEST(PolicyCache, CountedWorkGivesTheSamePolicyWithoutTheCache)
{
  const refinement::PomdpTask task = office().grasp("kitchen", "tb1", "c2", 0.7);
  std::string texts[2];
  for (std::string& text : texts)
  {
    PolicyCache cache;
    InProcessPolicyServer server;
    const SolvedPolicy solved = server.solve(task.model(), kCounted, kGoOn);
    std::ostringstream bounds;
    bounds.precision(17);
    bounds << solved.id << solved.lower << solved.upper << solved.backups;
    text = bounds.str();
  }
  EXPECT_EQ(texts[0], texts[1]);
}

TEST(PolicyCache, TheLeastRecentlyUsedGoesFirst)
{
  const refinement::PomdpTask task = office().grasp("kitchen", "tb1", "c0", 0.8);
  const std::size_t n = task.model().numStates();
  PolicyCache probe;
  static_cast<void>(probe.findOrSolve(
      keyOf(0), task.model(), [&] { return madeUp(n, 0.0); }, kGoOn));
  PolicyCacheOptions options;
  options.max_bytes = 3 * probe.stats().bytes + 1;
  PolicyCache cache(options);
  for (std::uint64_t i = 0; i < 3; ++i)
    static_cast<void>(cache.findOrSolve(
        keyOf(i), task.model(), [&] { return madeUp(n, static_cast<double>(i)); }, kGoOn));
  ASSERT_NE(cache.find(keyOf(0)), nullptr);  // used: 1 is the oldest now
  static_cast<void>(cache.findOrSolve(
      keyOf(3), task.model(), [&] { return madeUp(n, 3.0); }, kGoOn));
  EXPECT_NE(cache.find(keyOf(0)), nullptr);
  EXPECT_EQ(cache.find(keyOf(1)), nullptr);
  EXPECT_NE(cache.find(keyOf(3)), nullptr);
  EXPECT_EQ(cache.stats().evictions, 1U);
  EXPECT_EQ(cache.stats().policies, 3U);
  EXPECT_LE(cache.stats().bytes, options.max_bytes);
}

TEST(PolicyCache, OnePolicyIsKeptHoweverSmallTheMemory)
{
  PolicyCacheOptions options;
  options.max_bytes = 1;
  const auto cache = std::make_shared<PolicyCache>(options);
  InProcessPolicyServer server(cache);
  const refinement::PomdpTask task = office().grasp("kitchen", "tb1", "c0", 0.8);
  const SolvedPolicy solved = server.solve(task.model(), kCounted, kGoOn);
  EXPECT_LT(server.actionAt(solved.id, task.model().initialBelief()), task.model().numActions());
  static_cast<void>(
      server.solve(office().grasp("kitchen", "tb1", "c1", 0.8).model(), kCounted, kGoOn));
  EXPECT_THROW(static_cast<void>(server.actionAt(solved.id, task.model().initialBelief())),
               NotFound);
  EXPECT_THROW(static_cast<void>(server.actionAt("no key", task.model().initialBelief())),
               NotFound);
}

TEST(PolicyCache, ThreadsSolveAPolicyOnce)
{
  const auto cache = std::make_shared<PolicyCache>();
  std::atomic<int> differences{0};
  const auto work = [&](unsigned seed) {
    InProcessPolicyServer server(cache);
    std::mt19937 random(seed);
    for (int i = 0; i < 20; ++i)
    {
      const std::string cell = "c" + std::to_string(random() % 4);
      const std::string place = random() % 2 == 0 ? "kitchen" : "main_library";
      const refinement::PomdpTask task = office().grasp(place, "tb1", cell, 0.8);
      const SolvedPolicy solved = server.solve(task.model(), kCounted, kGoOn);
      const std::size_t action = server.actionAt(solved.id, task.model().initialBelief());
      InProcessPolicyServer alone;
      if (i == 0)
      {
        const SolvedPolicy own = alone.solve(task.model(), kCounted, kGoOn);
        differences += own.lower != solved.lower || own.upper != solved.upper ||
                               alone.actionAt(own.id, task.model().initialBelief()) != action
                           ? 1
                           : 0;
      }
    }
  };
  std::vector<std::thread> threads;
  for (unsigned seed = 0; seed < 4; ++seed)
    threads.emplace_back(work, seed);
  for (std::thread& thread : threads)
    thread.join();
  EXPECT_EQ(differences, 0);
  EXPECT_EQ(cache->stats().misses, 4U);  // one for each cell: the place is but a name
  EXPECT_EQ(cache->stats().hits, 76U);
}

TEST(PolicyCache, AFailureIsNotKept)
{
  PolicyCache cache;
  const refinement::PomdpTask task = office().grasp("kitchen", "tb1", "c0", 0.8);
  EXPECT_THROW(static_cast<void>(cache.findOrSolve(
                   keyOf(1), task.model(), []() -> CachedPolicy { throw Cancelled("no"); }, kGoOn)),
               Cancelled);
  const auto found = cache.findOrSolve(
      keyOf(1), task.model(), [&] { return madeUp(task.model().numStates(), 1.0); }, kGoOn);
  EXPECT_FALSE(found.cached);
  EXPECT_EQ(cache.stats().misses, 1U);
}

TEST(PolicyCache, WaitingForAnotherThreadCanBeCancelled)
{
  PolicyCache cache;
  const refinement::PomdpTask task = office().grasp("kitchen", "tb1", "c0", 0.8);
  std::atomic<bool> solving{false};
  std::atomic<bool> may_end{false};
  std::thread other([&] {
    static_cast<void>(cache.findOrSolve(
        keyOf(1), task.model(),
        [&] {
      solving = true;
      while (!may_end)
        std::this_thread::yield();
      return madeUp(task.model().numStates(), 1.0);
        },
        kGoOn));
  });
  while (!solving)
    std::this_thread::yield();
  const std::atomic<bool> cancelled{true};
  EXPECT_THROW(static_cast<void>(cache.findOrSolve(
                   keyOf(1), task.model(), [&] { return madeUp(task.model().numStates(), 2.0); },
                   cancelled)),
               Cancelled);
  may_end = true;
  other.join();
  EXPECT_EQ(cache.find(keyOf(1))->lower, 1.0);
}

TEST(PolicyCache, ADirectoryKeepsPoliciesToTheLastBit)
{
  const TemporaryFolder directory;
  PolicyCacheOptions options;
  options.directory = directory.path();
  const refinement::PomdpTask task = office().grasp("kitchen", "tb1", "c0", 0.8);
  SolvedPolicy first;
  std::string written;
  {
    const auto cache = std::make_shared<PolicyCache>(options);
    first = InProcessPolicyServer(cache).solve(task.model(), kCounted, kGoOn);
    std::ostringstream text;
    cache->find(PolicyCache::keyOf(task.model(), kCounted))->policy.write(text);
    written = text.str();
  }
  const auto cache = std::make_shared<PolicyCache>(options);
  const SolvedPolicy second = InProcessPolicyServer(cache).solve(task.model(), kCounted, kGoOn);
  EXPECT_TRUE(second.cached);
  EXPECT_EQ(cache->stats().disk_hits, 1U);
  EXPECT_EQ(second.id, first.id);
  EXPECT_EQ(second.lower, first.lower);
  EXPECT_EQ(second.upper, first.upper);
  std::ostringstream text;
  cache->find(PolicyCache::keyOf(task.model(), kCounted))->policy.write(text);
  EXPECT_EQ(text.str(), written);
}

TEST(PolicyCache, ADamagedFileCountsAsMissingAndIsNamed)
{
  const TemporaryFolder directory;
  PolicyCacheOptions options;
  options.directory = directory.path();
  std::vector<std::string> warnings;
  options.warn = [&warnings](const std::string& text) { warnings.push_back(text); };
  const refinement::PomdpTask task = office().grasp("kitchen", "tb1", "c0", 0.8);
  const auto solve = [&] {
    const auto cache = std::make_shared<PolicyCache>(options);
    return InProcessPolicyServer(cache).solve(task.model(), kCounted, kGoOn);
  };
  const SolvedPolicy first = solve();
  const std::string file = onlyFileIn(directory);
  const std::string good = contentsOf(file);
  std::string flipped = good;
  flipped[good.size() / 2] = flipped[good.size() / 2] == '1' ? '2' : '1';
  const std::vector<std::string> damaged{
      "",      "nonsense", good.substr(0, good.size() / 2),
      flipped, good + "1", "kr3 cached policy 0" + good.substr(19)};
  for (const std::string& text : damaged)
  {
    std::ofstream(file, std::ios::binary) << text;
    warnings.clear();
    const SolvedPolicy again = solve();
    EXPECT_FALSE(again.cached);
    EXPECT_EQ(again.lower, first.lower);
    ASSERT_EQ(warnings.size(), 1U) << text.substr(0, 80);
    EXPECT_NE(warnings[0].find(file), std::string::npos);
    EXPECT_EQ(contentsOf(file).substr(0, 19), good.substr(0, 19));  // it was written anew
  }
}

TEST(PolicyCache, ADirectoryThatCannotBeMadeIsRefused)
{
  PolicyCacheOptions options;
  options.directory = kDomains + "/office/domain.kr3/policies";
  EXPECT_THROW(PolicyCache{options}, Unavailable);
}

}  // namespace
}  // namespace kr3::executive
