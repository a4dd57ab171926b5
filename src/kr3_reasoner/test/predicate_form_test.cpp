// The predicate form of functional fluents, and raw answer set programming code.

#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "kr3_reasoner/language.hpp"
#include "kr3_reasoner/reasoner.hpp"
#include "kr3_reasoner/transition_system.hpp"
#include "support.hpp"

namespace kr3::reasoner
{
namespace
{

std::string problemsOf(const std::string& text)
{
  return errorOf([&] { static_cast<void>(parseDescription(text, "f")); });
}

std::string replaced(std::string text, const std::string& from, const std::string& to)
{
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

/// The paper's domain as its authors print it: predicates and the exclusion law.
std::string paperText()
{
  return readText(std::string(KR3_TEST_DIR) + "/data/paper_predicates.kr3");
}

Reasoner reasonerOf(const std::string& text, const std::string& history)
{
  Reasoner reasoner(parseDescription(text, "text"));
  reasoner.setHistory(parseHistory(history, "history", reasoner.description()));
  return reasoner;
}

Reasoner functionalOffice(const std::string& history)
{
  return reasonerOf(readText(std::string(KR3_DOMAINS_DIR) + "/office/domain.kr3"), history);
}

const std::vector<std::string> kPlaces = {"office",  "main_library", "aux_library",
                                          "kitchen", "study_corner", "corridor"};

/// The histories H1 to H4 of the paper, and some further ones.
const std::vector<std::string> kHistories = {
    "",
    "init(loc(tb1) = main_library, false).",
    "init(loc(tb1) = main_library, false). init(loc(tb1) = aux_library, false).",
    "obs(loc(tb1) = main_library, false, 1).",
    "init(loc(rob1) = office, true). init(in_hand(rob1, tb1), true). hpd(move(rob1, kitchen), 0).",
    "init(loc(rob1) = main_library, true). hpd(grasp(rob1, tb2), 0). hpd(move(rob1, office), 1). "
    "obs(loc(tb2) = office, true, 2).",
    "init(loc(mug1) = kitchen, true). obs(loc(mug1) = office, true, 1).",
    "init(loc(rob1) = kitchen, true). obs(loc(rob1) = office, true, 1)."};

/// Every answer about the places of things, as one text.
std::string answersOf(const Reasoner& reasoner)
{
  const Diagnosis diagnosis = reasoner.diagnose();
  std::string text = "cost " + std::to_string(diagnosis.cost) + "\n";
  if (!diagnosis.consistent)
  {
    return "inconsistent";
  }
  for (int step = 0; step <= reasoner.currentStep(); ++step)
  {
    for (const char* thing : {"rob1", "tb1", "tb2", "mug1", "printer1"})
    {
      for (const std::string& place : kPlaces)
      {
        const std::string literal = "loc(" + std::string(thing) + ") = " + place;
        text += literal + "@" + std::to_string(step) + ": " +
                std::to_string(static_cast<int>(reasoner.entails(literal, step))) +
                (reasoner.possible(literal, step) ? " possible\n" : "\n");
      }
    }
  }
  return text;
}

TEST(PredicateForm, IsRecognisedAsFunctional)
{
  const Description description = parseDescription(paperText() + " total loc.\n", "f");
  const FluentDeclaration* loc = description.findFluent("loc");
  ASSERT_NE(loc, nullptr);
  EXPECT_TRUE(loc->predicate_form);
  EXPECT_EQ(loc->argument_sorts, std::vector<std::string>{"thing"});
  EXPECT_EQ(loc->value_sort, "place");
  EXPECT_FALSE(description.findFluent("in_hand")->value_sort);
  const Description functional =
      readDescription(std::string(KR3_DOMAINS_DIR) + "/office/domain.kr3");
  EXPECT_EQ(description.constraints.size(), functional.constraints.size());
}

TEST(PredicateForm, OfATotalFluentGivesTheAnswersOfTheFunction)
{
  for (const std::string& history : kHistories)
  {
    EXPECT_EQ(answersOf(reasonerOf(paperText() + " total loc.\n", history)),
              answersOf(functionalOffice(history)))
        << history;
  }
}

// As the paper prints it, nothing says that a thing has a place at all.
TEST(PredicateForm, WithTheExclusionLawAloneAgreesOnThePapersHistories)
{
  for (std::size_t i = 0; i < 4; ++i)
  {
    const Reasoner predicates = reasonerOf(paperText(), kHistories[i]);
    const Reasoner functions = functionalOffice(kHistories[i]);
    const int step = predicates.currentStep();
    for (const std::string& place : kPlaces)
    {
      EXPECT_EQ(predicates.entails("loc(tb1, " + place + ")", step),
                functions.entails("loc(tb1) = " + place, step))
          << kHistories[i];
    }
    EXPECT_EQ(predicates.diagnose().cost, functions.diagnose().cost);
  }
}

TEST(PredicateForm, AllowsNoValueUnlessTotal)
{
  std::string nowhere_else;
  for (std::size_t i = 0; i + 1 < kPlaces.size(); ++i)
  {
    nowhere_else += "init(loc(printer1, " + kPlaces[i] + "), false). ";
  }
  EXPECT_EQ(reasonerOf(paperText(), nowhere_else).entails("loc(printer1, corridor)", 0),
            Answer::kUnknown);
  EXPECT_EQ(
      reasonerOf(paperText() + " total loc.\n", nowhere_else).entails("loc(printer1, corridor)", 0),
      Answer::kTrue);
  const std::string nowhere = nowhere_else + "init(loc(printer1, corridor), false).";
  EXPECT_TRUE(reasonerOf(paperText(), nowhere).diagnose().consistent);
  EXPECT_FALSE(reasonerOf(paperText() + " total loc.\n", nowhere).diagnose().consistent);
}

// The definition of equivalence: the rewritten description has the states and transitions of the
// one as written. A second negative head, which forbids nothing, keeps the fluent as it is written.
TEST(PredicateForm, HasTheTransitionsOfTheDescriptionAsWritten)
{
  const std::string text =
      "sorts\n place = {p, q, r}.\n thing = {a, b}.\n"
      "statics\n cursed(thing).\n"
      "fluents\n inertial at(thing, place).\n inertial held(thing).\n defined together.\n"
      "actions\n bring(thing, place).\n hold(thing).\n release(thing).\n"
      "axioms\n bring(T, P) causes at(T, P).\n hold(T) causes held(T).\n"
      " release(T) causes -held(T).\n"
      " -at(T, P1) if at(T, P2), P1 != P2.\n"
      " together if at(a, P), at(b, P).\n"
      " at(b, P) if at(a, P), held(b).\n"
      " impossible bring(T, P) if at(T, P).\n"
      " impossible hold(T) if at(T, P), at(T2, P2), T != T2, P != P2.\n"
      " impossible release(T) if -at(T, p), -at(T, q), -at(T, r).\n";
  const Description rewritten = parseDescription(text, "f");
  const Description written = parseDescription(text + " -at(T, P) if cursed(T), at(T, P).\n", "f");
  ASSERT_TRUE(rewritten.findFluent("at")->predicate_form);
  ASSERT_FALSE(written.findFluent("at")->predicate_form);
  const TransitionSystem functions(rewritten);
  const TransitionSystem predicates(written);
  EXPECT_EQ(functions.states().size(), predicates.states().size());
  ASSERT_EQ(functions.actions(), predicates.actions());
  // Each state as the set of its literals `at(t, p)`, `held(t)`, `together`.
  const auto textOf = [](const TransitionSystem& system, std::size_t state) {
    std::set<std::string> literals;
    for (std::size_t i = 0; i < system.fluents().size(); ++i)
    {
      const GroundFluent& fluent = system.fluents()[i];
      const std::string& value = fluent.values[static_cast<std::size_t>(system.states()[state][i])];
      if (fluent.symbol == "at" && fluent.arguments.size() == 1 && value != "no_place")
      {
        literals.insert("at(" + fluent.arguments[0] + ", " + value + ")");
      }
      else if (value == "true")
      {
        literals.insert(fluent.name);
      }
    }
    std::string text_of_state;
    for (const std::string& literal : literals)
    {
      text_of_state += literal + " ";
    }
    return text_of_state;
  };
  const auto transitionsOf = [&](const TransitionSystem& system) {
    std::set<std::string> transitions;
    for (std::size_t from = 0; from < system.states().size(); ++from)
    {
      for (std::size_t action = 0; action < system.actions().size(); ++action)
      {
        for (const auto& successor : system.successors(from, action))
        {
          transitions.insert(textOf(system, from) + "| " + system.actions()[action] + " | " +
                             textOf(system, successor.state));
        }
      }
    }
    return transitions;
  };
  EXPECT_EQ(transitionsOf(functions), transitionsOf(predicates));
  EXPECT_GT(transitionsOf(functions).size(), 50U);
}

TEST(PredicateForm, StaysBooleanWhereAValueIsOnlyTakenAway)
{
  const std::string drop = " putdown(R, O) causes -loc(O, office).\n";
  EXPECT_FALSE(parseDescription(paperText() + drop, "f").findFluent("loc")->predicate_form);
  const std::string problems = problemsOf(paperText() + drop + " total loc.\n");
  EXPECT_NE(problems.find("found total loc, expected an inertial predicate fluent without negative "
                          "effects"),
            std::string::npos)
      << problems;
  const std::string head = " -loc(O, corridor) if printer(O), in_hand(rob1, O).\n";
  EXPECT_FALSE(parseDescription(paperText() + head, "f").findFluent("loc")->predicate_form);
  EXPECT_TRUE(parseDescription(paperText() + head + " total loc.\n", "f")
                  .findFluent("loc")
                  ->predicate_form);
}

TEST(PredicateForm, IsReadAndPrintedEverywhere)
{
  Reasoner reasoner =
      reasonerOf(paperText() + " total loc.\n",
                 "init(loc(rob1, office), true). obs(-loc(tb1, main_library), true, 1).");
  EXPECT_EQ(toString(reasoner.history()[0]), "init(loc(rob1, office), true)");
  EXPECT_EQ(toString(reasoner.history()[1]), "obs(-loc(tb1, main_library), true, 1)");
  EXPECT_EQ(reasoner.entails("loc(tb1, aux_library)", 1), Answer::kTrue);
  EXPECT_EQ(reasoner.entails("-loc(tb1, aux_library)", 1), Answer::kFalse);
  EXPECT_EQ(reasoner.entails("loc(tb1) = aux_library", 1), Answer::kTrue);
  const Description& description = reasoner.description();
  EXPECT_EQ(
      toString(parseGoal("loc(tb1, office) and not -loc(rob1, office)", description), description),
      "loc(tb1, office) and not -loc(rob1, office)");
  const std::string problems =
      errorOf([&] { static_cast<void>(parseGoal("loc(tb1, office, kitchen)", description)); });
  EXPECT_NE(problems.find("found 3 arguments of the fluent loc, expected 2"), std::string::npos)
      << problems;
  EXPECT_NE(errorOf([&] {
              static_cast<void>(parseGoal("loc(tb1)", description));
            }).find("found 1 arguments of the fluent loc, expected 2"),
            std::string::npos);
}

TEST(PredicateForm, OfADescriptionIsPrintedAsItWasWritten)
{
  for (const std::string& text : {paperText(), paperText() + " total loc.\n"})
  {
    const std::string printed = toString(parseDescription(text, "f"));
    EXPECT_EQ(toString(parseDescription(printed, "again")), printed);
    EXPECT_NE(printed.find("inertial loc(thing, place)."), std::string::npos) << printed;
    EXPECT_NE(printed.find("-loc(X1, Y1) if loc(X1, Y2), Y1 != Y2."), std::string::npos);
    EXPECT_NE(printed.find("move(R, P) causes loc(R, P)"), std::string::npos) << printed;
    EXPECT_EQ(printed.find("no_place"), std::string::npos) << printed;
  }
}

TEST(PredicateForm, CanBeRefinedWhenItIsTotal)
{
  const std::string refinement = readText(std::string(KR3_DOMAINS_DIR) + "/office/refinement.kr3");
  const Description total = parseDescription(paperText() + " total loc.\n", "f");
  EXPECT_NO_THROW(static_cast<void>(parseRefinement(refinement, "r", total)));
  const Description in_predicates = parseRefinement(
      replaced(refinement, "loc(R) = C [reached]", "loc(R, C) [reached]"), "r", total);
  EXPECT_EQ(toString(in_predicates), toString(parseRefinement(refinement, "r", total)));
  const std::string problems = errorOf([&] {
    static_cast<void>(parseRefinement(refinement, "r", parseDescription(paperText(), "f")));
  });
  EXPECT_NE(problems.find("expected 'total loc.' in f"), std::string::npos) << problems;
}

// Three things, and at most two may be in a room at a time: counting is beyond the language.
const char* const kRooms =
    "sorts\n room = {hall, den}.\n cat = {tom, kit, leo}.\n"
    "fluents\n inertial in(cat) : room.\n"
    "actions\n chase(cat, room).\n"
    "axioms\n chase(C, R) causes in(C) = R.\n impossible A, B if A != B.\n";

TEST(AspBlock, JoinsTheProgram)
{
  const std::string block =
      "asp\n x_small(den).\nasp state\n :- x_small(R), 2 { h(in(C),R,t) : sort(cat,C) }.\n"
      "asp transition\n % kit stays in the hall\n x_chased(C,t) :- occ(chase(C,_),t-1).\n"
      " :- x_chased(kit,t), h(in(kit),hall,t-1).\n";
  const std::string start = "init(in(tom) = hall, true). init(in(kit) = hall, true). ";
  EXPECT_EQ(
      reasonerOf(kRooms, start + "init(in(leo) = den, true).").plan("in(tom) = den").plans.size(),
      1U);
  const Reasoner reasoner = reasonerOf(kRooms + block, start + "init(in(leo) = den, true).");
  const PlanResult result = reasoner.plan("in(tom) = den");
  ASSERT_EQ(result.plans.size(), 1U) << result.reason;
  EXPECT_EQ(result.plans[0].steps.size(), 2U);  // leo must leave first
  EXPECT_EQ(reasonerOf(kRooms + block, "init(in(tom) = den, true).").entails("in(kit) = hall", 0),
            Answer::kTrue);
  EXPECT_FALSE(
      reasonerOf(kRooms + block, start + "hpd(chase(kit, den), 0).").diagnose().consistent);
  EXPECT_NE(reasoner.translation().find("% text:12"), std::string::npos);
  const Description description = parseDescription(kRooms + block, "f");
  const std::string printed = toString(description);
  EXPECT_EQ(toString(parseDescription(printed, "again")), printed);
  EXPECT_EQ(description.asp_blocks.size(), 3U);
  const TransitionSystem system(description);
  EXPECT_EQ(system.states().size(), 4U);  // of eight, those with at most one cat in the den
}

TEST(AspBlock, NamesItsMistakesByTheLinesOfTheFile)
{
  const std::string start = kRooms;  // 10 lines
  const auto expectProblem = [&](const std::string& block, const std::string& message) {
    const std::string problems = problemsOf(start + block);
    EXPECT_NE(problems.find(message), std::string::npos) << block << "\n" << problems;
  };
  expectProblem("asp state\n :- h(in(C),R,t), \n", "f:13:1: in asp code: syntax error");
  expectProblem("asp state\n\n x_a(C,D,t) :- h(in(C),_,t).\n",
                "f:13:2: in asp code: unsafe variables in");
  expectProblem("asp state\n :- hh(in(C),R,t).\n",
                "f:12:5: in asp code: unknown predicate 'hh'; did you mean 'h'?");
  expectProblem("asp state\n :- occ(A,t).\n", "f:12:5: in asp code: unknown predicate 'occ'");
  expectProblem("asp state\n :- h(in(C),t).\n",
                "f:12:5: in asp code: found 2 arguments of h, expected 3");
  expectProblem("asp state\n :- h(in(C),R,t+1).\n",
                "f:12:5: in asp code: found the step (t+1) of h, expected t");
  expectProblem("asp transition\n h(in(C),den,t-1) :- occ(chase(C,_),t-1).\n",
                "f:12:2: in asp code: found the step (t-1) of h, expected t");
  expectProblem("asp transition\n occ(chase(tom,den),t-1).\n",
                "f:12:2: in asp code: found occ in a head");
  expectProblem("asp state\n x_a(C) :- h(in(C),_,t).\n",
                "expected t as the last argument of what is derived at each step");
  expectProblem("asp\n :- x_b.\n", "f:12:5: in asp code: nothing defines x_b/0");
  expectProblem("asp\n #show x/1.\n", "f:12:2: in asp code: found a directive");
  expectProblem("asp\n c(1,2).\n", "f:12:2: in asp code: unknown predicate 'c'");
  expectProblem("asp transition\n x_d(C,t) :- occ(chase(C,_),t-1).\n :- x_d(_,t-1).\n",
                "f:13:5: in asp code: found x_d/2, expected it at t and in the part where");
  expectProblem("asp\n -x_c.\n", "expected a predicate without '-'");
  EXPECT_NE(
      errorOf([&] {
        static_cast<void>(parseRefinement("asp\n x_a.\n", "r", parseDescription(kRooms, "f")));
      }).find("r:2:1: found asp code in a refinement"),
      std::string::npos);
  EXPECT_NE(
      errorOf([&] {
        static_cast<void>(parseRefinement("", "r", parseDescription(start + "asp\n x_a.\n", "f")));
      }).find("r:1:1: found asp code in the description, f:12, expected none"),
      std::string::npos);
}

}  // namespace
}  // namespace kr3::reasoner
