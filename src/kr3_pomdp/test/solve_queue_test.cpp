#include "kr3_pomdp/solve_queue.hpp"

#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <sstream>
#include <vector>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_pomdp/pomdp_format.hpp"
#include "support/models.hpp"

namespace kr3::pomdp
{
namespace
{

constexpr std::chrono::seconds kPatience{20};

ModelText textOf(const Model& model)
{
  std::ostringstream text;
  writePomdp(text, model);
  return {"pomdp", text.str()};
}

/// What a queue calls back, for a test to wait for.
class Log
{
public:
  SolveQueue::Callbacks callbacks(const std::string& key)
  {
    SolveQueue::Callbacks callbacks;
    callbacks.report = [this, key](const SolveReport& report) {
      const std::lock_guard<std::mutex> lock(mutex_);
      reports_[key].push_back(report);
      changed_.notify_all();
    };
    callbacks.done = [this, key](const SolveOutcome& outcome) {
      const std::lock_guard<std::mutex> lock(mutex_);
      order_.push_back(key);
      outcomes_.emplace(key, outcome);
      changed_.notify_all();
    };
    return callbacks;
  }

  SolveOutcome outcome(const std::string& key)
  {
    std::unique_lock<std::mutex> lock(mutex_);
    if (!changed_.wait_for(lock, kPatience, [&] { return outcomes_.count(key) > 0; }))
    {
      throw DeadlineExceeded("no outcome of " + key);
    }
    return outcomes_.at(key);
  }

  /// Waits for a report of this phase.
  SolveReport report(const std::string& key, SolvePhase phase)
  {
    std::unique_lock<std::mutex> lock(mutex_);
    std::optional<SolveReport> found;
    const auto reported = [&] {
      for (const SolveReport& report : reports_[key])
      {
        if (report.phase == phase)
        {
          found = report;
        }
      }
      return found.has_value();
    };
    if (!changed_.wait_for(lock, kPatience, reported))
    {
      throw DeadlineExceeded("no report of " + key);
    }
    return *found;
  }

  std::vector<std::string> order()
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    return order_;
  }

private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::string, std::vector<SolveReport>> reports_;
  std::map<std::string, SolveOutcome> outcomes_;
  std::vector<std::string> order_;
};

SolveRequest quick(double discount = 0.95)
{
  SolveRequest request;
  request.model = textOf(test::tiger(discount));
  request.limits.precision = 0.1;
  request.limits.time_s = 20.0;
  return request;
}

/// Takes all of its time, a minute.
SolveRequest endless()
{
  SolveRequest request;
  request.model = textOf(test::roomSearch(3));
  request.limits.precision = 1e-9;
  request.limits.time_s = 60.0;
  return request;
}

std::shared_ptr<PolicyStore> newStore()
{
  return std::make_shared<PolicyStore>(PolicyStore::Limits{});
}

std::string messageOf(const SolveOutcome& outcome)
{
  try
  {
    std::rethrow_exception(outcome.error);
  }
  catch (const Error& e)
  {
    return e.what();
  }
}

const auto kAll = [](const std::string& /*key*/) { return true; };

TEST(SolveQueue, SolvesAndRemembers)
{
  Log log;
  const auto store = newStore();
  SolveQueue queue(store, {});
  queue.submit("a", quick(), log.callbacks("a"));
  const SolveOutcome first = log.outcome("a");
  ASSERT_FALSE(first.error);
  EXPECT_NEAR(first.solved->lower, 19.37, 0.1);
  EXPECT_EQ(store->policy(first.id), first.solved);
  queue.submit("b", quick(), log.callbacks("b"));
  EXPECT_TRUE(log.outcome("b").cached);
  EXPECT_EQ(log.outcome("b").id, first.id);
  SolveRequest anew = quick();
  anew.ignore_cache = true;
  queue.submit("c", anew, log.callbacks("c"));
  EXPECT_FALSE(log.outcome("c").cached);
  EXPECT_EQ(queue.numSolved(), 2U);
  EXPECT_EQ(queue.numCached(), 1U);
}

TEST(SolveQueue, WaitsInOrderAndAnswersTheKnownAtOnce)
{
  Log log;
  SolveQueue queue(newStore(), {});
  queue.submit("known", quick(0.5), log.callbacks("known"));
  (void)log.outcome("known");
  queue.submit("long", endless(), log.callbacks("long"));
  EXPECT_LE(log.report("long", SolvePhase::kSolving).progress.lower, 1e9);
  queue.submit("second", quick(0.8), log.callbacks("second"));
  queue.submit("third", quick(0.7), log.callbacks("third"));
  EXPECT_EQ(log.report("second", SolvePhase::kQueued).num_ahead, 1U);
  EXPECT_EQ(log.report("third", SolvePhase::kQueued).num_ahead, 2U);
  queue.submit("again", quick(0.5), log.callbacks("again"));
  EXPECT_TRUE(log.outcome("again").cached);
  EXPECT_EQ(queue.cancelIf([](const std::string& key) { return key == "long"; }), 1U);
  (void)log.outcome("third");
  EXPECT_EQ(log.order(), (std::vector<std::string>{"known", "again", "long", "second", "third"}));
}

TEST(SolveQueue, ACancelledRunGivesThePolicySoFar)
{
  Log log;
  const auto store = newStore();
  SolveQueue queue(store, {});
  queue.submit("a", endless(), log.callbacks("a"));
  (void)log.report("a", SolvePhase::kSolving);
  queue.cancelIf(kAll);
  const SolveOutcome outcome = log.outcome("a");
  EXPECT_TRUE(outcome.cancelled);
  ASSERT_FALSE(outcome.error);
  EXPECT_EQ(outcome.solved->reason, StopReason::kCancelled);
  EXPECT_EQ(outcome.id.substr(outcome.id.size() - 10), "-preempted");
  EXPECT_EQ(store->policy(outcome.id), outcome.solved);
  // It must not answer for the whole run.
  queue.submit("b", endless(), log.callbacks("b"));
  (void)log.report("b", SolvePhase::kSolving);
  queue.cancelIf(kAll);
  EXPECT_FALSE(log.outcome("b").cached);
  EXPECT_NE(log.outcome("b").id, outcome.id);
}

TEST(SolveQueue, ACancelledRequestThatWaitsEndsAtOnce)
{
  Log log;
  SolveQueue queue(newStore(), {});
  queue.submit("a", endless(), log.callbacks("a"));
  (void)log.report("a", SolvePhase::kSolving);
  queue.submit("b", quick(), log.callbacks("b"));
  EXPECT_EQ(queue.cancelIf([](const std::string& key) { return key == "b"; }), 1U);
  EXPECT_TRUE(log.outcome("b").cancelled);
  EXPECT_EQ(messageOf(log.outcome("b")), "cancelled before there was a policy");
  EXPECT_EQ(queue.numWaiting(), 0U);
  EXPECT_EQ(queue.numRunning(), 1U);
}

TEST(SolveQueue, ACancelledRequestEndsWhileItsModelIsRead)
{
  Log log;
  SolveQueue::Options options;
  options.grace_s = 0.0;
  SolveQueue queue(newStore(), options);
  SolveRequest request = quick();
  request.model.text =  // two statements, of many entries
      "discount: 0.9\nvalues: reward\nstates: 800\nactions: 4\nobservations: 2\n"
      "T: * uniform\nO: * uniform\n";
  // Cancelled from within the report: later, a busy machine may have solved it.
  SolveQueue::Callbacks callbacks = log.callbacks("a");
  callbacks.report = [&queue](const SolveReport&) { queue.cancelIf(kAll); };
  queue.submit("a", request, callbacks);
  EXPECT_TRUE(log.outcome("a").cancelled);
  // By the reader, or by who watches over it while a statement is not interrupted.
  ASSERT_TRUE(log.outcome("a").error);
  EXPECT_THROW(std::rethrow_exception(log.outcome("a").error), Cancelled);
  queue.submit("b", quick(), log.callbacks("b"));
  EXPECT_FALSE(log.outcome("b").error);
}

TEST(SolveQueue, TheSameContentIsSolvedOnce)
{
  Log log;
  SolveQueue::Options options;
  options.num_workers = 2;
  SolveQueue queue(newStore(), options);
  SolveRequest request = endless();
  request.limits.precision = 1e-3;
  request.limits.time_s = 0.5;
  queue.submit("a", request, log.callbacks("a"));
  (void)log.report("a", SolvePhase::kReading);
  queue.submit("b", request, log.callbacks("b"));
  queue.submit("c", quick(), log.callbacks("c"));  // another content overtakes it
  EXPECT_FALSE(log.outcome("a").cached);
  EXPECT_TRUE(log.outcome("b").cached);
  EXPECT_EQ(log.outcome("b").id, log.outcome("a").id);
  EXPECT_EQ(log.order().front(), "c");
}

TEST(SolveQueue, ErrorsAreOutcomes)
{
  Log log;
  SolveQueue::Options options;
  options.read.max_names = 1000;
  SolveQueue queue(newStore(), options);
  SolveRequest request = quick();
  request.model.text.replace(request.model.text.find("0.8"), 3, "0.9");
  queue.submit("sum", request, log.callbacks("sum"));
  EXPECT_NE(messageOf(log.outcome("sum")).find("sums to 1.1"), std::string::npos);
  EXPECT_NE(messageOf(log.outcome("sum")).find("model:"), std::string::npos);
  request.model.text = "discount: 0.9\nvalues: reward\nstates: 8000000";
  queue.submit("size", request, log.callbacks("size"));
  EXPECT_EQ(messageOf(log.outcome("size")), "a model of 8000000 states, expected at most 1000");
  queue.submit("discount", quick(1.0), log.callbacks("discount"));
  EXPECT_NE(messageOf(log.outcome("discount")).find("discount 1"), std::string::npos);
  queue.submit("good", quick(), log.callbacks("good"));
  EXPECT_FALSE(log.outcome("good").error);
}

TEST(SolveQueue, OnlySoManyWait)
{
  Log log;
  SolveQueue::Options options;
  options.max_waiting = 1;
  SolveQueue queue(newStore(), options);
  queue.submit("a", endless(), log.callbacks("a"));
  (void)log.report("a", SolvePhase::kSolving);
  queue.submit("b", quick(), log.callbacks("b"));
  EXPECT_THROW(queue.submit("c", quick(0.5), log.callbacks("c")), ResourceExhausted);
  queue.cancelIf([](const std::string& key) { return key == "a"; });
  EXPECT_FALSE(log.outcome("b").error);
}

TEST(SolveQueue, StopsSoonWhileSolving)
{
  Log log;
  SolveQueue queue(newStore(), {});
  queue.submit("a", endless(), log.callbacks("a"));
  (void)log.report("a", SolvePhase::kSolving);
  queue.submit("b", quick(), log.callbacks("b"));
  EXPECT_TRUE(queue.stop(10.0));
  EXPECT_TRUE(log.order().empty());  // nobody is called any more
  EXPECT_THROW(queue.submit("c", quick(), log.callbacks("c")), FailedPrecondition);
}

TEST(SolveQueue, RefusesBadOptions)
{
  SolveQueue::Options options;
  options.num_workers = 0;
  EXPECT_THROW(SolveQueue(newStore(), options), InvalidArgument);
  options.num_workers = 1;
  options.report_period_s = 0.0;
  EXPECT_THROW(SolveQueue(newStore(), options), InvalidArgument);
  EXPECT_THROW(SolveQueue(nullptr, {}), InvalidArgument);
}

}  // namespace
}  // namespace kr3::pomdp
