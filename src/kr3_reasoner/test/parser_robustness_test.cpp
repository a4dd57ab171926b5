// Files that nobody should write: large, deep, broken.

#include <chrono>
#include <ctime>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "fuzz/parse_anything.hpp"
#include "kr3_reasoner/language.hpp"
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

void expectProblem(const std::string& text, const std::string& message)
{
  const std::string problems = problemsOf(text);
  EXPECT_NE(problems.find(message), std::string::npos) << problems.substr(0, 500);
}

/// Rooms, objects, and a fact about each pair of an object and some rooms.
std::string generated(int num_rooms, int num_objects, int facts_per_object)
{
  std::string text = "sorts\n room = {";
  for (int i = 0; i < num_rooms; ++i)
  {
    text += (i == 0 ? "r" : ", r") + std::to_string(i);
  }
  text += "}.\n object = {";
  for (int i = 0; i < num_objects; ++i)
  {
    text += (i == 0 ? "o" : ", o") + std::to_string(i);
  }
  text +=
      "}.\n thing = object + room.\nstatics\n seen_in(object, room).\n"
      "fluents\n inertial loc(object) : room.\nfacts\n";
  for (int i = 0; i < num_objects; ++i)
  {
    for (int j = 0; j < facts_per_object; ++j)
    {
      text +=
          " seen_in(o" + std::to_string(i) + ", r" + std::to_string((i + j) % num_rooms) + ").\n";
    }
  }
  return text;
}

double cpuSecondsOf(const std::string& text)
{
  const std::clock_t start = std::clock();
  static_cast<void>(parseDescription(text, "f"));
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

TEST(ParserRobustness, ReadsLargeFilesInNearlyLinearTime)
{
  const std::string small = generated(200, 1000, 10);
  const std::string large = generated(1600, 8000, 10);
  static_cast<void>(cpuSecondsOf(small));
  const double small_s = cpuSecondsOf(small);
  const double large_s = cpuSecondsOf(large);
  const double growth = static_cast<double>(large.size()) / static_cast<double>(small.size());
  EXPECT_LT(large_s, 3.0 * growth * small_s + 0.05)
      << small.size() << " bytes: " << small_s << " s, " << large.size() << " bytes: " << large_s
      << " s";
}

TEST(ParserRobustness, RefusesDeepNestingWithoutRecursion)
{
  const Description& description = fixedDescription();
  const auto goalProblem = [&](const std::string& goal) {
    return errorOf([&] { static_cast<void>(parseGoal(goal, description)); });
  };
  const std::string literal = "loc(tb1) = office";
  const std::string deep(100000, '(');
  EXPECT_NE(goalProblem(deep + literal + std::string(100000, ')'))
                .find("goal:1:201: found a formula nested deeper than 200"),
            std::string::npos);
  std::string negations;
  for (int i = 0; i < 100000; ++i)
  {
    negations += "not ";
  }
  EXPECT_NE(goalProblem(negations + literal).find("nested deeper than 200"), std::string::npos);
  EXPECT_EQ(goalProblem(std::string(150, '(') + literal + std::string(150, ')')), "nothing");
}

TEST(ParserRobustness, ReadsLongChainsOfSorts)
{
  std::string chain = "sorts\n s0 = {x}.\n";
  for (int i = 1; i < 20000; ++i)
  {
    chain += " s" + std::to_string(i) + " = s" + std::to_string(i - 1) + ".\n";
  }
  const Description description = parseDescription(chain, "f");
  EXPECT_EQ(description.sorts.back().elements, std::vector<std::string>{"x"});
  // and the other way round, where each sort waits for the next
  std::string backwards = "sorts\n";
  for (int i = 0; i < 20000; ++i)
  {
    backwards += " s" + std::to_string(i) + " = s" + std::to_string(i + 1) + ".\n";
  }
  EXPECT_EQ(parseDescription(backwards + " s20000 = {x}.\n", "f").sorts.front().elements.size(),
            1U);
}

TEST(ParserRobustness, BoundsTheElementsOfAllSorts)
{
  std::string ranges = "sorts\n";
  for (int i = 0; i < 100; ++i)
  {
    ranges += " s" + std::to_string(i) + " = 0..99999.\n";
  }
  expectProblem(ranges, "f:23:8: found more than 2000000 elements");
  std::string unions = "sorts\n s0 = 0..99999.\n";
  for (int i = 1; i < 100; ++i)
  {
    unions += " s" + std::to_string(i) + " = s" + std::to_string(i - 1) + ".\n";
  }
  expectProblem(unions, "f:22:2: found more than 2000000 elements in all sorts together");
}

TEST(ParserRobustness, NamesBytesThatAreNoText)
{
  expectProblem(std::string("sorts\n a = {x\0y}.\n", 16), "f:2:8: found a NUL byte, expected text");
  expectProblem("sorts\n % caf\xe9\n a = {x}.\n", "f:2:7: found the byte 0xe9, expected UTF-8");
  expectProblem("sorts\n a = {\x1b[31mx}.\n", "f:2:7: found the control character 0x1b");
  expectProblem("sorts\n a = {\xc3\xa9}.\n",
                "f:2:7: found '\xc3\xa9', expected '}', a name or a number");
  EXPECT_EQ(problemsOf("% caf\xc3\xa9 \xf0\x9f\xa4\x96\nsorts\n a = {x}.\n"), "nothing");
  expectProblem("\xef\xbb\xbfsorts\n a = {x}.\n", "f:1:1: found");
  EXPECT_NE(errorOf([] {
              static_cast<void>(parseHistory(std::string("init(loc(tb1) = office, true).\0", 31),
                                             "h", fixedDescription()));
            }).find("h:1:31: found a NUL byte"),
            std::string::npos);
}

TEST(ParserRobustness, TakesAnyEndOfLine)
{
  const std::string text =
      "sorts\n a = {x}. % first\nfluents\n inertial f(a).\naxioms\n f(X) if a(X).";
  std::string windows;
  for (const char c : text)
  {
    windows += c == '\n' ? "\r\n" : std::string(1, c);
  }
  EXPECT_EQ(toString(parseDescription(windows, "f")), toString(parseDescription(text, "f")));
  expectProblem("sorts\r\n a = {x}.\r\n b = {y.\r\n", "f:3:8: found '.', expected ',' or '}'");
}

TEST(ParserRobustness, RefusesHugeNumbersAndNames)
{
  expectProblem("sorts\n a = {2147483648}.\n",
                "f:2:7: found a number of 10 digits, expected one from -2147483647 to 2147483647");
  expectProblem("sorts\n a = 0.." + std::string(5000, '9') + ".\n",
                "found a number of 5000 digits");
  expectProblem("sorts\n a = {" + std::string(300, 'x') + "}.\n",
                "f:2:7: found a name of 300 characters, expected at most 255");
  expectProblem("sorts\n a = {x}.\nactions\n go(a).\ncost go(X) = " + std::string(400, '9') + ".\n",
                "f:5:14: found a number of 400 characters");
  EXPECT_EQ(parseDescription("sorts\n a = {007, -0}.\n", "f").sorts[0].elements,
            (std::vector<std::string>{"7", "0"}));
  EXPECT_NE(errorOf([] {
              static_cast<void>(parseHistory("obs(loc(tb1) = office, true, 99999999999999999999).",
                                             "h", fixedDescription()));
            }).find("h:1:30: found '99999999999999999999', expected a step"),
            std::string::npos);
}

TEST(ParserRobustness, KeepsTheListOfProblemsReadable)
{
  std::string text = "sorts\n a = {x}.\nfluents\n inertial f(a).\nfacts\n";
  for (int i = 0; i < 20000; ++i)
  {
    text += " g" + std::to_string(i) + "(x).\n";
  }
  expectProblem(text, "\n... and 19000 more problems");
}

// What the fuzzer found, and what it began with. The large run is `./kr3 fuzz parser`.
TEST(ParserRobustness, SurvivesTheCorpus)
{
  std::size_t num_inputs = 0;
  for (const auto& file :
       std::filesystem::directory_iterator(std::string(KR3_TEST_DIR) + "/corpus/parser"))
  {
    SCOPED_TRACE(file.path().filename());
    parseAnything(readText(file.path()));
    ++num_inputs;
  }
  EXPECT_GT(num_inputs, 20U);
}

}  // namespace
}  // namespace kr3::reasoner
