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
  expectProblem("holds(f(X), I) :+ #a(X).", "p:10:16: found ':+', expected '.'");
  expectProblem("occurs(go(x), 0).", "p:10:1: found occurs in the head, expected holds");
  expectProblem(":- #count{X : holds(f(X), I)} > 1.", "p:10:10: found '{', expected '.'");
  expectProblem("holds(f(X), 0) :- #a(X).", "p:10:1: found a rule about step 0");
  expectProblem("holds(f(X+1), I) :- holds(f(X), I).", "p:10:1: found arithmetic");
  // all of them in one run
  expectProblem("occurs(go(x), 0).\nq(X) :- #a(X).", "p:11:1: found q in the head");
}

}  // namespace
}  // namespace kr3::reasoner
