#include <atomic>
#include <thread>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_reasoner/reasoner.hpp"
#include "support.hpp"

namespace kr3::reasoner
{
namespace
{

// Two ways from a to d: in two dear steps, or in three cheap ones; and two workers who act in
// parallel.
const char* const kCourier = R"(
sorts
  node = {a, b, c, d}.
  van = {van1, van2}.
statics
  road(node, node).
  toll(node, node).
facts
  road(a, b). road(b, c). road(c, d). road(a, c). road(a, d).
  toll(a, c). toll(c, d).
fluents
  inertial at(van) : node.
  inertial wet.
actions
  drive(van, node, node).
axioms
  drive(V, N, M) causes at(V) = M.
  impossible drive(V, N, M) if at(V) != N.
  impossible drive(V, N, M) if -road(N, M).
  impossible drive(V, N, M), drive(V, N, L) if M != L.
  impossible drive(V, a, d) if -wet.
  impossible drive(V, a, d) if wet.
  cost drive(V, N, M) = 10 if toll(N, M).
  cost drive(V, N, M) = 2.5 if -toll(N, M), -wet.
  cost drive(V, N, M) = 3 if -toll(N, M), wet.
)";

Reasoner courier(const std::string& history)
{
  Reasoner reasoner(parseDescription(kCourier, "courier"));
  reasoner.setHistory(parseHistory("init(at(van1) = a, true). init(at(van2) = a, true). " + history,
                                   "history", reasoner.description()));
  return reasoner;
}

PlanOptions preferring(PlanPreference preference)
{
  PlanOptions options;
  options.preference = preference;
  options.max_horizon = 4;
  return options;
}

TEST(PlanPreference, ShortestHasTheFewestStepsThenTheFewestActions)
{
  const PlanResult result = courier("init(wet, false).").plan("at(van1) = d");
  ASSERT_EQ(result.plans.size(), 1U);
  EXPECT_EQ(result.plans[0].steps,
            (std::vector<std::vector<std::string>>{{"drive(van1, a, c)"}, {"drive(van1, c, d)"}}));
  EXPECT_DOUBLE_EQ(result.plans[0].cost, 20.0);
}

TEST(PlanPreference, VansThatDoNotExcludeEachOtherDriveAtTheSameTime)
{
  const PlanResult result = courier("init(wet, false).").plan("at(van1) = b and at(van2) = c");
  ASSERT_EQ(result.plans.size(), 1U);
  EXPECT_EQ(result.plans[0].steps,
            (std::vector<std::vector<std::string>>{{"drive(van1, a, b)", "drive(van2, a, c)"}}));
}

TEST(PlanPreference, TheCheapestPlanMayBeLonger)
{
  const PlanResult result =
      courier("init(wet, false).").plan("at(van1) = c", preferring(PlanPreference::kCheapest));
  ASSERT_EQ(result.plans.size(), 1U);
  EXPECT_EQ(result.plans[0].steps,
            (std::vector<std::vector<std::string>>{{"drive(van1, a, b)"}, {"drive(van1, b, c)"}}));
  EXPECT_DOUBLE_EQ(result.plans[0].cost, 5.0);
  const PlanResult shortest =
      courier("init(wet, false).")
          .plan("at(van1) = c", preferring(PlanPreference::kCheapestShortest));
  ASSERT_EQ(shortest.plans.size(), 1U);
  EXPECT_DOUBLE_EQ(shortest.plans[0].cost, 10.0);
}

TEST(PlanPreference, WhereTheCostDependsOnTheUnknownItIsTheLargestOfTheHypothesis)
{
  const PlanResult result = courier("").plan("at(van1) = b");
  ASSERT_EQ(result.plans.size(), 1U);
  EXPECT_TRUE(result.plans[0].hypothesis.empty());
  EXPECT_DOUBLE_EQ(result.plans[0].cost, 3.0);
}

TEST(PlanPreference, AllPlansThatAreEquallyGoodAreListedInOrder)
{
  PlanOptions options;
  options.all = true;
  // van1 waits for nobody: each of the two may go first, or both at once; the fewest steps are two
  const PlanResult result =
      courier("init(wet, false).").plan("at(van1) = d and at(van2) = b", options);
  ASSERT_EQ(result.plans.size(), 2U);  // van2 drives in the first step or in the second
  EXPECT_TRUE(result.complete);
  EXPECT_LT(result.plans[0].steps, result.plans[1].steps);
  options.max_plans = 1;
  const PlanResult one =
      courier("init(wet, false).").plan("at(van1) = d and at(van2) = b", options);
  EXPECT_EQ(one.plans.size(), 1U);
  EXPECT_FALSE(one.complete);
}

TEST(PlanPreference, SaysWhichConditionCanNeverHold)
{
  const PlanResult forbidden = courier("init(wet, false).").plan("at(van1) = a and at(van1) = b");
  EXPECT_NE(forbidden.reason.find("exclude each other"), std::string::npos) << forbidden.reason;
  Reasoner reasoner(parseDescription(R"(
sorts
  door = {front, back}.
fluents
  inertial open(door).
  inertial key(door).
actions
  unlock(door).
axioms
  unlock(D) causes open(D).
  impossible unlock(D) if -key(D).
)",
                                     "doors"));
  reasoner.setHistory(
      parseHistory("init(open(front), false). init(key(front), false). init(open(back), false).",
                   "history", reasoner.description()));
  const PlanResult locked = reasoner.plan("open(front)");
  EXPECT_TRUE(locked.plans.empty());
  EXPECT_NE(
      locked.reason.find("open(front) can never hold: unlock(front) would bring it about, but "
                         "is never possible: always -key(front) (doors:11)"),
      std::string::npos)
      << locked.reason;
  EXPECT_EQ(reasoner.plan("open(back)").plans.size(), 1U);  // if there is a key
}

// A step that no condition forbids but that leads nowhere is no step of a plan.
TEST(PlanPreference, EveryStepLeadsSomewhere)
{
  Reasoner reasoner(parseDescription(R"(
sorts
  lamp = {red, green}.
fluents
  inertial on(lamp).
actions
  press(lamp).
axioms
  press(L) causes on(L).
  false if on(red), on(green).
)",
                                     "lamps"));
  reasoner.setHistory(parseHistory("init(on(red), false).", "history", reasoner.description()));
  const PlanResult result = reasoner.plan("on(red)");
  ASSERT_EQ(result.plans.size(), 1U);
  EXPECT_EQ(result.plans[0].hypothesis, (std::vector<std::string>{"-on(green)"}));
  EXPECT_FALSE(result.covers_all);
}

TEST(PlanPreference, IsCancelledWithin200Milliseconds)
{
  std::string domain =
      "sorts\n  n = 1..60.\nfluents\n  inertial has(n).\n  inertial at : n.\nactions\n"
      "  go(n).\n  take(n).\naxioms\n  go(N) causes at = N.\n  take(N) causes has(N).\n"
      "  impossible take(N) if at != N.\n  impossible A, B if A != B.\n";
  Reasoner reasoner(parseDescription(domain, "collect"));
  std::string history = "init(at = 1, true). ";
  std::string goal = "has(1)";
  for (int i = 1; i <= 60; ++i)
  {
    history += "init(has(" + std::to_string(i) + "), false). ";
    goal += i > 1 && i < 25 ? " and has(" + std::to_string(i) + ")" : "";
  }
  reasoner.setHistory(parseHistory(history, "history", reasoner.description()));
  using Clock = std::chrono::steady_clock;
  std::atomic<bool> cancel{false};
  Clock::time_point when;
  std::thread canceller([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    when = Clock::now();
    cancel = true;
  });
  PlanOptions options;
  options.max_horizon = 60;
  options.time_limit = std::chrono::minutes(5);
  EXPECT_THROW(static_cast<void>(reasoner.plan(goal, options, &cancel)), Cancelled);
  const auto waited = Clock::now() - when;
  canceller.join();
  EXPECT_LT(waited, std::chrono::milliseconds(200));
}

}  // namespace
}  // namespace kr3::reasoner
