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
  EXPECT_EQ(errorOf("hello 1\n"), "p:1:1: found 'hello', expected 'kr3_policy'");
  EXPECT_EQ(errorOf("kr3_policy 2\n"), "p:1:12: found '2', expected version 1");
  EXPECT_EQ(errorOf("kr3_policy 1\nstates many\n"),
            "p:2:8: found 'many', expected a number below 4294967295");
  const std::string head = "kr3_policy 1\nstates 2\nvectors 1\n";
  EXPECT_EQ(errorOf(head + "0 0 1 x\n"), "p:4:7: found 'x', expected a value, 2 in all");
  EXPECT_EQ(errorOf(head + "0 0 1 inf\n"), "p:4:7: found 'inf', expected a value, 2 in all");
  EXPECT_EQ(errorOf(head + "0 0 1\n"),
            "p:4:6: found the end of the line, expected a value, 2 in all");
  EXPECT_EQ(errorOf(head), "p:4:1: found the end of the text, expected an action's index");
  EXPECT_EQ(errorOf(head + "0 0 1 2 3\n"), "p:4:9: found '3', expected the end of the line");
  EXPECT_EQ(errorOf(head + "0 0 1 2\n0 0 1 2\n"), "p:5:1: found '0', expected the end of the text");
  EXPECT_EQ(errorOf(head + "0 3\n"),
            "p:4:3: found '3', expected a number of states up to 2, 0 for "
            "all");
  EXPECT_EQ(errorOf(head + "0 2 1 0 5 5\n"),
            "p:4:7: found '0', expected states in ascending order");
  EXPECT_EQ(errorOf(head + "0 1 1 5\n"),
            "p: found no vector over all states, expected one at least");
  // A number of states that no memory holds is only a number until values follow.
  EXPECT_EQ(errorOf("kr3_policy 1\nstates 4000000000\nvectors 4000000000\n0 0 1\n"),
            "p:4:6: found the end of the line, expected a value, 4000000000 in all");
}

}  // namespace
}  // namespace kr3::pomdp
