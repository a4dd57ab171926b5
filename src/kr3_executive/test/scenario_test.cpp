// Scenario files are read strictly: what nobody reads would be lost without a word.

#include "kr3_executive/scenario.hpp"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <kr3_common/error.hpp>
#include <kr3_reasoner/language.hpp>

namespace kr3::executive
{
namespace
{

using testing::HasSubstr;

constexpr char kLanguage[] = R"(
sorts
  place = {here, there}.
  thing = {box}.
fluents
  inertial at(thing) : place.
)";

std::string problemOf(const std::string& text)
{
  try
  {
    static_cast<void>(
        parseScenario(text, "s.yaml", reasoner::parseDescription(kLanguage, "d.kr3")));
  }
  catch (const InvalidArgument& error)
  {
    return error.what();
  }
  return "none";
}

std::string withStep(const std::string& step)
{
  return "initial_records: [{kind: obs, statement: \"at(box) = here\", step: " + step + "}]";
}

TEST(Scenario, NamesKeysThatNobodyReads)
{
  const std::string problem = problemOf("goal: g\ninitial_record: []");
  EXPECT_THAT(problem, HasSubstr("s.yaml:2"));
  EXPECT_THAT(problem, HasSubstr("initial_record"));
  EXPECT_EQ(problemOf("goal: g\ninitial_records: []\nplacements: {}\ntarget: {object: box}"),
            "none");
}

TEST(Scenario, StepsAreWholeNumbers)
{
  for (const char* step : {"1.7", "-3", "1.0e20"})
    EXPECT_THAT(problemOf(withStep(step)), HasSubstr("expected a whole number from 0")) << step;
  EXPECT_THAT(problemOf(withStep(".nan")), HasSubstr("'step' is no number"));
  EXPECT_EQ(problemOf(withStep("3")), "none");
}

}  // namespace
}  // namespace kr3::executive
