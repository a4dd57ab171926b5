#include "kr3_pomdp/pomdp_format.hpp"

#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_pomdp/model_builder.hpp"
#include "support/models.hpp"

namespace kr3::pomdp
{
namespace
{

Model read(const std::string& text)
{
  std::istringstream in(text);
  return readPomdp(in, "m");
}

std::string errorOf(const std::string& text)
{
  try
  {
    (void)read(text);
  }
  catch (const InvalidArgument& e)
  {
    return e.what();
  }
  return "no error";
}

const std::string kHead =
    "discount: 0.9  # comment\nvalues: reward\nstates: a b\nactions: go stay\nobservations: x y\n";
const std::string kRest = "T: * identity\nO: * uniform\n";

double transition(const Model& model, std::size_t action, std::size_t state, std::size_t next)
{
  for (const SparseEntry& entry : model.transitions(action, state))
  {
    if (entry.index == next)
    {
      return entry.probability;
    }
  }
  return 0.0;
}

double observation(const Model& model, std::size_t action, std::size_t next, std::size_t seen)
{
  for (const SparseEntry& entry : model.observations(action, next))
  {
    if (entry.index == seen)
    {
      return entry.probability;
    }
  }
  return 0.0;
}

void expectEqual(const Model& a, const Model& b)
{
  ASSERT_EQ(a.numStates(), b.numStates());
  ASSERT_EQ(a.numActions(), b.numActions());
  ASSERT_EQ(a.numObservations(), b.numObservations());
  EXPECT_EQ(a.discount(), b.discount());
  EXPECT_EQ(a.initialBelief().probabilities(), b.initialBelief().probabilities());
  for (std::size_t i = 0; i < a.numActions(); ++i)
  {
    EXPECT_EQ(a.actionName(i), b.actionName(i));
    for (std::size_t s = 0; s < a.numStates(); ++s)
    {
      EXPECT_EQ(a.stateName(s), b.stateName(s));
      EXPECT_EQ(a.reward(i, s), b.reward(i, s));
      for (std::size_t n = 0; n < a.numStates(); ++n)
      {
        EXPECT_EQ(transition(a, i, s, n), transition(b, i, s, n));
      }
      for (std::size_t o = 0; o < a.numObservations(); ++o)
      {
        EXPECT_EQ(observation(a, i, s, o), observation(b, i, s, o));
      }
    }
  }
}

TEST(PomdpFormat, ReadsTheTigerOfThePaper)
{
  const Model model = read(
      "discount: 0.95\nvalues: reward\nstates: tiger-left tiger-right\n"
      "actions: listen open-left open-right\nobservations: hear-left hear-right\n"
      "T:listen\nidentity\nT:open-left\nuniform\nT:open-right\nuniform\n"
      "O:listen\n0.85 0.15\n0.15 0.85\nO:open-left\nuniform\nO:open-right\nuniform\n"
      "R:listen : * : * : * -1\nR:open-left : tiger-left : * : * -100\n"
      "R:open-left : tiger-right : * : * 10\nR:open-right : tiger-left : * : * 10\n"
      "R:open-right : tiger-right : * : * -100\n");
  const Model expected = test::tiger();
  for (std::size_t a = 0; a < 3; ++a)
  {
    for (std::size_t s = 0; s < 2; ++s)
    {
      EXPECT_EQ(model.reward(a, s), expected.reward(a, s));
      EXPECT_EQ(transition(model, a, s, 0), transition(expected, a, s, 0));
      EXPECT_EQ(observation(model, a, s, 0), observation(expected, a, s, 0));
    }
  }
  EXPECT_EQ(model.stateName(1), "tiger-right");
}

TEST(PomdpFormat, ReadsCountsInPlaceOfNames)
{
  const Model model = read(
      "discount: 0.9\nvalues: cost\nstates: 3\nactions: 2\nobservations: 2\nT: * uniform\n"
      "O: * : * : 1 1.0\nR: 1 : 2 : * : * 4\n");
  EXPECT_EQ(model.stateName(2), "2");
  EXPECT_EQ(model.reward(1, 2), -4.0);  // a cost
  EXPECT_EQ(model.numObservations(), 2U);
}

TEST(PomdpFormat, ReadsEveryFormOfT)
{
  const Model model = read(kHead +
                           "start: 0.25 0.75\nO: * uniform\n"
                           "T: go : a : b 1\nT: go : b\n0.5 0.5\n"
                           "T: stay\n1 0\n0.1 0.9\n");
  EXPECT_EQ(transition(model, 0, 0, 1), 1.0);
  EXPECT_EQ(transition(model, 0, 1, 0), 0.5);
  EXPECT_EQ(transition(model, 1, 1, 1), 0.9);
  const Model rows = read(kHead +
                          "start: 0.25 0.75\nO: * uniform\n"
                          "T: go : a uniform\nT: go : b reset\nT: stay reset\n");
  EXPECT_EQ(transition(rows, 0, 0, 1), 0.5);
  EXPECT_EQ(transition(rows, 0, 1, 1), 0.75);
  EXPECT_EQ(transition(rows, 1, 0, 0), 0.25);
  // Indices in place of names, wildcards, and later lines over earlier ones.
  const Model late = read(kHead + "O: * uniform\nT: * : * : 0 1.0\nT: 1 : 0 : * 0.5\n");
  EXPECT_EQ(transition(late, 0, 1, 0), 1.0);
  EXPECT_EQ(transition(late, 1, 0, 1), 0.5);
}

TEST(PomdpFormat, ReadsEveryFormOfO)
{
  const Model model =
      read(kHead + "T: * identity\nO: go : a : x 1\nO: go : b\n0.5 0.5\nO: stay\n1 0\n0.1 0.9\n");
  EXPECT_EQ(observation(model, 0, 0, 0), 1.0);
  EXPECT_EQ(observation(model, 0, 1, 1), 0.5);
  EXPECT_EQ(observation(model, 1, 1, 0), 0.1);
  const Model rows = read(kHead + "T: * identity\nO: go : * uniform\nO: stay identity\n");
  EXPECT_EQ(observation(rows, 0, 1, 0), 0.5);
  EXPECT_EQ(observation(rows, 1, 1, 1), 1.0);
}

TEST(PomdpFormat, ReadsEveryFormOfR)
{
  const Model model = read(kHead + "T: * uniform\nO: * uniform\n" +
                           "R: go : a : a : x 8\n"      // one outcome of four
                           "R: go : b : b\n4 12\n"      // two of four
                           "R: stay : a\n4 8\n12 16\n"  // all four
                           "R: stay : b : * : * -3\n");
  EXPECT_EQ(model.reward(0, 0), 2.0);
  EXPECT_EQ(model.reward(0, 1), 4.0);
  EXPECT_EQ(model.reward(1, 0), 10.0);
  EXPECT_EQ(model.reward(1, 1), -3.0);
}

TEST(PomdpFormat, ReadsEveryFormOfStart)
{
  const auto start = [](const std::string& text) {
    return read(kHead + text + "\n" + kRest).initialBelief().probabilities();
  };
  EXPECT_EQ(start(""), (std::vector<double>{0.5, 0.5}));
  EXPECT_EQ(start("start: uniform"), (std::vector<double>{0.5, 0.5}));
  EXPECT_EQ(start("start: b"), (std::vector<double>{0.0, 1.0}));
  EXPECT_EQ(start("start: 1"), (std::vector<double>{0.0, 1.0}));
  EXPECT_EQ(start("start: 0.25 0.75"), (std::vector<double>{0.25, 0.75}));
  EXPECT_EQ(start("start include: a"), (std::vector<double>{1.0, 0.0}));
  EXPECT_EQ(start("start exclude: a"), (std::vector<double>{0.0, 1.0}));
}

TEST(PomdpFormat, ReadsTheHeadInAnyOrder)
{
  const Model model = read(
      "# first a comment: with signs * and names\nobservations: x y # two\nactions:go stay\n"
      "states :\n a\n b # over lines\nvalues: cost\ndiscount:.5\n#\nT : * identity\nO:*uniform\n"
      "R : go:b:*:* 2.\n#end");
  EXPECT_EQ(model.discount(), 0.5);
  EXPECT_EQ(model.stateName(1), "b");
  EXPECT_EQ(model.reward(0, 1), -2.0);
  EXPECT_EQ(errorOf("discount: 0.9\ndiscount: 0.9\n"), "m:2:1: 'discount' is there already");
}

TEST(PomdpFormat, ReadsNamesAndNumbersMixed)
{
  const Model model = read(kHead +
                           "start: 1\nT: 0 : a : 1 1\nT: go : 1 : b 1\nT: 1 identity\n"
                           "O: * : 0 : y 1\nO: 0 : b : 0 1\nO: stay : 1 : x 1\n"
                           "R: go : 0 : b : 1 3\nR: 1 : b : * : * 1e1\n");
  EXPECT_EQ(model.initialBelief()[1], 1.0);
  EXPECT_EQ(transition(model, 0, 0, 1), 1.0);
  EXPECT_EQ(observation(model, 0, 1, 0), 1.0);
  EXPECT_EQ(model.reward(0, 0), 0.0);  // b shows x after going
  EXPECT_EQ(model.reward(1, 1), 10.0);
  // A name that is a number is a name first.
  const Model numbers = read(
      "discount: 0.9\nvalues: reward\nstates: 1 0\nactions: 1\nobservations: 1\nstart: 0\n"
      "T: * identity\nO: * uniform\n");
  EXPECT_EQ(numbers.initialBelief()[1], 1.0);
  EXPECT_EQ(numbers.stateName(1), "0");
}

TEST(PomdpFormat, WildcardsStandAnywhere)
{
  const std::string uniform = "T: * uniform\nO: * uniform\n";
  const Model t = read(kHead + "O: * uniform\nT: * : a : b 1\nT: * : b : * 0.5\n");
  EXPECT_EQ(transition(t, 1, 0, 1), 1.0);
  EXPECT_EQ(transition(t, 0, 1, 0), 0.5);
  const Model rows = read(kHead + "O: * : *\n0.25 0.75\nT: * : *\n0.125 0.875\n");
  EXPECT_EQ(transition(rows, 1, 0, 1), 0.875);
  EXPECT_EQ(observation(rows, 1, 0, 1), 0.75);
  const Model matrices = read(kHead + "T: *\n0 1\n1 0\nO: *\n1 0\n0.5 0.5\n");
  EXPECT_EQ(transition(matrices, 1, 1, 0), 1.0);
  EXPECT_EQ(observation(matrices, 0, 1, 1), 0.5);
  const Model reset = read(kHead + "start: 0.25 0.75\nT: * reset\nO: * : * uniform\n");
  EXPECT_EQ(transition(reset, 1, 0, 1), 0.75);
  const auto rewards = [&](const std::string& text) {
    const Model model = read(kHead + uniform + text);
    return std::vector<double>{model.reward(0, 0), model.reward(0, 1), model.reward(1, 0),
                               model.reward(1, 1)};
  };
  using Rewards = std::vector<double>;
  EXPECT_EQ(rewards("R: * : * : * : * 2\n"), (Rewards{2, 2, 2, 2}));
  EXPECT_EQ(rewards("R: * : a : * : x 2\n"), (Rewards{1, 0, 1, 0}));
  EXPECT_EQ(rewards("R: go : * : b : * 2\n"), (Rewards{1, 1, 0, 0}));
  EXPECT_EQ(rewards("R: * : b : *\n2 4\n"), (Rewards{0, 3, 0, 3}));
  EXPECT_EQ(rewards("R: * : *\n1 2\n3 4\n"), (Rewards{2.5, 2.5, 2.5, 2.5}));
}

TEST(PomdpFormat, LaterStatementsReplaceEarlierOnes)
{
  const Model model =
      read(kHead +
           "start: a\nstart: 0.5 0.5\nT: go : a : b 1\nT: * identity\nT: stay : a : a 0\n"
           "T: stay : a : b 1\nO: go : a : x 1\nO: * uniform\nO: go : b\n1 0\n"
           "R: go : a : b : x 5\nR: go : * : * : * 1\nR: go : a : a : * 3\nR: * : b : * : * 7\n");
  EXPECT_EQ(model.initialBelief()[1], 0.5);
  EXPECT_EQ(transition(model, 0, 0, 0), 1.0);
  EXPECT_EQ(transition(model, 1, 0, 1), 1.0);
  EXPECT_EQ(transition(model, 1, 0, 0), 0.0);
  EXPECT_EQ(observation(model, 0, 0, 0), 0.5);
  EXPECT_EQ(observation(model, 0, 1, 1), 0.0);
  EXPECT_EQ(model.reward(0, 0), 3.0);
  EXPECT_EQ(model.reward(0, 1), 7.0);
  EXPECT_EQ(model.reward(1, 1), 7.0);
}

TEST(PomdpFormat, ErrorsNameThePlace)
{
  EXPECT_EQ(errorOf("discount: 1.5\n"), "m:1:11: found '1.5', expected a discount in (0, 1]");
  EXPECT_EQ(errorOf("discount: 0.9\nvalues: reward\nstates: a a\n"),
            "m:3:11: the state 'a' is there already");
  EXPECT_EQ(errorOf("discount: 0.9\nvalues: gain\n"),
            "m:2:9: found 'gain', expected 'reward' or 'cost'");
  EXPECT_EQ(errorOf("discount: 0.9\nT: a identity\n"),
            "m:2:1: found 'T', expected 'values:' before anything else");
  EXPECT_EQ(errorOf(kHead + "T: fly identity\n"),
            "m:6:4: found 'fly', expected a declared action, its index below 2, or '*'");
  EXPECT_EQ(errorOf(kHead + "T: go : a : b 1.2\n"),
            "m:6:15: found '1.2', expected a probability in [0, 1]");
  EXPECT_EQ(errorOf(kHead + "T: go : a : b\n"),
            "m:7:1: found the end of the text, expected a probability");
  EXPECT_EQ(errorOf(kHead + "Q: go\n"), "m:6:1: found 'Q', expected 'start', 'T', 'O' or 'R'");
  EXPECT_EQ(errorOf(kHead + "start: 0.5 0.6\n"),
            "m:6:8: the start belief sums to 1.100000, expected 1");
  EXPECT_EQ(errorOf(kHead + kRest + "R: go a\n"), "m:8:7: found 'a', expected ':'");
  EXPECT_EQ(errorOf(kHead + kRest + "T: go : b : b 0.5\n"),
            "m:8:1: T(. | state 'b', action 'go') sums to 0.500000, expected a sum of 1");
  EXPECT_EQ(errorOf(kHead + "T: * identity\nO: go uniform\n"),
            "m:8:1: O(. | action 'stay', next state 'a') is never given, expected a sum of 1");
  EXPECT_EQ(errorOf(kHead + kRest + "R: go : a : * : * nan\n"),
            "m:8:19: found 'nan', expected a reward");
}

TEST(PomdpFormat, RoundTripIsExact)
{
  for (std::uint64_t seed = 1; seed <= 5; ++seed)
  {
    const Model model = test::randomModel({4, 3, 5, 0.87}, seed);
    std::stringstream text;
    writePomdp(text, model);
    expectEqual(model, readPomdp(text, "text"));
  }
  const Model room = test::roomSearch(2);
  std::stringstream text;
  writePomdp(text, room);
  expectEqual(room, readPomdp(text, "text"));
}

Model readWithin(const std::string& text, const ReadOptions& options)
{
  std::istringstream in(text);
  return readPomdp(in, "m", options);
}

TEST(PomdpFormat, LargerThanAllowedIsRefused)
{
  ReadOptions options;
  options.max_names = 1000;
  options.max_rows = 2000;
  options.max_entries = 100000;
  EXPECT_EQ(readWithin(kHead + kRest, options).numStates(), 2U);
  const std::string tail = "\nactions: 3\nobservations: 2\nT: * uniform\nO: * uniform\n";
  const std::string head = "discount: 0.9\nvalues: reward\nstates: ";
  EXPECT_THROW(readWithin(head + "9000000" + tail, options), ResourceExhausted);
  EXPECT_THROW(readWithin(head + "900" + tail, options), ResourceExhausted);  // 2700 rows
  EXPECT_THROW(readWithin(head + "500" + tail, options), ResourceExhausted);  // 750000 entries
  EXPECT_EQ(readWithin(head + "100" + tail, options).numStates(), 100U);
}

TEST(PomdpFormat, ReadingIsCancelled)
{
  ReadOptions options;
  int asked = 0;
  options.keep_going = [&asked] { return ++asked < 2; };
  EXPECT_THROW(readWithin(kHead + kRest, options), Cancelled);
  EXPECT_EQ(asked, 2);
}

TEST(PomdpFormat, AMissingFileIsUnavailable)
{
  EXPECT_THROW((void)loadPomdp("/nowhere/model.pomdp"), Unavailable);
}

TEST(PomdpFormat, NumbersNamesThatOtherToolsCannotRead)
{
  ModelBuilder builder({"0,1", "1,1"}, {"go"}, {"a-b", "c_d"});
  builder.setDiscount(0.5);
  builder.setTransition(kAny, kAny, 0, 1.0);
  builder.setObservation(kAny, kAny, 1, 1.0);
  builder.setReward(0, 1, -0.25);
  const Model model = builder.build();
  std::stringstream text;
  EXPECT_THROW(writePomdp(text, model), InvalidArgument);
  text.str("");
  EXPECT_EQ(writePomdpNumbered(text, model), std::vector<std::string>{"state"});
  EXPECT_NE(text.str().find("# state 1: 1,1\n"), std::string::npos);
  const Model copy = readPomdp(text, "copy");
  EXPECT_EQ(copy.stateName(1), "1");
  EXPECT_EQ(copy.observationName(0), "a-b");
  EXPECT_EQ(copy.reward(0, 1), -0.25);
}

}  // namespace
}  // namespace kr3::pomdp
