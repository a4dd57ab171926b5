// Every kind of mistake is reported with its place, what was found and what was expected.

#include <gtest/gtest.h>

#include "kr3_reasoner/language.hpp"
#include "kr3_reasoner/reasoner.hpp"
#include "support.hpp"

namespace kr3::reasoner
{
namespace
{

// 11 lines: what a test adds begins in line 12.
const char* const kStart =
    "sorts\n place = {office, kitchen}.\n box = {b1}.\n"
    "statics\n near(place, place).\n"
    "fluents\n inertial loc(box) : place.\n inertial open(box).\n defined seen(box).\n"
    "actions\n push(box, place).\n";

struct Mistake
{
  const char* text;
  const char* message;
};

class LanguageErrors : public testing::TestWithParam<Mistake>
{
};

TEST_P(LanguageErrors, AreNamedWithTheirPlace)
{
  const std::string problems = errorOf(
      [] { static_cast<void>(parseDescription(kStart + std::string(GetParam().text), "f")); });
  EXPECT_NE(problems.find(GetParam().message), std::string::npos) << problems;
}

INSTANTIATE_TEST_SUITE_P(
    Syntax, LanguageErrors,
    testing::Values(
        Mistake{"axioms\n open(B if seen(B).\n", "f:13:9: found 'if', expected ')' or ','"},
        Mistake{"axioms\n open(B) if seen(B)\n",
                "f:14:1: found the end, expected ',', '.', '=', '!='"},
        Mistake{"axioms\n Open(B) if seen(B).\n", "f:13:6: found '(', expected '=', '!=', '<'"},
        Mistake{"axioms\n seen(B) if not open(B).\n",
                "f:13:13: found 'not' before the fluent open, expected '-'"},
        Mistake{"axioms\n open(B) < 3 if seen(B).\n",
                "f:13:10: found '<' after a fluent, expected '=' or '!='"},
        Mistake{"axioms\n Z = b1 if open(Z).\n",
                "f:13:2: found a condition that names no fluent, expected a literal"},
        Mistake{"magnify place into cell by part_of.\n",
                "f:12:1: found 'magnify' in a description, expected it in a refinement only"}));

INSTANTIATE_TEST_SUITE_P(
    Names, LanguageErrors,
    testing::Values(
        Mistake{"axioms\n opn(B) if open(B).\n",
                "f:13:2: unknown fluent, static or sort 'opn'; did you mean 'open'?"},
        Mistake{"axioms\n puhs(B, P) causes open(B).\n",
                "f:13:2: unknown action 'puhs'; did you mean 'push'?"},
        Mistake{"axioms\n open(B) if push(B, P).\n",
                "f:13:13: found the action push, expected a fluent"},
        Mistake{"axioms\n impossible open(B).\n",
                "f:13:13: found the fluent open, expected an action"},
        Mistake{"axioms\n push(B, P) causes loc(B) = ofice.\n",
                "f:13:20: found 'ofice', expected an element of the sort place; did you mean "
                "'office'?"},
        Mistake{"fluents\n inertial f(plcae).\n",
                "f:13:2: unknown sort 'plcae'; did you mean 'place'?"},
        Mistake{"sorts\n p = bxo + place.\n", "f:13:2: unknown sort 'bxo'; did you mean 'box'?"},
        Mistake{"defaults\n d(B): open(B).\n prefer e(B) over d(B).\n",
                "f:14:9: unknown default 'e'"},
        Mistake{"fluents\n inertial open(place).\n",
                "f:13:2: 'open' is declared twice, first as a fluent in line 8"},
        Mistake{"actions\n box(place).\n",
                "f:13:2: 'box' is declared twice, first as a sort in line 3"},
        Mistake{"sorts\n twice = {x, y, x}.\n", "f:13:2: the sort twice has the element 'x' twice"},
        Mistake{"defaults\n d(B): open(B).\n d(B): -open(B).\n",
                "f:14:2: the default 'd' is declared twice"}));

INSTANTIATE_TEST_SUITE_P(
    Sorts, LanguageErrors,
    testing::Values(
        Mistake{"axioms\n push(B, B) causes open(B).\n",
                "f:13:2: the variable B stands in positions of the sorts box and place, which have "
                "no common element"},
        Mistake{"axioms\n open(B) if Z != b1.\n", "f:13:13: the variable Z is unsafe"},
        Mistake{"axioms\n open(b1) if not place(Z).\n", "f:13:14: the variable Z is unsafe"},
        Mistake{"defaults\n d(X): open(b1).\n", "f:13:2: the variable X is unsafe"},
        Mistake{"axioms\n impossible A if open(A).\n",
                "the variable A stands for an action and for an element of the sort box"},
        Mistake{"axioms\n push(B) causes open(B).\n",
                "f:13:2: found 1 arguments of the action push, expected 2"},
        Mistake{"axioms\n open(B, P) if near(P, P).\n",
                "f:13:2: found 2 arguments of the fluent open, expected 1"},
        Mistake{"defaults\n d(B): open(B).\n e: open(b1).\n prefer d over e.\n",
                "f:15:9: found 0 arguments of the default d, expected 1"},
        Mistake{"axioms\n push(B, P) causes loc(B).\n",
                "f:13:20: found loc without a value, expected 'loc(...) = ' and an element of the "
                "sort place"},
        Mistake{"axioms\n push(B, P) causes open(B) = P.\n",
                "f:13:20: found 'P' as the value of open, expected true or false: it is boolean"},
        Mistake{"sorts\n p = q.\n q = p.\n",
                "f:14:2: the sort q contains itself through p, expected no cycle of sorts"},
        Mistake{"sorts\n level = 3..1.\n",
                "f:13:10: found the range 3..1, expected a first number that is not above the "
                "last"}));

INSTANTIATE_TEST_SUITE_P(
    Statements, LanguageErrors,
    testing::Values(
        Mistake{"axioms\n push(B, P) causes seen(B).\n",
                "f:13:20: found the defined fluent seen as an effect, expected an inertial"},
        Mistake{"axioms\n push(B, P) causes near(P, P).\n",
                "f:13:20: found the static near as an effect"},
        Mistake{"axioms\n push(B, P) causes open(B) or nothing.\n",
                "f:13:2: found several outcomes without a label, expected a label for each"},
        Mistake{"axioms\n push(B, P) causes open(B) [x] or nothing [x].\n",
                "f:13:2: the label 'x' is given to two outcomes"},
        Mistake{"axioms\n -seen(B) if open(B).\n",
                "f:13:2: found a definition of -seen(B), "
                "expected a positive head"},
        Mistake{"axioms\n near(P, P) if loc(B) = P.\n",
                "f:13:2: found the static near as the head of a constraint"},
        Mistake{"fluents\n defined where(box) : place.\n",
                "f:13:2: the fluent where has values of sort place, expected a boolean one"},
        Mistake{"facts\n near(office, P).\n",
                "f:13:2: found the variable P, expected a fact without variables"},
        Mistake{"facts\n open(b1).\n",
                "f:13:2: found the fluent open in a fact, expected a static"},
        Mistake{"defaults\n d(B): seen(B).\n",
                "f:13:2: the default d is about the defined fluent seen, expected an inertial"},
        Mistake{"defaults\n d(P): near(P, P).\n",
                "f:13:2: the default d is about the static near, expected an inertial fluent"},
        Mistake{"defaults\n d(B): open(B).\n e(B): -open(B).\n prefer d(X) over e(X).\n"
                " prefer e(X) over d(X).\n",
                "f:15:2: the preference of d over e closes a cycle, expected an order"},
        Mistake{"total open.\n",
                "f:12:1: found total open, expected an inertial predicate fluent "
                "with the law -open(X, V1) if open(X, V2), V1 != V2"},
        Mistake{"observations\n push(B, P) observes opn(B).\n",
                "f:13:22: unknown fluent, static or sort 'opn'; did you mean 'open'?"},
        Mistake{"cost psh(B, P) = 3.\n", "f:12:6: unknown action 'psh'; did you mean 'push'?"}));

TEST(LanguageErrors, NameTheSectionsWhenNoneHasBegun)
{
  const std::string problems =
      errorOf([] { static_cast<void>(parseDescription("sort\n a = {x}.\n", "f")); });
  EXPECT_EQ(
      problems.find("f:2:2: found 'a', expected '(' or 'observes'; no section has begun (sorts"),
      0U)
      << problems;
}

TEST(LanguageErrors, AreAllReportedInTheOrderOfTheirPlaces)
{
  const std::string problems = errorOf([] {
    static_cast<void>(parseDescription(
        "sorts\n a = {x}.\n b = {y\nfluents\n inertial f(aa).\naxioms\n f(X) if X = .\n"
        " f(Y) if Y != x.\n g(x).\n",
        "f"));
  });
  EXPECT_EQ(problems,
            "f:3:8: found the end, expected ',' or '}'\n"
            "f:5:2: unknown sort 'aa'; did you mean 'a'?\n"
            "f:7:14: found '.', expected a name, a number or a variable\n"
            "f:9:2: unknown fluent, static or sort 'g'");
}

TEST(LanguageErrors, OfHistoriesHaveTheirPlaceToo)
{
  const Description description = parseDescription(kStart, "f");
  const std::string problems = errorOf([&] {
    static_cast<void>(
        parseHistory("% a comment\n"
                     "obs(loc(b1) = offce, true, 0).\n"
                     "obs(loc(b1) = office, perhaps, 0).\n"
                     "obs(loc(b1) = office, true).\n"
                     "hpd(push(b1), 0).\n"
                     "hpd(-push(b1, office), 0).\n"
                     "obs(open(B), true, 0).\n"
                     "obs(open(b1), true, soon).\n"
                     "obs(open(b1), true, 1) [1.5].\n"
                     "saw(open(b1)).\n"
                     "init(open(b1), true)\n",
                     "h", description));
  });
  EXPECT_EQ(problems,
            "h:2:5: found 'offce', expected an element of the sort place; did you mean 'office'?\n"
            "h:3:23: found perhaps, expected true or false\n"
            "h:4:1: found 2 arguments of obs, expected 3: obs(literal, true or false, step), "
            "hpd(action, step), attempt(action, step) or init(literal, true or false)\n"
            "h:5:5: found 1 arguments of the action push, expected 2\n"
            "h:6:5: found a condition, expected a ground action\n"
            "h:7:5: found the variable B, expected a literal without variables\n"
            "h:8:21: found 'soon', expected a step from 0 to 9999999\n"
            "h:9:25: found the confidence 1.5, expected one in (0, 1]\n"
            "h:10:1: found 'saw', expected 'obs', 'hpd', 'attempt' or 'init'\n"
            "h:12:1: found the end, expected '.' or '['");
}

TEST(LanguageErrors, OfGoalsNameEveryWrongLiteral)
{
  const Description description = parseDescription(kStart, "f");
  EXPECT_EQ(errorOf([&] {
              static_cast<void>(
                  parseGoal("opn(b1) and (loc(b1) = office or loc(b2) = kitchen)", description));
            }),
            "goal:1:1: unknown fluent, static or sort 'opn'; did you mean 'open'?\n"
            "goal:1:34: found 'b2', expected an element of the sort box; did you mean 'b1'?");
}

}  // namespace
}  // namespace kr3::reasoner
