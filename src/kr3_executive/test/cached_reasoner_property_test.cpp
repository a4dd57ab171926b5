// A reasoner that looks answers up against one that does not, on random histories told call by call
// with random confidences: the same history, and others that differ from it in confidences alone,
// were answered from the same cache before. KR3_REASONER_CASES=N draws N histories a description,
// KR3_REASONER_SEED the first seed.

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_executive/cached_reasoner.hpp"
#include "kr3_executive/in_process.hpp"

namespace kr3::executive
{
namespace
{

using reasoner::Record;
using reasoner::RecordKind;

const std::atomic<bool> kGoOn{false};
constexpr std::uint32_t kSeveralPlans = 20;

std::uint64_t numberFrom(const char* variable, std::uint64_t otherwise)
{
  const char* text = std::getenv(variable);
  return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

/// A floor; some of it may be told apart by defaults, and somebody may move things, or nobody.
reasoner::Description floorWith(bool exogenous)
{
  return reasoner::parseDescription(
      std::string("sorts\n  place = {a, b, c, d}.\n  robot = {rob}.\n  book = {x, y}.\n"
                  "  thing = robot + book.\n"
                  "fluents\n  inertial loc(thing) : place.\n  inertial has(robot, book).\n"
                  "actions\n  go(robot, place).\n  take(robot, book).\n") +
          (exogenous ? "  exogenous carry(book, place).\n" : "") +
          "axioms\n  go(R, P) causes loc(R) = P.\n  take(R, B) causes has(R, B).\n" +
          (exogenous ? "  carry(B, P) causes loc(B) = P.\n"
                       "  impossible carry(B, P) if loc(B) = P.\n"
                       "  impossible carry(B, P) if has(R, B).\n"
                     : "") +
          "  loc(B) = P if loc(R) = P, has(R, B).\n"
          "  impossible A1, A2 if A1 != A2.\n"
          "  impossible go(R, P) if loc(R) = P.\n"
          "  impossible take(R, B) if loc(R) = P, loc(B) = Q, P != Q.\n"
          "  impossible take(R, B) if has(R, B2).\n"
          "defaults\n  d1(B): loc(B) = b if book(B).\n"
          "  d2(B): loc(B) = c if book(B), loc(B) != b.\n",
      "floor.kr3");
}

/// Calls that tell records, as missions do: what is known of a step, and the action that ends it.
using Calls = std::vector<std::vector<Record>>;

class Drawing
{
public:
  explicit Drawing(std::uint64_t seed) : random_(seed) {}

  Calls calls()
  {
    Calls calls{{{RecordKind::kInitially, "loc(rob) = a", true, 0}}};
    calls[0].push_back({RecordKind::kInitially, "has(rob, x)", false, 0});
    calls[0].push_back({RecordKind::kInitially, "has(rob, y)", false, 0});
    const int steps = below(5);
    for (int step = 0; step <= steps; ++step)
    {
      std::vector<Record> told;
      if (step > 0)
      {
        const RecordKind kind = below(6) == 0 ? RecordKind::kAttempted : RecordKind::kHappened;
        const std::string action =
            below(5) == 0 ? "take(rob, " + book() + ")" : "go(rob, " + place() + ")";
        told.push_back({kind, action, true, step - 1});
      }
      for (int i = below(3); i > 0; --i)
      {
        const bool where = below(5) != 0;
        const std::string statement =
            where ? "loc(" + book() + ") = " + place() : "has(rob, " + book() + ")";
        told.push_back({RecordKind::kObserved, statement, below(where ? 4 : 2) == 0, step});
      }
      if (!told.empty())
        calls.push_back(std::move(told));
    }
    return calls;
  }

  /// The same calls with other confidences; who is certain is drawn once for all of them.
  Calls withConfidences(const Calls& calls, std::uint64_t certain)
  {
    static constexpr double kDoubtful[] = {0.55, 0.7, 0.9, 0.99};
    std::mt19937_64 which(certain);
    Calls drawn = calls;
    for (auto& call : drawn)
    {
      for (Record& record : call)
      {
        const bool doubtful = record.kind == RecordKind::kObserved && which() % 4 != 0;
        record.confidence = doubtful ? kDoubtful[below(4)] : 1.0;
      }
    }
    return drawn;
  }

  int below(int count) { return static_cast<int>(random_() % static_cast<std::uint64_t>(count)); }
  std::string place() { return std::string(1, static_cast<char>('a' + below(4))); }
  std::string book() { return below(3) == 0 ? "y" : "x"; }

private:
  std::mt19937_64 random_;
};

void tell(HighLevelReasoner& reasoner, const Calls& calls)
{
  reasoner.setHistory(calls.front());
  for (std::size_t i = 1; i < calls.size(); ++i)
    reasoner.addRecords(calls[i]);
}

std::set<std::vector<std::string>> sorted(std::vector<std::vector<std::string>> explanations)
{
  for (auto& explanation : explanations)
    std::sort(explanation.begin(), explanation.end());
  return {explanations.begin(), explanations.end()};
}

std::string joined(const std::vector<std::string>& texts)
{
  std::string all;
  for (const auto& text : texts)
    all += text + "; ";
  return all;
}

/// What any search comes to, whichever of equally good plans it finds: under which hypotheses the
/// goal can be reached, how fast, and with `all` in how many ways.
std::set<std::string> summaryOf(const reasoner::PlanResult& result, bool all)
{
  std::set<std::string> found{"entailed " + std::to_string(result.goal_entailed),
                              "all covered " + std::to_string(result.covers_all)};
  for (const auto& plan : result.plans)
  {
    std::string text = joined(plan.hypothesis) + std::to_string(plan.steps.size());
    for (std::size_t i = 0; all && i < plan.steps.size(); ++i)
      text += ", " + joined(plan.steps[i]);
    found.insert(std::move(text));
  }
  return found;
}

/// All that the driver asks a reasoner, as texts.
std::vector<std::string> answersOf(HighLevelReasoner& reasoner, int now)
{
  std::vector<std::string> answers;
  const auto ask = [&](const std::string& question, const auto& answer) {
    try
    {
      answers.push_back(question + ": " + answer());
    }
    catch (const FailedPrecondition&)
    {
      answers.push_back(question + ": inconsistent");
    }
  };
  ask("consistent", [&] { return std::to_string(reasoner.isConsistent()); });
  for (const bool all : {false, true})
  {
    ask(all ? "diagnosis" : "explanations", [&] {
      const auto diagnosis = all ? reasoner.diagnose() : reasoner.minimalExplanations();
      std::string text =
          std::to_string(diagnosis.consistent) + " at " + std::to_string(diagnosis.cost) + " ";
      for (const auto& explanation : sorted(diagnosis.explanations))
        text += "{" + joined(explanation) + "} ";
      return text;
    });
  }
  for (int step = 0; step <= now; ++step)
    ask("at " + std::to_string(step), [&] { return joined(reasoner.entailedAt(step)); });
  for (const char* place : {"a", "b", "c", "d"})
  {
    const std::string literal = std::string("loc(x) = ") + place;
    ask(literal, [&] {
      return std::to_string(static_cast<int>(reasoner.entails(literal, now))) +
             std::to_string(static_cast<int>(reasoner.possible(literal, now)));
    });
    const std::string contrary = std::string("loc(x) != ") + place;
    ask("why " + contrary, [&] {
      const auto why = reasoner.explain(contrary, now);
      return std::to_string(why.entailed) + " " + std::to_string(why.reasons.size());
    });
    for (const std::string& text : {literal, contrary})
    {
      ask("by default " + text, [&] {
        return reasoner.entails(text, now) == reasoner::Answer::kTrue &&
                       reasoner.restsOnDefault(text, now)
                   ? "yes"
                   : "no";
      });
    }
    for (const std::string& wish : {literal, std::string()})
    {
      ask("without for '" + wish + "'", [&] {
        std::string text;
        for (const auto& retraction : reasoner.retractions(wish, now))
        {
          for (const std::size_t record : retraction.records)
            text += std::to_string(record) + " ";
          text += "at " + std::to_string(std::lround(1000 * retraction.log_odds)) + "; ";
        }
        return text;
      });
    }
  }
  for (const std::uint32_t max_plans : {1U, kSeveralPlans})
  {
    for (const char* goal : {"has(rob, x)", "loc(rob) = c and loc(y) = d"})
    {
      ask("plans to " + std::string(goal), [&] {
        const auto plans = summaryOf(reasoner.plan(goal, max_plans, kGoOn), max_plans > 1);
        return joined({plans.begin(), plans.end()});
      });
    }
  }
  return answers;
}

class CachedReasonerLaw : public ::testing::TestWithParam<bool>
{
};

TEST_P(CachedReasonerLaw, AnswersAreThoseWithoutACacheWhateverWasAskedBefore)
{
  const reasoner::Description description = floorWith(GetParam());
  reasoner::PlanOptions options;
  options.max_horizon = 4;
  const std::uint64_t first = numberFrom("KR3_REASONER_SEED", 1);
  const std::uint64_t cases = numberFrom("KR3_REASONER_CASES", 20);
  auto cache = std::make_shared<ReasonerCache>();
  CachedReasoner cached(description, options, cache);
  std::size_t retracting = 0;
  for (std::uint64_t seed = first; seed < first + cases && !HasFailure(); ++seed)
  {
    Drawing drawing(seed);
    const Calls calls = drawing.calls();
    std::vector<Record> all;
    for (const auto& call : calls)
      all.insert(all.end(), call.begin(), call.end());
    const int now = currentStep(all);
    for (const std::uint64_t certain : {seed, seed, seed + 1})
    {
      const Calls drawn = drawing.withConfidences(calls, certain);
      std::string text;
      for (const auto& call : drawn)
      {
        for (const Record& record : call)
          text += reasoner::toString(record) + "\n";
      }
      SCOPED_TRACE("seed " + std::to_string(seed) + "\n" + text);
      InProcessReasoner plain(description, options);
      tell(plain, drawn);
      cached.restart(ConfidenceMatch::kBelowOne);
      tell(cached, drawn);
      const auto expected = answersOf(plain, now);
      EXPECT_EQ(answersOf(cached, now), expected);
      retracting += expected[1].find("wrong") != std::string::npos ? 1 : 0;
    }
  }
  std::cout << retracting << " histories explained by a wrong record\n";
  EXPECT_GT(cache->values_at_any_price.stats().misses, 0U);  // asked what may be given up
  EXPECT_GT(cache->exceptions.stats().misses, 0U);  // and whether a default is behind something
}

INSTANTIATE_TEST_SUITE_P(Floors, CachedReasonerLaw, ::testing::Bool(),
                         [](const auto& floor) -> std::string {
                           return floor.param ? "WhereThingsMayBeMoved" : "WhereNothingIsMoved";
                         });

}  // namespace
}  // namespace kr3::executive
