#include "kr3_pomdp/model_builder.hpp"

#include <limits>
#include <string>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

namespace kr3::pomdp
{
namespace
{

/// Two states that stay as they are, one action that says nothing.
ModelBuilder idle()
{
  ModelBuilder builder({"a", "b"}, {"wait", "look"}, {"nothing", "something"});
  builder.setTransition(kAny, 0, 0, 1.0);
  builder.setTransition(kAny, 1, 1, 1.0);
  builder.setObservation(kAny, kAny, 0, 1.0);
  return builder;
}

std::string messageOf(const ModelBuilder& builder)
{
  try
  {
    (void)builder.build();
  }
  catch (const InvalidArgument& e)
  {
    return e.what();
  }
  return "no error";
}

TEST(ModelBuilder, StartsUniformAndWithoutRewards)
{
  const Model model = idle().build();
  EXPECT_EQ(model.initialBelief()[0], 0.5);
  EXPECT_EQ(model.reward(1, 1), 0.0);
  EXPECT_EQ(model.discount(), 1.0);
  EXPECT_EQ(model.findAction("look"), 1U);
  EXPECT_FALSE(model.findState("c"));
}

TEST(ModelBuilder, NamesTheRowThatDoesNotSumToOne)
{
  ModelBuilder builder = idle();
  builder.setTransition(1, 0, 1, 0.25);
  EXPECT_EQ(messageOf(builder), "T(. | state 'a', action 'look') sums to 1.250000, expected 1");
  builder = idle();
  builder.setObservation(0, 1, 0, 0.5);
  EXPECT_EQ(messageOf(builder),
            "O(. | action 'wait', next state 'b') sums to 0.500000, expected 1");
}

TEST(ModelBuilder, NamesAnEntryThatIsNoProbability)
{
  ModelBuilder builder = idle();
  builder.setTransition(0, 0, 0, 1.5);
  builder.setTransition(0, 0, 1, -0.5);
  EXPECT_EQ(messageOf(builder),
            "T(. | state 'a', action 'wait') has the entry 1.500000, expected a probability");
}

TEST(ModelBuilder, ToleratesRoundingAndRemovesIt)
{
  ModelBuilder builder = idle();
  builder.setTransition(0, 0, 0, 0.3333333);
  builder.setTransition(0, 0, 1, 0.6666666);
  const Model model = builder.build();
  double sum = 0.0;
  for (const SparseEntry& entry : model.transitions(0, 0))
  {
    sum += entry.probability;
  }
  EXPECT_NEAR(sum, 1.0, 1e-15);
}

TEST(ModelBuilder, TheLatestMatchingRewardCounts)
{
  ModelBuilder builder = idle();
  builder.setReward(kAny, kAny, 1.0);
  builder.setReward(0, 1, 5.0);
  builder.setReward(1, kAny, 7.0);
  const Model model = builder.build();
  EXPECT_EQ(model.reward(0, 0), 1.0);
  EXPECT_EQ(model.reward(0, 1), 5.0);
  EXPECT_EQ(model.reward(1, 0), 7.0);
}

TEST(ModelBuilder, RewardsAreExpectedOverOutcomes)
{
  ModelBuilder builder = idle();
  builder.setTransition(0, 0, 0, 0.75);
  builder.setTransition(0, 0, 1, 0.25);
  builder.setObservation(0, 1, 0, 0.5);
  builder.setObservation(0, 1, 1, 0.5);
  builder.setReward(0, 0, kAny, kAny, 1.0);
  builder.setReward(0, 0, 1, 1, 9.0);  // probability 0.25 * 0.5
  EXPECT_NEAR(builder.build().reward(0, 0), 0.875 * 1.0 + 0.125 * 9.0, 1e-15);
}

TEST(ModelBuilder, AddsOutcomesThatCoincide)
{
  ModelBuilder builder({"a", "b"}, {"go"}, {"none"});
  for (int i = 0; i < 2; ++i)
  {
    builder.addTransition(0, 0, 1, 0.5);
    builder.addTransition(0, 1, 1, 0.5);
  }
  builder.addObservation(0, kAny, 0, 1.0);
  const Model model = builder.build();
  EXPECT_EQ(model.transitions(0, 0).size(), 1U);
  EXPECT_EQ(model.transitions(0, 0).begin()->probability, 1.0);
}

TEST(ModelBuilder, RejectsWhatIsOutOfRange)
{
  ModelBuilder builder = idle();
  EXPECT_THROW(builder.setTransition(2, 0, 0, 1.0), InvalidArgument);
  EXPECT_THROW(builder.setObservation(0, 0, 2, 1.0), InvalidArgument);
  EXPECT_THROW(builder.setReward(0, 2, 1.0), InvalidArgument);
  EXPECT_THROW(builder.setReward(0, 0, std::numeric_limits<double>::quiet_NaN()), InvalidArgument);
  EXPECT_THROW(builder.setDiscount(0.0), InvalidArgument);
  EXPECT_THROW(builder.setDiscount(1.01), InvalidArgument);
  EXPECT_THROW(builder.setInitialBelief({1.0}), InvalidArgument);
  EXPECT_THROW((void)builder.state("c"), NotFound);
  EXPECT_THROW(ModelBuilder({"a", "a"}, {"b"}, {"c"}), InvalidArgument);
  EXPECT_THROW(ModelBuilder({}, {"b"}, {"c"}), InvalidArgument);
}

}  // namespace
}  // namespace kr3::pomdp
