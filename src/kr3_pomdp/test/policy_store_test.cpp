#include "kr3_pomdp/policy_store.hpp"

#include <sstream>
#include <thread>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_pomdp/pomdp_format.hpp"
#include "support/models.hpp"

namespace kr3::pomdp
{
namespace
{

std::shared_ptr<const NamedModel> tiger(double discount = 0.95)
{
  std::ostringstream text;
  writePomdp(text, test::tiger(discount));
  return std::make_shared<const NamedModel>(
      NamedModel{{"pomdp", text.str()}, test::tiger(discount)});
}

SolverLimits precise(double precision)
{
  SolverLimits limits;
  limits.precision = precision;
  limits.time_s = 30.0;
  return limits;
}

std::shared_ptr<const SolvedModel> solved(double discount, double precision = 0.5)
{
  const auto source = tiger(discount);
  const SolverLimits limits = precise(precision);
  return std::make_shared<const SolvedModel>(
      solvedModel(source, limits, solve(source->model, limits)));
}

std::size_t sizeOf(const std::shared_ptr<const SolvedModel>& entry)
{
  PolicyStore store({std::size_t{1} << 20U, 10});
  store.put(entry);
  return store.statistics().bytes;
}

std::string errorOf(const std::function<void()>& call)
{
  try
  {
    call();
  }
  catch (const NotFound& e)
  {
    return e.what();
  }
  return "no error";
}

bool contains(const std::string& text, const std::string& part)
{
  return text.find(part) != std::string::npos;
}

TEST(PolicyStore, ThePolicyUsedLongestAgoGoesFirst)
{
  const auto a = solved(0.90);
  const auto b = solved(0.91);
  const auto c = solved(0.92);
  PolicyStore store({sizeOf(a) + sizeOf(b) + sizeOf(c) - 1, 10});
  const std::string id_a = store.put(a);
  const std::string id_b = store.put(b);
  EXPECT_EQ(store.policy(id_a), a);
  const std::string id_c = store.put(c);
  EXPECT_EQ(store.policy(id_a), a);
  EXPECT_EQ(store.policy(id_c), c);
  EXPECT_TRUE(contains(errorOf([&] { (void)store.policy(id_b); }), "was evicted"));
  EXPECT_EQ(store.statistics().evicted_policies, 1U);
  EXPECT_LE(store.statistics().bytes, store.limits().max_bytes);
}

TEST(PolicyStore, APolicyWithBeliefsGoesAfterThoseWithout)
{
  const auto a = solved(0.90);
  const auto b = solved(0.91);
  const auto c = solved(0.92);
  PolicyStore store({sizeOf(a) + sizeOf(b) + sizeOf(c) - 1, 10});
  const std::string id_a = store.put(a);
  const StoredBelief belief = store.create(id_a, a->model().initialBelief());
  const std::string id_b = store.put(b);
  const std::string id_c = store.put(c);
  EXPECT_EQ(store.policy(id_a), a);
  EXPECT_THROW((void)store.policy(id_b), NotFound);
  EXPECT_EQ(store.info(id_a).num_beliefs, 1U);
  // With nothing else to go, it goes, and its beliefs with it.
  const StoredBelief other = store.create(id_c, c->model().initialBelief());
  EXPECT_EQ(store.belief(other.id).policy_id, id_c);
  store.put(b);
  EXPECT_THROW((void)store.policy(id_a), NotFound);
  EXPECT_TRUE(contains(errorOf([&] { (void)store.belief(belief.id); }), "with its policy"));
  EXPECT_EQ(store.statistics().evicted_beliefs, 1U);
}

TEST(PolicyStore, WhatIsInUseOutlivesItsEviction)
{
  const auto a = solved(0.90);
  PolicyStore store({sizeOf(a) + 200, 10});
  const std::string id = store.put(a);
  const auto held = store.policy(id);
  store.put(solved(0.91));
  EXPECT_THROW((void)store.policy(id), NotFound);
  EXPECT_EQ(held->model().numStates(), 2U);
}

TEST(PolicyStore, PuttingTwiceReplacesAndKeepsBeliefs)
{
  const auto a = solved(0.90);
  PolicyStore store({std::size_t{1} << 20U, 10});
  const std::string id = store.put(a);
  const StoredBelief belief = store.create(id, a->model().initialBelief());
  const std::size_t bytes = store.statistics().bytes;
  EXPECT_EQ(store.put(solved(0.90)), id);
  EXPECT_EQ(store.statistics().bytes, bytes);
  EXPECT_EQ(store.statistics().num_policies, 1U);
  EXPECT_EQ(store.belief(belief.id).belief, belief.belief);
  EXPECT_EQ(store.release(id), 1U);
  EXPECT_EQ(store.statistics().bytes, 0U);
}

TEST(PolicyStore, RefusesWhatIsTooLarge)
{
  const auto a = solved(0.90);
  PolicyStore small({10, 10});
  EXPECT_THROW(small.put(a), ResourceExhausted);
  EXPECT_EQ(small.statistics().num_policies, 0U);
  EXPECT_THROW(PolicyStore({0, 1}), InvalidArgument);
  EXPECT_THROW(PolicyStore({1, 0}), InvalidArgument);
  PolicyStore tight({sizeOf(a) + 8, 10});
  const std::string id = tight.put(a);
  EXPECT_THROW((void)tight.create(id, a->model().initialBelief()), ResourceExhausted);
  EXPECT_EQ(tight.policy(id), a);
}

TEST(PolicyStore, BeliefsAreBoundedInNumber)
{
  const auto a = solved(0.90);
  PolicyStore store({std::size_t{1} << 20U, 2}, "b");
  const std::string id = store.put(a);
  const std::string first = store.create(id, a->model().initialBelief()).id;
  const std::string second = store.create(id, a->model().initialBelief()).id;
  EXPECT_EQ(store.belief(first).id, first);
  const std::string third = store.create(id, a->model().initialBelief()).id;
  EXPECT_TRUE(contains(errorOf([&] { (void)store.belief(second); }), "more than 2"));
  store.erase(first);
  EXPECT_TRUE(contains(errorOf([&] { (void)store.belief(first); }), "was deleted"));
  EXPECT_TRUE(contains(errorOf([&] { (void)store.belief("never"); }), "no belief 'never'"));
  ASSERT_EQ(store.beliefs("").size(), 1U);
  EXPECT_EQ(store.beliefs("")[0].id, third);
  EXPECT_TRUE(store.beliefs("other").empty());
  EXPECT_EQ(store.info(id).num_beliefs, 1U);
}

TEST(PolicyStore, FindsWhatAnswersARequest)
{
  PolicyStore store({std::size_t{1} << 20U, 2});
  const auto rough = solved(0.9, 1.0);
  const auto fine = solved(0.9, 0.01);
  const std::string id_rough = store.put(rough);
  const std::string id_fine = store.put(fine);
  const ModelText& text = rough->source->text;
  EXPECT_EQ(store.find(text, precise(1.0))->id, id_fine);  // the most precise one
  EXPECT_EQ(store.find(text, precise(0.1))->id, id_fine);
  EXPECT_FALSE(store.find(text, precise(1e-9)));
  EXPECT_FALSE(store.find({"pomdp", text.text + "\n"}, precise(1.0)));
  SolverLimits counted = precise(1.0);
  counted.max_backups = 10;
  EXPECT_FALSE(store.find(text, counted));  // must repeat exactly
  store.release(id_fine);
  EXPECT_EQ(store.find(text, precise(1.0))->id, id_rough);
  EXPECT_EQ(store.findModel(text), rough->source);
  store.release(id_rough);
  EXPECT_EQ(store.findModel(text), nullptr);
}

TEST(PolicyStore, ManyThreadsShareIt)
{
  const auto a = solved(0.90);
  const auto b = solved(0.91);
  // Room for one policy and some beliefs, so that evictions go on all the time.
  PolicyStore store({std::max(sizeOf(a), sizeOf(b)) + 3000, 5});
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
  {
    threads.emplace_back([&store, &entry = t % 2 == 0 ? a : b] {
      for (int i = 0; i < 300; ++i)
      {
        try
        {
          const std::string id = store.put(entry);
          const StoredBelief belief = store.create(id, entry->model().initialBelief());
          (void)belief.belief->advance("listen", i % 3 == 0 ? "hear_right" : "hear_left", 0);
          store.resized(belief.id);
          store.erase(belief.id);
        }
        catch (const NotFound&)
        {
          continue;  // another thread's policy took the place
        }
      }
    });
  }
  for (std::thread& thread : threads)
  {
    thread.join();
  }
  EXPECT_LE(store.statistics().bytes, store.limits().max_bytes);
  for (const StoredPolicy& policy : store.policies())
  {
    store.release(policy.id);
  }
  EXPECT_EQ(store.statistics().bytes, 0U);
  EXPECT_EQ(store.statistics().num_beliefs, 0U);
}

TEST(Answers, ACancelledRunAnswersOnlyByItsPrecision)
{
  SolvedModel cancelled = *solved(0.9, 1.0);
  cancelled.reason = StopReason::kCancelled;
  cancelled.upper = cancelled.lower + 0.7;
  EXPECT_TRUE(answers(cancelled, precise(0.8)));
  EXPECT_FALSE(answers(cancelled, precise(0.6)));
  cancelled.upper = cancelled.lower + 2.0;
  EXPECT_FALSE(answers(cancelled, cancelled.limits));
}

TEST(Answers, MoreTimeAndMemoryAnswerLess)
{
  SolvedModel known = *solved(0.9, 1.0);
  known.reason = StopReason::kTimeLimit;
  known.upper = known.lower + 100.0;
  known.limits = precise(0.1);
  known.limits.time_s = 10.0;
  known.limits.max_memory_bytes = 1000;
  SolverLimits wanted = known.limits;
  wanted.time_s = 5.0;
  EXPECT_TRUE(answers(known, wanted));
  wanted.max_memory_bytes = 500;
  EXPECT_TRUE(answers(known, wanted));
  wanted.max_memory_bytes = 0;  // no limit
  EXPECT_FALSE(answers(known, wanted));
  wanted = known.limits;
  wanted.precision = 0.05;
  EXPECT_FALSE(answers(known, wanted));
  wanted = known.limits;
  wanted.time_s = 0.0;
  EXPECT_FALSE(answers(known, wanted));
}

TEST(ContentHash, DiffersWhereTextsDo)
{
  EXPECT_EQ(contentHash(std::string("a")).size(), 32U);
  EXPECT_EQ(contentHash(std::string("a")), contentHash(std::string("a")));
  EXPECT_NE(contentHash(std::string("a")), contentHash(std::string("b")));
  EXPECT_NE(contentHash(std::string()), contentHash(std::string("a")));
}

}  // namespace
}  // namespace kr3::pomdp
