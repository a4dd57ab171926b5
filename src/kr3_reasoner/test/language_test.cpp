#include "kr3_reasoner/language.hpp"

#include <filesystem>
#include <regex>

#include <gtest/gtest.h>

#include "kr3_reasoner/ground_literals.hpp"
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
  std::vector<std::string> paths = {std::string(KR3_TEST_DIR) + "/data/lamps.kr3"};
  for (const auto& folder : std::filesystem::directory_iterator(KR3_DOMAINS_DIR))
  {
    paths.push_back(folder.path() / "domain.kr3");
  }
  EXPECT_GE(paths.size(), 7U);
  for (const std::string& path : paths)
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

TEST(GroundLiterals, AreThoseThatAreParsedOneByOneEachTextOnce)
{
  const Description office = readDescription(kOffice + "domain.kr3");
  GroundLiterals literals(office);
  for (const char* text : {"loc(tb1)=office", "-in_hand(rob1,tb1)", "loc(tb1) = office"})
  {
    const Literal* const first = &literals.of(text);
    EXPECT_EQ(toString(*first), toString(parseGroundLiteral(text, office)));
    EXPECT_EQ(&literals.of(text), first);
  }
  for (int i = 0; i < 2; ++i)
  {
    EXPECT_NE(errorOf([&] {
                static_cast<void>(literals.of("loc(tb1) = ofice"));
              }).find("did you mean 'office'?"),
              std::string::npos);
  }
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
  EXPECT_EQ(problems,
            "h:1:25: found maybe, expected true or false\n"
            "h:2:5: unknown action 'mov'; did you mean 'move'?");
}

/// The blocks of a document that are fenced with the given word.
std::vector<std::string> blocksOf(const std::string& document, const std::string& word)
{
  std::vector<std::string> blocks;
  const std::string fence = "```" + word + "\n";
  for (std::size_t at = document.find(fence); at != std::string::npos;)
  {
    const std::size_t begin = at + fence.size();
    const std::size_t end = document.find("```", begin);
    blocks.push_back(document.substr(begin, end - begin));
    at = document.find(fence, end);
  }
  return blocks;
}

// docs/language.md: ```kr3 is a description, ```kr3-refinement refines the last description before
// it, ```kr3-history and ```kr3-goal are about the first one, ```kr3-error is a wrong description
// with the message after `%!`.
TEST(Language, ReferenceHasExamplesThatAreTrue)
{
  const std::string reference = readText(std::string(KR3_DOMAINS_DIR) + "/../docs/language.md");
  const std::vector<std::string> descriptions = blocksOf(reference, "kr3");
  ASSERT_GE(descriptions.size(), 5U);
  for (const std::string& description : descriptions)
  {
    EXPECT_NO_THROW(static_cast<void>(parseDescription(description, "example"))) << description;
  }
  const Description first = parseDescription(descriptions.front(), "example");
  const std::vector<std::string> refinements = blocksOf(reference, "kr3-refinement");
  ASSERT_GE(refinements.size(), 1U);
  for (const std::string& refinement : refinements)
  {
    EXPECT_NO_THROW(static_cast<void>(parseRefinement(refinement, "example", first))) << refinement;
  }
  const std::vector<std::string> histories = blocksOf(reference, "kr3-history");
  ASSERT_GE(histories.size(), 1U);
  for (const std::string& history : histories)
  {
    EXPECT_NO_THROW(static_cast<void>(parseHistory(history, "example", first))) << history;
  }
  const std::vector<std::string> goals = blocksOf(reference, "kr3-goal");
  ASSERT_GE(goals.size(), 1U);
  for (const std::string& goal : goals)
  {
    EXPECT_NO_THROW(static_cast<void>(parseGoal(goal, first))) << goal;
  }
  const std::vector<std::string> errors = blocksOf(reference, "kr3-error");
  ASSERT_GE(errors.size(), 1U);
  for (const std::string& error : errors)
  {
    const std::string problems =
        errorOf([&] { static_cast<void>(parseDescription(error, "file")); });
    static const std::regex kExpected("%! (.*)\n");
    for (std::sregex_iterator match(error.begin(), error.end(), kExpected), end; match != end;
         ++match)
    {
      EXPECT_NE(problems.find((*match)[1]), std::string::npos) << problems << "\nexpected\n"
                                                               << (*match)[1];
    }
  }
}

}  // namespace
}  // namespace kr3::reasoner
