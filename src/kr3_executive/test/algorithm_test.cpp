// Algorithm 1 of Zhang, Sridharan, Gelfond and Wyatt (2014) line by line: a state and an event in,
// a decision and a state out. docs/control_loop.md has the lines and what differs from the paper.

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "algorithm_rows.hpp"
#include "kr3_executive/mission_log.hpp"

namespace kr3::executive
{
namespace
{

class AlgorithmOne : public testing::TestWithParam<Row>
{
};

TEST_P(AlgorithmOne, Line)
{
  const Row& row = GetParam();
  const Transition transition = step(row.state, row.event);
  const ReportedDecision decision = reported(transition.decision, transition.state);
  std::vector<std::string> text{decision.kind};
  text.insert(text.end(), decision.details.begin(), decision.details.end());
  EXPECT_EQ(text, row.decision) << row.line;
  EXPECT_EQ(transition.state.phase, row.phase) << row.line;
  EXPECT_TRUE(row.also(transition.state)) << row.line;
}

INSTANTIATE_TEST_SUITE_P(Lines1To8, AlgorithmOne, testing::ValuesIn(lineOneToEight()));
INSTANTIATE_TEST_SUITE_P(Lines9To15, AlgorithmOne, testing::ValuesIn(lineNineToFifteen()));
INSTANTIATE_TEST_SUITE_P(Line16, AlgorithmOne, testing::ValuesIn(lineSixteen()));
INSTANTIATE_TEST_SUITE_P(Lines17To22, AlgorithmOne, testing::ValuesIn(lineSeventeenToTwentyTwo()));

// Every line of the algorithm that decides anything has a row.
TEST(AlgorithmOneTable, HasARowForEachLine)
{
  std::vector<bool> seen(23, false);
  for (const auto& rows :
       {lineOneToEight(), lineNineToFifteen(), lineSixteen(), lineSeventeenToTwentyTwo()})
  {
    for (const auto& row : rows)
    {
      std::size_t from = std::stoul(row.line);
      const auto dash = row.line.find('-');
      const bool range = dash != std::string::npos && dash < row.line.find(':');
      const std::size_t to = range ? std::stoul(row.line.substr(dash + 1)) : from;
      for (; from <= to; ++from)
        seen.at(from) = true;
    }
  }
  for (std::size_t line = 1; line <= 22; ++line)
    EXPECT_TRUE(seen[line]) << "line " << line;
}

}  // namespace
}  // namespace kr3::executive
