// Programs of SPARC that follow the usual translation of AL become descriptions, histories and
// goals.

#include "kr3_reasoner/sparc.hpp"

#include <gtest/gtest.h>

#include "kr3_reasoner/reasoner.hpp"
#include "support.hpp"

namespace kr3::reasoner
{
namespace
{

/// A small delivery domain with all that such programs usually contain.
const std::string kProgramFile = std::string(KR3_TEST_DIR) + "/data/delivery.sp";

TEST(Sparc, IsBroughtBackToTheActionLanguage)
{
  const SparcImport imported = readSparc(kProgramFile);
  Reasoner reasoner(parseDescription(imported.description, "imported"));
  EXPECT_TRUE(reasoner.description().findFluent("loc")->predicate_form);
  EXPECT_EQ(reasoner.description().findFluent("busy")->kind, FluentKind::kDefined);
  reasoner.setHistory(parseHistory(imported.history, "imported", reasoner.description()));
  EXPECT_EQ(reasoner.history().size(), 3U);
  ASSERT_EQ(imported.goals, std::vector<std::string>{"loc(mug, room1)"});
  const PlanResult result = reasoner.plan(imported.goals[0]);
  ASSERT_EQ(result.plans.size(), 1U) << result.reason;
  EXPECT_EQ(result.plans[0].steps, (std::vector<std::vector<std::string>>{{"go(rob1, room2)"},
                                                                          {"go(rob1, room3)"},
                                                                          {"take(rob1, mug)"},
                                                                          {"go(rob1, room2)"},
                                                                          {"go(rob1, room1)"}}));
}

const std::string kStart =
    "#maxint = 9.\nsorts\n#box = {a, b}.\n#spot = #box + {table}.\n#inertial_fluent = on(#box, "
    "#spot) + wet(#box).\n#defined_fluent = above(#box(X), #spot(Y)) : X != Y.\n#fluent = "
    "#inertial_fluent + #defined_fluent.\n#agent_action = put(#box, #spot).\n#exogenous_action = "
    "{rain}.\n#action = #agent_action + #exogenous_action.\n#boolean = {true, false}.\n#step = "
    "0..3.\npredicates\nholds(#fluent, #step).\noccurs(#action, #step).\nobs(#fluent, #boolean, "
    "#step).\nhpd(#action, #step).\nimpossible(#action, #step).\nab_d(#box).\nexpl(#action, "
    "#step).\ngoal(#step).\nrules\n"
    "-holds(F, I) :- #defined_fluent(F), not holds(F, I).\n";

/// The import of a program about boxes with some more rules.
SparcImport importOf(const std::string& rules)
{
  return importSparc(kStart + rules + "\n", "p");
}

TEST(Sparc, TakesWhatWasObservedAndDoneAsRecords)
{
  const SparcImport imported = importOf(
      "occurs(A, I) :- hpd(A, I).\n:- obs(F, true, I), -holds(F, I).\nholds(F, 0) | -holds(F, 0) "
      ":- "
      "#inertial_fluent(F).\n-occurs(A, I) :- impossible(A, I).\nimpossible(put(B, L), I) :- "
      "holds(on(B, L), I).\nholds(on(B, L), I+1) :- occurs(put(B, L), I).\n"
      "obs(on(a, b), false, 0).\nhpd(put(a, b), 0).\noccurs(put(b, table), 1).\n"
      "1 {occurs(A, I) : #agent_action(A)} 1 :- not goal(I).\noccurs(A, I) :+ not goal(I).");
  EXPECT_EQ(imported.history,
            "obs(on(a, b), false, 0).\nhpd(put(a, b), 0).\nhpd(put(b, table), 1).\n");
  const Description description = parseDescription(imported.description, "imported");
  EXPECT_EQ(parseHistory(imported.history, "imported", description).size(), 3U);
  EXPECT_TRUE(description.findAction("rain")->exogenous);
  EXPECT_EQ(description.executabilities.size(), 1U);
  EXPECT_EQ(description.findFluent("expl"), nullptr);
}

TEST(Sparc, TakesInstancesThatAClosedInitialStateDoesNotMentionAsFalse)
{
  const SparcImport imported = importOf(
      "holds(on(a, table), 0).\n-holds(F, 0) :- #inertial_fluent(F), not holds(F, 0).\n"
      "goal(I) :- holds(wet(a), I), not holds(wet(b), I).");
  EXPECT_EQ(imported.history,
            "init(on(a, table), true).\ninit(on(a, a), false).\ninit(on(a, b), false).\n"
            "init(on(b, a), false).\ninit(on(b, b), false).\ninit(on(b, table), false).\n"
            "init(wet(a), false).\ninit(wet(b), false).\n");
  EXPECT_EQ(imported.goals, std::vector<std::string>{"wet(a) and -wet(b)"});
}

TEST(Sparc, TakesRulesWithCrRulesAsDefaults)
{
  const SparcImport imported = importOf(
      "holds(on(B, table), 0) :- #box(B), not ab_d(B).\nab_d(B) :+ #box(B).\n"
      "-holds(wet(B), 0) :- holds(on(B, table), 0), not holds(wet(B), 0).\nholds(wet(B), 0) :+ "
      "#box(B).\n-holds(on(B, L2), I) :- holds(on(B, L1), I), L1 != L2.");
  const Description description = parseDescription(imported.description, "imported");
  ASSERT_EQ(description.defaults.size(), 2U) << imported.description;
  Reasoner reasoner(description);
  reasoner.setHistory(parseHistory("obs(on(a, b), true, 1).", "history", description));
  EXPECT_EQ(reasoner.diagnose().explanations,
            (std::vector<std::vector<std::string>>{{"init(on(a, table), false)"}}));
  EXPECT_EQ(reasoner.entails("-wet(b)", 1), Answer::kTrue);
  EXPECT_EQ(reasoner.entails("wet(a)", 1), Answer::kUnknown);
}

TEST(Sparc, KeepsDefinedFluentsToTheInstancesThatTheyHave)
{
  const SparcImport imported = importOf(
      "holds(above(X, Y), I) :- holds(on(X, Y), I).\nholds(above(X, Z), I) :- holds(on(X, Y), I), "
      "holds(above(Y, Z), I).\n-occurs(put(X, Y), I) | -occurs(put(Y, X), I).");
  const Description description = parseDescription(imported.description, "imported");
  Reasoner reasoner(description);
  reasoner.setHistory(
      parseHistory("init(on(a, a), true). init(on(a, b), true).", "h", description));
  EXPECT_EQ(reasoner.entails("above(a, b)", 0), Answer::kTrue);
  EXPECT_EQ(reasoner.entails("above(a, a)", 0), Answer::kFalse);
  ASSERT_EQ(description.executabilities.size(), 1U);
  EXPECT_EQ(description.executabilities[0].actions.size(), 2U);
}

TEST(Sparc, RefusesWhatIsNotInTheSubsetByLineAndReason)
{
  const std::string start =
      "sorts\n#a = {x}.\n#fluent = f(#a).\n#action = go(#a).\n#step = 0..2.\n"
      "predicates\nholds(#fluent, #step).\noccurs(#action, #step).\nrules\n";
  const auto expectProblem = [&](const std::string& rule, const std::string& message) {
    const std::string problems =
        errorOf([&] { static_cast<void>(importSparc(start + rule + "\n", "p")); });
    EXPECT_NE(problems.find(message), std::string::npos) << problems;
  };
  expectProblem("holds(f(X), I) :- not holds(f(X), I).", "p:10:1: found 'not', expected it in");
  expectProblem("holds(f(X), I+2) :- occurs(go(X), I).", "p:10:1: found a step that is not");
  expectProblem("holds(f(X), I) :+ #a(X).", "p:10:1: found a CR-rule (:+)");
  expectProblem("occurs(go(x), I).", "p:10:1: found occurs with true at I, expected");
  expectProblem(":- #count{X : holds(f(X), I)} > 1.", "p:10:4: found '#count', expected an atom");
  expectProblem(":~ holds(f(x), I). [1]", "p:10:1: found ':~', expected a rule");
  expectProblem("1 {holds(f(X), I) : #a(X)} 1.", "p:10:1: found a choice rule");
  expectProblem("holds(f(x), I) | holds(f(y), I).", "p:10:1: found a disjunction");
  expectProblem("holds(f(X), 0) :- #a(X).", "p:10:1: found a rule about step 0");
  expectProblem("holds(f(X), 0) :- #a(X), not q(X).", "p:10:1: found 'not' in a rule about step 0");
  expectProblem("hpd(go(x), false, 1).", "p:10:1: found an action that did not happen");
  expectProblem("holds(f(X+1), I) :- holds(f(X), I).", "p:10:1: found arithmetic");
  // all of them in one run
  expectProblem("occurs(go(x), I).\nq(X) :- #a(X).", "p:11:1: found q in the head");
  EXPECT_NE(errorOf([] {
              static_cast<void>(importSparc("sorts\n#a = {x}.\nrules\n", "p"));
            }).find("expected a program about actions"),
            std::string::npos);
}

}  // namespace
}  // namespace kr3::reasoner
