#include "kr3_executive/model_fingerprint.hpp"

#include <cstdint>
#include <set>
#include <string>
#include <unordered_set>
#include <vector>

#include <gtest/gtest.h>

#include <kr3_pomdp/model_builder.hpp>

namespace kr3::executive
{
namespace
{

/// Two states, two actions, two observations, with one number of each kind to vary.
struct Numbers
{
  double stay = 0.9;
  double hear = 0.85;
  double reward = -1.0;
  double discount = 0.95;
  double start = 0.5;
};

pomdp::Model modelOf(const Numbers& numbers, const std::string& suffix = "")
{
  const auto named = [&](std::vector<std::string> names) {
    for (std::string& name : names)
    {
      name += suffix;
    }
    return names;
  };
  pomdp::ModelBuilder builder(named({"left", "right"}), named({"wait", "open"}),
                              named({"quiet", "roar"}));
  builder.setDiscount(numbers.discount);
  builder.setInitialBelief({numbers.start, 1.0 - numbers.start});
  for (std::size_t action = 0; action < 2; ++action)
  {
    for (std::size_t state = 0; state < 2; ++state)
    {
      builder.setTransition(action, state, state, action == 0 ? numbers.stay : 0.5);
      builder.setTransition(action, state, 1 - state, action == 0 ? 1.0 - numbers.stay : 0.5);
      builder.setObservation(action, state, state, numbers.hear);
      builder.setObservation(action, state, 1 - state, 1.0 - numbers.hear);
      builder.setReward(action, state, state == 0 ? numbers.reward : 2.0);
    }
  }
  return builder.build();
}

TEST(ModelFingerprint, NamesDoNotCount)
{
  EXPECT_EQ(fingerprintOf(modelOf({})), fingerprintOf(modelOf({}, "_in_the_kitchen")));
  EXPECT_EQ(startFingerprintOf(modelOf({})), startFingerprintOf(modelOf({}, "_here")));
}

TEST(ModelFingerprint, EveryNumberCounts)
{
  const std::vector<Numbers> all{{},
                                 {0.9 + 1e-8, 0.85, -1.0, 0.95, 0.5},
                                 {0.9, 0.85 + 1e-8, -1.0, 0.95, 0.5},
                                 {0.9, 0.85, -1.0 + 1e-8, 0.95, 0.5},
                                 {0.9, 0.85, -1.0, 0.95 + 1e-8, 0.5},
                                 {0.9, 0.85, -2e12, 0.95, 0.5},
                                 {0.9, 0.85, -2.1e12, 0.95, 0.5}};
  std::set<std::string> seen;
  for (const Numbers& numbers : all)
  {
    EXPECT_TRUE(seen.insert(toString(fingerprintOf(modelOf(numbers)))).second);
  }
}

TEST(ModelFingerprint, TheStartCountsOnItsOwn)
{
  const pomdp::Model here = modelOf({});
  const pomdp::Model there = modelOf({0.9, 0.85, -1.0, 0.95, 0.25});
  EXPECT_EQ(fingerprintOf(here), fingerprintOf(there));
  EXPECT_NE(startFingerprintOf(here), startFingerprintOf(there));
}

TEST(ModelFingerprint, TheLastBitsOfASumDoNotCount)
{
  const pomdp::Model model = modelOf({0.1 + 0.2, 0.85, -1.0, 0.95, 0.5});  // not exactly 0.3
  ASSERT_NE(0.1 + 0.2, 0.3);
  EXPECT_EQ(fingerprintOf(model), fingerprintOf(modelOf({0.3, 0.85, -1.0, 0.95, 0.5})));
}

TEST(ModelFingerprint, NeighbouringContentsDoNotMeet)
{
  // Short sequences of small numbers, the hardest for a weak hash.
  std::unordered_set<Fingerprint> seen;
  std::set<std::uint64_t> highs;
  std::set<std::uint64_t> lows;
  for (std::uint64_t a = 0; a < 60; ++a)
  {
    for (std::uint64_t b = 0; b < 60; ++b)
    {
      for (std::uint64_t c = 0; c < 30; ++c)
      {
        Fingerprinter fingerprinter;
        fingerprinter.add(a);
        fingerprinter.add(b);
        fingerprinter.add(c);
        const Fingerprint fingerprint = fingerprinter.result();
        EXPECT_TRUE(seen.insert(fingerprint).second);
        highs.insert(fingerprint.high);
        lows.insert(fingerprint.low);
      }
    }
  }
  // Each half alone keeps them apart: 108000^2 / 2^65 is about 3e-10.
  EXPECT_EQ(highs.size(), seen.size());
  EXPECT_EQ(lows.size(), seen.size());
}

TEST(ModelFingerprint, ReadsWhatItWrites)
{
  const Fingerprint fingerprint = fingerprintOf(modelOf({}));
  const std::string text = toString(fingerprint);
  ASSERT_TRUE(parseFingerprint(text).has_value());
  EXPECT_EQ(*parseFingerprint(text), fingerprint);
  EXPECT_FALSE(parseFingerprint(text + "0").has_value());
  EXPECT_FALSE(parseFingerprint("").has_value());
  EXPECT_FALSE(parseFingerprint(text.substr(1) + "g").has_value());
}

TEST(ModelFingerprint, OrderAndLengthCount)
{
  Fingerprinter forward;
  forward.add(std::uint64_t{1});
  forward.add(std::uint64_t{2});
  Fingerprinter backward;
  backward.add(std::uint64_t{2});
  backward.add(std::uint64_t{1});
  EXPECT_NE(forward.result(), backward.result());
  Fingerprinter none;
  Fingerprinter zero;
  zero.add(std::uint64_t{0});
  EXPECT_NE(none.result(), zero.result());
}

}  // namespace
}  // namespace kr3::executive
