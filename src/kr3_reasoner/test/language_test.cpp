#include "kr3_reasoner/language.hpp"

#include <gtest/gtest.h>

#include "kr3_reasoner/reasoner.hpp"
#include "support.hpp"

namespace kr3::reasoner
{
namespace
{

const std::string kOffice = std::string(KR3_DOMAINS_DIR) + "/office/";

std::string problemsOf(const std::string& text)
{
  return errorOf([&] { static_cast<void>(parseDescription(text, "f")); });
}

TEST(Language, RoundTripsEveryDescription)
{
  for (const std::string& path :
       {kOffice + "domain.kr3", std::string(KR3_TEST_DIR) + "/data/lamps.kr3"})
  {
    const Description description = readDescription(path);
    const std::string text = toString(description);
    EXPECT_EQ(toString(parseDescription(text, "again")), text) << path;
    EXPECT_EQ(parseDescription(text, "again").constraints.size(), description.constraints.size());
  }
}

TEST(Language, RoundTripsTheRefinementOfTheOffice)
{
  const Description base = readDescription(kOffice + "domain.kr3");
  const Description refinement =
      parseRefinement(readText(kOffice + "refinement.kr3"), "refinement.kr3", base);
  ASSERT_EQ(refinement.magnifications.size(), 1U);
  EXPECT_EQ(refinement.causal_laws.at(0).outcomes.at(1).label, "slipped");
  EXPECT_TRUE(refinement.causal_laws.at(0).outcomes.at(1).effects.at(0).is_choice);
  const std::string text = toString(refinement);
  EXPECT_EQ(toString(parseRefinement(text, "again", base)), text);
}

TEST(Language, CompletesSortsInTheOrderOfTheirDeclaration)
{
  const Description description =
      parseDescription("sorts\n a = {x, y}.\n c = {z} + a + r.\n r = 1..3.\n", "f");
  EXPECT_EQ(description.findSort("c")->elements,
            (std::vector<std::string>{"z", "x", "y", "1", "2", "3"}));
}

TEST(Language, ReportsAllErrorsOfAFileWithTheirPlaces)
{
  const std::string problems =
      problemsOf("sorts\n a = {x}.\n b = {y\nfluents\n inertial f(aa).\naxioms\n f(X) if X = .\n");
  EXPECT_NE(problems.find("f:3:8: found the end, expected ',' or '}'"), std::string::npos)
      << problems;
  EXPECT_NE(problems.find("f:5:2: unknown sort 'aa'; did you mean 'a'?"), std::string::npos)
      << problems;
  EXPECT_NE(problems.find("f:7:14: found '.', expected a name, a number or a variable"),
            std::string::npos)
      << problems;
}

struct Mistake
{
  const char* axioms;
  const char* message;
};

class LanguageMistakes : public testing::TestWithParam<Mistake>
{
};

TEST_P(LanguageMistakes, AreNamed)
{
  const std::string start =
      "sorts\n place = {office, kitchen}.\n box = {b1}.\n"
      "statics\n near(place, place).\n"
      "fluents\n inertial loc(box) : place.\n inertial open(box).\n defined seen(box).\n"
      "actions\n push(box, place).\n";
  const std::string problems = problemsOf(start + GetParam().axioms);
  EXPECT_NE(problems.find(GetParam().message), std::string::npos) << problems;
}

INSTANTIATE_TEST_SUITE_P(
    All, LanguageMistakes,
    testing::Values(
        Mistake{"axioms\n opn(B) if open(B).\n",
                "f:13:2: unknown fluent, static or sort 'opn'; did you mean 'open'?"},
        Mistake{"axioms\n puhs(B, P) causes open(B).\n",
                "f:13:2: unknown action 'puhs'; did you mean 'push'?"},
        Mistake{"axioms\n push(B) causes open(B).\n",
                "found 1 arguments of the action push, expected 2"},
        Mistake{"axioms\n push(B, P) causes seen(B).\n",
                "found the defined fluent seen as an effect"},
        Mistake{"axioms\n push(B, P) causes near(P, P).\n", "found the static near as an effect"},
        Mistake{"axioms\n push(B, B) causes open(B).\n",
                "positions of the sorts box and place, which have no common"},
        Mistake{"axioms\n open(B) if Z != b1.\n", "the variable Z is unsafe"},
        Mistake{"axioms\n push(B, P) causes loc(B) = ofice.\n",
                "found 'ofice', expected an element of the sort place"},
        Mistake{"axioms\n push(B, P) causes loc(B).\n", "found loc without a value"},
        Mistake{"axioms\n push(B, P) causes open(B) = P.\n",
                "expected true or false: it is boolean"},
        Mistake{"axioms\n seen(B) if not open(B).\n",
                "found 'not' before the fluent open, expected '-'"},
        Mistake{"axioms\n -seen(B) if open(B).\n", "expected a positive head"},
        Mistake{"fluents\n inertial open(place).\n", "'open' is declared twice, first as a fluent"},
        Mistake{"sorts\n p = q.\n q = p.\n", "contains itself, expected no cycle of sorts"},
        Mistake{"facts\n near(office, P).\n",
                "found the variable P, expected a fact without variables"},
        Mistake{"facts\n open(b1).\n", "found the fluent open in a fact, expected a static"},
        Mistake{"defaults\n d(B): seen(B).\n",
                "the default d is about seen, expected an inertial fluent"},
        Mistake{"defaults\n d(B): open(B).\n e(B): -open(B).\n prefer d(X) over e(X).\n prefer "
                "e(X) over d(X).\n",
                "closes a cycle, expected an order"},
        Mistake{"axioms\n push(B, P) causes open(B) or nothing.\n",
                "found several outcomes without a label"}));

TEST(Language, GroundLiteralsAndGoalsAreChecked)
{
  const Description office = readDescription(kOffice + "domain.kr3");
  EXPECT_EQ(toString(parseGroundLiteral("loc(tb1)=office", office)), "loc(tb1) = office");
  EXPECT_EQ(toString(parseGroundLiteral("-in_hand(rob1,tb1)", office)), "-in_hand(rob1, tb1)");
  EXPECT_NE(errorOf([&] {
              static_cast<void>(parseGroundLiteral("loc(tb1) = ofice", office));
            }).find("did you mean 'office'?"),
            std::string::npos);
  EXPECT_NE(errorOf([&] {
              static_cast<void>(parseGroundAction("move(tb1, office)", office));
            }).find("expected an element of the sort robot"),
            std::string::npos);
  EXPECT_EQ(toString(parseGoal(
                "loc(tb1) = office and not (in_hand(rob1, tb1) or loc(tb2) != kitchen)", office)),
            "loc(tb1) = office and not (in_hand(rob1, tb1) or loc(tb2) != kitchen)");
  EXPECT_NE(errorOf([&] {
              static_cast<void>(parseGoal("loc(tb1) = office and", office));
            }).find("found the end"),
            std::string::npos);
}

TEST(Language, HistoriesRoundTripAndNameTheirMistakes)
{
  const Description office = readDescription(kOffice + "domain.kr3");
  const std::string text =
      "init(loc(rob1) = office, true).\nhpd(move(rob1, kitchen), 0).\n"
      "obs(loc(tb1) = kitchen, false, 1) [0.9].\nattempt(grasp(rob1, mug1), 1).\n";
  const std::vector<Record> records = parseHistory(text, "h", office);
  std::string printed;
  for (const Record& record : records)
  {
    printed += toString(record) + ".\n";
  }
  EXPECT_EQ(printed, text);
  const std::string problems = errorOf([&] {
    static_cast<void>(parseHistory(
        "obs(loc(tb1) = kitchen, maybe, 1).\nhpd(mov(rob1, office), 0).\n", "h", office));
  });
  EXPECT_NE(problems.find("h:1:1: "), std::string::npos) << problems;
  EXPECT_NE(problems.find("h:2:1: "), std::string::npos) << problems;
}

}  // namespace
}  // namespace kr3::reasoner
