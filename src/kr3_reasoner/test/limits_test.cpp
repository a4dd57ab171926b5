// Every question ends with its limit, and leaves the reasoner as it was.

#include <atomic>
#include <chrono>
#include <functional>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "kr3_reasoner/reasoner.hpp"
#include "support.hpp"

namespace kr3::reasoner
{
namespace
{

using std::chrono::milliseconds;

/// Things on shelves, of which nothing is known but that no two fit together: slow to search.
std::string shelves(int things, int places)
{
  const std::string last_thing = std::to_string(things);
  const std::string last_place = std::to_string(places);
  return "sorts\n thing = 1.." + last_thing + ".\n shelf = 1.." + last_place +
         ".\nfluents\n inertial on(thing) : shelf.\n inertial lit(shelf).\n"
         "actions\n put(thing, shelf).\n exogenous slip(thing, shelf).\n"
         "axioms\n put(T, S) causes on(T) = S.\n slip(T, S) causes on(T) = S.\n"
         " false if on(T1) = S, on(T2) = S, T1 != T2.\n"
         "defaults\n d(S): lit(S).\n";
}

Reasoner slowReasoner()
{
  // one thing too many for the shelves: a pigeonhole problem
  Reasoner reasoner(parseDescription(shelves(12, 11), "f"));
  reasoner.setHistory(parseHistory("obs(lit(1), true, 1).", "h", reasoner.description()));
  return reasoner;
}

Reasoner quickReasoner()
{
  Reasoner reasoner(parseDescription(shelves(3, 4), "f"));
  Record doubtful;
  doubtful.statement = "on(1) = 2";
  doubtful.confidence = 0.9;
  reasoner.setHistory(
      parseHistory("init(on(1) = 1, true). hpd(put(2, 3), 0). "
                   "obs(lit(1), false, 1).",
                   "h", reasoner.description()));
  reasoner.addRecords({doubtful});
  return reasoner;
}

struct NamedQuestion
{
  const char* name;
  std::function<void(const Reasoner&)> ask;
};

std::vector<NamedQuestion> questions()
{
  return {
      {"diagnosis", [](const Reasoner& r) { static_cast<void>(r.diagnose()); }},
      {"entailment", [](const Reasoner& r) { static_cast<void>(r.entails("lit(1)", 1)); }},
      {"entailment", [](const Reasoner& r) { static_cast<void>(r.possible("lit(1)", 1)); }},
      {"entailment", [](const Reasoner& r) { static_cast<void>(r.entailedAt(1)); }},
      {"entailment", [](const Reasoner& r) { static_cast<void>(r.possibleValues("on(1)", 1)); }},
      {"the enumeration of models", [](const Reasoner& r) { static_cast<void>(r.models(0)); }},
      {"explanation", [](const Reasoner& r) { static_cast<void>(r.explain("lit(2)", 1)); }},
      {"explanation", [](const Reasoner& r) { static_cast<void>(r.whyUnknown("on(3) = 4", 1)); }},
      {"the search for retractions", [](const Reasoner& r) { static_cast<void>(r.retractions()); }},
      {"the search for retractions",
       [](const Reasoner& r) { static_cast<void>(r.retractionsFor("on(1) = 2", 0)); }},
      {"the search for retractions",
       [](const Reasoner& r) { static_cast<void>(r.leastCertainRefutation("on(1)")); }},
      {"the translation", [](const Reasoner& r) { static_cast<void>(r.translation()); }},
      {"planning", [](const Reasoner& r) { static_cast<void>(r.plan("on(1) = 4")); }}};
}

/// What a question throws, with its code.
std::string failureOf(const std::function<void()>& ask)
{
  try
  {
    ask();
  }
  catch (const Error& e)
  {
    return std::string(toString(e.code())) + ": " + e.what();
  }
  return "nothing";
}

TEST(Limits, EndEveryQuestionThatIsCancelled)
{
  const std::atomic<bool> cancel{true};
  for (const NamedQuestion& question : questions())
  {
    Reasoner reasoner = quickReasoner();
    reasoner.setLimits({milliseconds(0), &cancel});
    EXPECT_EQ(failureOf([&] { question.ask(reasoner); }),
              "CANCELLED: " + std::string(question.name) + " was cancelled");
  }
}

TEST(Limits, LeaveTheReasonerAsItWas)
{
  std::atomic<bool> cancel{true};
  const Reasoner expected = quickReasoner();
  Reasoner reasoner = quickReasoner();
  for (const NamedQuestion& question : questions())
  {
    cancel = true;
    reasoner.setLimits({milliseconds(0), &cancel});
    EXPECT_NE(failureOf([&] { question.ask(reasoner); }), "nothing") << question.name;
    reasoner.setLimits({});
    EXPECT_EQ(failureOf([&] { question.ask(reasoner); }), "nothing") << question.name;
    reasoner.setHistory(expected.history());  // forgets what was found out
  }
  EXPECT_EQ(reasoner.entails("on(2) = 3", 1), Answer::kTrue);
  EXPECT_EQ(reasoner.explain("on(2) = 3", 1).records, expected.explain("on(2) = 3", 1).records);
  EXPECT_EQ(reasoner.diagnose().explanations, expected.diagnose().explanations);
}

TEST(Limits, HoldInALongSearch)
{
  Reasoner reasoner = slowReasoner();
  reasoner.setLimits({milliseconds(30), nullptr});
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(failureOf([&] { static_cast<void>(reasoner.diagnose()); }),
            "DEADLINE_EXCEEDED: diagnosis took longer than its time limit");
  // far longer without a limit; the bound only has to tell the two apart on a busy machine
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
}

TEST(Limits, CancelALongSearchFromAnotherThread)
{
  Reasoner reasoner = slowReasoner();
  std::atomic<bool> cancel{false};
  reasoner.setLimits({milliseconds(0), &cancel});
  std::thread thread([&] { cancel = true; });
  EXPECT_EQ(failureOf([&] { static_cast<void>(reasoner.diagnose()); }),
            "CANCELLED: diagnosis was cancelled");
  thread.join();
}

TEST(Limits, EndTheFirstGrounding)
{
  Reasoner reasoner(parseDescription(shelves(300, 300), "f"));
  reasoner.setLimits({milliseconds(20), nullptr});
  EXPECT_EQ(failureOf([&] { static_cast<void>(reasoner.diagnose()); }),
            "DEADLINE_EXCEEDED: diagnosis took longer than its time limit");
}

TEST(Limits, AreThoseOfWhatIfQuestionsToo)
{
  const std::atomic<bool> cancel{true};
  Reasoner reasoner = quickReasoner();
  reasoner.setLimits({milliseconds(0), &cancel});
  const Reasoner supposed = reasoner.supposing({});
  EXPECT_EQ(failureOf([&] { static_cast<void>(supposed.diagnose()); }),
            "CANCELLED: diagnosis was cancelled");
}

TEST(Limits, OfNegativeTimeAreRefused)
{
  Reasoner reasoner = quickReasoner();
  EXPECT_EQ(failureOf([&] {
              reasoner.setLimits({milliseconds(-1), nullptr});
            }),
            "INVALID_ARGUMENT: found a time limit of -1 ms, expected at least 0");
}

}  // namespace
}  // namespace kr3::reasoner
