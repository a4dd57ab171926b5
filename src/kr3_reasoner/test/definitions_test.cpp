// Definitions must give each state one value of every defined fluent: none rests on its own
// negation, instance by instance.

#include <gtest/gtest.h>

#include "kr3_reasoner/reasoner.hpp"
#include "support.hpp"

namespace kr3::reasoner
{
namespace
{

std::string problemsOf(const std::string& text)
{
  return errorOf([&] { static_cast<void>(parseDescription(text, "f")); });
}

/// A game: a position wins when some move leads to one that does not.
std::string game(const std::string& moves)
{
  return "sorts\n position = {p1, p2, p3}.\nstatics\n move(position, position).\nfacts\n" + moves +
         "fluents\n inertial over.\n defined win(position).\n"
         "axioms\n win(X) if move(X, Y), -win(Y), -over.\n";
}

TEST(Definitions, ThatNegateEachOtherAreAnErrorWithThePlaceOfEachRule)
{
  const std::string problems = problemsOf(
      "fluents\n defined a.\n defined b.\n inertial c.\naxioms\n a if c, -b.\n b if -a.\n");
  EXPECT_NE(
      problems.find("f:6:2: the definition of a rests on its own negation, expected "
                    "definitions without such a cycle: a needs -b (f:6) and b needs -a (f:7)"),
      std::string::npos)
      << problems;
}

TEST(Definitions, ThatNegateThemselvesThroughOthersAreAnError)
{
  const std::string problems = problemsOf(
      "fluents\n defined a.\n defined b.\n defined c.\naxioms\n"
      " c if a.\n b if c.\n a if b = false.\n");
  EXPECT_NE(problems.find("f:6:2: the definition of c rests on its own negation"),
            std::string::npos);
  EXPECT_NE(problems.find("c needs a (f:6), a needs -b (f:8) and b needs c (f:7)"),
            std::string::npos)
      << problems;
}

TEST(Definitions, AreJudgedByTheirInstances)
{
  EXPECT_EQ(problemsOf(game(" move(p1, p2).\n move(p2, p3).\n move(p1, p3).\n")), "nothing");
  const std::string problems = problemsOf(game(" move(p1, p2).\n move(p2, p3).\n move(p3, p2).\n"));
  EXPECT_NE(problems.find("f:13:2: the definition of win(p2) rests on its own negation, expected "
                          "definitions without such a cycle: win(p2) needs -win(p3) (f:13) and "
                          "win(p3) needs -win(p2) (f:13)"),
            std::string::npos)
      << problems;
}

TEST(Definitions, AreOneProblemForEachGroupOfFluents)
{
  const std::string problems = problemsOf(
      "fluents\n defined a.\n defined b.\n defined c.\n defined d.\naxioms\n"
      " a if -a.\n b if -c, a.\n c if -b.\n d if -c, -a, -b.\n");
  EXPECT_NE(problems.find("f:7:2: the definition of a "), std::string::npos) << problems;
  EXPECT_NE(problems.find("f:8:2: the definition of b rests"), std::string::npos) << problems;
  EXPECT_EQ(problems.find("definition of d"), std::string::npos) << problems;
}

TEST(Definitions, MayBeRecursiveWithoutNegation)
{
  EXPECT_EQ(problemsOf("fluents\n defined a.\n defined b.\n inertial p.\naxioms\n"
                       " a if b. b if a. b if -p. a if p, b.\n"),
            "nothing");
}

TEST(Definitions, MayLookAtInertialFluentsThatConstraintsTieToThem)
{
  EXPECT_EQ(problemsOf("fluents\n defined a.\n inertial p.\naxioms\n a if -p.\n p if -a.\n"),
            "nothing");
}

TEST(Definitions, OfStaticsMustNotNegateThemselvesEither)
{
  const std::string problems = problemsOf(
      "sorts\n x = {u, v}.\nstatics\n s(x).\n t(x).\n r(x).\nfacts\n r(u).\naxioms\n"
      " s(X) if -t(X), r(X).\n t(X) if -s(X).\n");
  EXPECT_NE(problems.find("s(u) needs -t(u) (f:10) and t(u) needs -s(u) (f:11)"), std::string::npos)
      << problems;
}

TEST(Definitions, OfStaticsThatNegateOthersHoldInAnyOrderOfTheRules)
{
  Reasoner reasoner(parseDescription(
      "sorts\n x = {u, v}.\nstatics\n close(x).\n near(x).\n far(x).\nfacts\n close(u).\n"
      "fluents\n inertial p(x).\naxioms\n far(X) if -near(X).\n near(X) if close(X).\n"
      " false if p(X), far(X).\n",
      "f"));
  for (const std::string where : {"u", "v"})
  {
    EXPECT_EQ(reasoner.entails("far(" + where + ")", 0),
              where == "u" ? Answer::kFalse : Answer::kTrue);
    EXPECT_EQ(reasoner.explain("far(" + where + ")", 0).entailed, where == "v");
    EXPECT_EQ(reasoner.explain("-p(" + where + ")", 0).entailed, where == "v");
  }
  // what is not far may be
  reasoner.setHistory(parseHistory("init(p(u), true).", "h", reasoner.description()));
  EXPECT_EQ(reasoner.explain("p(u)", 0).proof.kind, ReasonKind::kObserved);
  EXPECT_TRUE(reasoner.plan("far(v)").goal_entailed);
  EXPECT_FALSE(reasoner.plan("far(u)").goal_entailed);
}

}  // namespace
}  // namespace kr3::reasoner
