#include "kr3_pomdp/policy.hpp"

#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

namespace kr3::pomdp
{
namespace
{

Policy example()
{
  return Policy(3,
                {{2, {0, 1}, {1.0 / 3.0, 5.0}}, {1, {}, {1.0, -0.1, 1e-17}}, {0, {}, {0, 2, 0}}});
}

TEST(Policy, TakesTheGreatestVectorThatCoversTheBelief)
{
  const Policy policy = example();
  EXPECT_EQ(policy.actionAt(Belief({0.0, 1.0, 0.0})), 2U);
  EXPECT_EQ(policy.valueAt(Belief({0.0, 1.0, 0.0})), 5.0);
  EXPECT_EQ(policy.actionAt(Belief({1.0, 0.0, 0.0})), 1U);
  // The vector over states 0 and 1 would be the greatest but says nothing of state 2.
  EXPECT_EQ(policy.actionAt(Belief({0.0, 0.9, 0.1})), 0U);
}

TEST(Policy, RejectsWhatIsIncomplete)
{
  EXPECT_THROW(Policy(2, {}), InvalidArgument);
  EXPECT_THROW(Policy(2, {{0, {0}, {1.0}}}), InvalidArgument);
  EXPECT_THROW(Policy(2, {{0, {}, {1.0}}}), InvalidArgument);
  EXPECT_THROW(Policy(2, {{0, {}, {1.0, 1.0}}, {0, {1, 0}, {1.0, 2.0}}}), InvalidArgument);
  EXPECT_THROW(Policy(2, {{0, {}, {1.0, 0.0 / 0.0}}}), InvalidArgument);
  EXPECT_THROW((void)example().actionAt(Belief({1.0})), InvalidArgument);
}

TEST(Policy, TextRoundTripIsExact)
{
  std::stringstream text;
  example().write(text);
  const Policy copy = Policy::read(text, "text");
  const auto original = example().alphaVectors();
  const auto vectors = copy.alphaVectors();
  ASSERT_EQ(vectors.size(), original.size());
  for (std::size_t i = 0; i < vectors.size(); ++i)
  {
    EXPECT_EQ(vectors[i].action, original[i].action);
    EXPECT_EQ(vectors[i].states, original[i].states);
    EXPECT_EQ(vectors[i].values, original[i].values);
  }
}

TEST(Policy, ReadingNamesTheLine)
{
  const auto errorOf = [](const std::string& text) {
    std::istringstream in(text);
    try
    {
      (void)Policy::read(in, "p");
    }
    catch (const InvalidArgument& e)
    {
      return std::string(e.what());
    }
    return std::string("no error");
  };
  EXPECT_EQ(errorOf("hello 1\n"), "p:1: found 'hello 1', expected 'kr3_policy' and a number");
  EXPECT_EQ(errorOf("kr3_policy 2\n"), "p:1: unknown version, expected 1");
  EXPECT_EQ(errorOf("kr3_policy 1\nstates 2\nvectors 1\n0 0 1 x\n"),
            "p:4: found 'x', expected 2 values");
  EXPECT_EQ(errorOf("kr3_policy 1\nstates 2\nvectors 1\n"),
            "p:4: found the end, expected an alpha vector");
  EXPECT_EQ(errorOf("kr3_policy 1\nstates 2\nvectors 1\n0 0 1 2 3\n"),
            "p:4: found '3' after the last value");
}

}  // namespace
}  // namespace kr3::pomdp
