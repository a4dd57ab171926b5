#include "kr3_pomdp/pomdpx_format.hpp"

#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_pomdp/solver.hpp"
#include "support/factored_models.hpp"
#include "support/models.hpp"

namespace kr3::pomdp
{
namespace
{

FactoredModel read(const std::string& text)
{
  std::istringstream in(text);
  return readPomdpx(in, "m");
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

void expectSame(const Model& a, const Model& b)
{
  ASSERT_EQ(a.numStates(), b.numStates());
  ASSERT_EQ(a.numActions(), b.numActions());
  ASSERT_EQ(a.numObservations(), b.numObservations());
  EXPECT_EQ(a.discount(), b.discount());
  EXPECT_EQ(a.initialBelief().probabilities(), b.initialBelief().probabilities());
  const auto same = [](const SparseRow& p, const SparseRow& q) {
    return std::equal(p.begin(), p.end(), q.begin(), q.end(),
                      [](const SparseEntry& x, const SparseEntry& y) {
      return x.index == y.index && x.probability == y.probability;
    });
  };
  for (std::size_t action = 0; action < a.numActions(); ++action)
  {
    for (std::size_t s = 0; s < a.numStates(); ++s)
    {
      EXPECT_TRUE(same(a.transitions(action, s), b.transitions(action, s)));
      EXPECT_TRUE(same(a.observations(action, s), b.observations(action, s)));
      EXPECT_EQ(a.reward(action, s), b.reward(action, s));
    }
  }
}

/// A rover on a line of three: `s0` with a rock, `s1`, and the exit `s2`.
struct Rover
{
  std::string variables = R"(<Variable>
<StateVar vnamePrev="rover_0" vnameCurr="rover_1" fullyObs="true"><NumValues>3</NumValues></StateVar>
<StateVar vnamePrev="rock_0" vnameCurr="rock_1"><ValueEnum>good bad</ValueEnum></StateVar>
<ObsVar vname="sensor"><ValueEnum>ogood obad</ValueEnum></ObsVar>
<ActionVar vname="action"><ValueEnum>west east check</ValueEnum></ActionVar>
<RewardVar vname="reward"/>
</Variable>
)";
  std::string initial = R"(<InitialStateBelief>
<CondProb><Var>rover_0</Var><Parent>null</Parent><Parameter type="TBL">
<Entry><Instance>-</Instance><ProbTable>0 1 0</ProbTable></Entry></Parameter></CondProb>
<CondProb><Var>rock_0</Var><Parent>null</Parent><Parameter type="TBL">
<Entry><Instance>-</Instance><ProbTable>uniform</ProbTable></Entry></Parameter></CondProb>
</InitialStateBelief>
)";
  std::string rover = R"(<CondProb><Var>rover_1</Var><Parent>action rover_0</Parent><Parameter>
<Entry><Instance>* - -</Instance><ProbTable>identity</ProbTable></Entry>
<Entry><Instance>west * -</Instance><ProbTable>1 0 0</ProbTable></Entry>
<Entry><Instance>west s2 -</Instance><ProbTable>0.0 0 1</ProbTable></Entry>
<Entry><Instance>east s1 *</Instance><ProbTable>0</ProbTable></Entry>
<Entry><Instance>east s1 s2</Instance><ProbTable>1</ProbTable></Entry>
</Parameter></CondProb>
)";
  std::string rock = R"(<CondProb><Var>rock_1</Var><Parent>action rover_0 rock_0</Parent><Parameter>
<Entry><Instance>* * - -</Instance><ProbTable>identity</ProbTable></Entry>
</Parameter></CondProb>
)";
  std::string observations = R"(<ObsFunction><CondProb>
<Var>sensor</Var><Parent>action rover_1 rock_1</Parent><Parameter type="TBL">
<Entry><Instance>* * * *</Instance><ProbTable>uniform</ProbTable></Entry>
<Entry><Instance>check s0 - -</Instance><ProbTable>0.875 0.125 0.25 0.75</ProbTable></Entry>
</Parameter></CondProb></ObsFunction>
)";
  std::string rewards = R"(<RewardFunction>
<Func><Var>reward</Var><Parent>action rover_0</Parent><Parameter type="TBL">
<Entry><Instance>east s1</Instance><ValueTable>10</ValueTable></Entry></Parameter></Func>
<Func><Var>reward</Var><Parent>rover_0 rock_0</Parent><Parameter type="TBL">
<Entry><Instance>s0 -</Instance><ValueTable>1 -2</ValueTable></Entry></Parameter></Func>
</RewardFunction>
)";

  [[nodiscard]] std::string text() const
  {
    return "<?xml version=\"1.0\"?>\n<pomdpx version=\"1.0\" id=\"rover\">\n<Discount> 0.5 "
           "</Discount>\n" +
           variables + initial + "<StateTransitionFunction>\n" + rover + rock +
           "</StateTransitionFunction>\n" + observations + rewards + "</pomdpx>\n";
  }
};

double chance(const SparseRow& row, std::size_t index)
{
  for (const SparseEntry& entry : row)
  {
    if (entry.index == index)
    {
      return entry.probability;
    }
  }
  return 0.0;
}

TEST(PomdpxFormat, ReadsTablesWithWildcards)
{
  const Model model = read(Rover().text()).flattened();
  ASSERT_EQ(model.numStates(), 6U);
  ASSERT_EQ(model.numObservations(), 6U);
  const auto state = [&](const char* name) { return *model.findState(name); };
  const auto action = [&](const char* name) { return *model.findAction(name); };
  EXPECT_EQ(chance(model.transitions(action("west"), state("s1,bad")), state("s0,bad")), 1.0);
  EXPECT_EQ(chance(model.transitions(action("west"), state("s2,bad")), state("s2,bad")), 1.0);
  EXPECT_EQ(chance(model.transitions(action("east"), state("s1,good")), state("s2,good")), 1.0);
  EXPECT_EQ(chance(model.transitions(action("check"), state("s1,good")), state("s1,good")), 1.0);
  EXPECT_EQ(chance(model.observations(action("check"), state("s0,bad")),
                   *model.findObservation("ogood,s0")),
            0.25);
  EXPECT_EQ(chance(model.observations(action("check"), state("s1,bad")),
                   *model.findObservation("ogood,s1")),
            0.5);
  EXPECT_EQ(model.reward(action("east"), state("s1,bad")), 10.0);
  EXPECT_EQ(model.reward(action("east"), state("s0,bad")), -2.0);
  EXPECT_EQ(model.initialBelief()[state("s1,good")], 0.5);
}

TEST(PomdpxFormat, DiagramsSayTheSameAsTables)
{
  Rover diagrams;
  diagrams.initial = R"(<InitialStateBelief><CondProb><Var>rover_0 rock_0</Var><Parent>null</Parent>
<Parameter type="DD"><DAG><Node var="rover_0">
<Edge val="s0"><Terminal>0.0</Terminal></Edge>
<Edge val="s1"><SubDAG type="uniform" var="rock_0"/></Edge>
</Node></DAG></Parameter></CondProb></InitialStateBelief>
)";
  diagrams.rover = R"(<CondProb><Var>rover_1</Var><Parent>action rover_0</Parent>
<Parameter type="DD"><DAG><Node var="action">
<Edge val="west"><Node var="rover_0">
  <Edge val="s0"><SubDAG type="deterministic" var="rover_1" val="s0"/></Edge>
  <Edge val="s1"><SubDAG type="deterministic" var="rover_1" val="s0"/></Edge>
  <Edge val="s2"><SubDAG type="persistent" var="rover_1"/></Edge></Node></Edge>
<Edge val="east"><Node var="rover_0">
  <Edge val="s0"><SubDAG type="template" idref="stay"/></Edge>
  <Edge val="s1"><Node var="rover_1"><Edge val="s2"><Terminal>1</Terminal></Edge></Node></Edge>
  <Edge val="s2"><SubDAG type="template" idref="stay"/></Edge></Node></Edge>
<Edge val="check"><SubDAG type="template" idref="stay"/></Edge>
</Node></DAG>
<SubDAGTemplate id="stay"><SubDAG type="persistent" var="rover_1"/></SubDAGTemplate>
</Parameter></CondProb>
)";
  diagrams.rock = R"(<CondProb><Var>rock_1</Var><Parent>action rover_0 rock_0</Parent>
<Parameter type="DD"><DAG><SubDAG type="persistent" var="rock_1"/></DAG></Parameter></CondProb>
)";
  expectSame(read(diagrams.text()).flattened(), read(Rover().text()).flattened());
}

TEST(PomdpxFormat, TheTigerIsTheTiger)
{
  const Model tiger = test::tiger();
  std::stringstream text;
  writePomdpx(text, tiger);
  expectSame(readPomdpx(text, "tiger").flattened(), tiger);
}

TEST(PomdpxFormat, RandomModelsComeBackToTheLastBit)
{
  for (std::uint64_t seed = 0; seed < 20; ++seed)
  {
    const Model model = test::randomModel({4, 3, 3, 0.9}, seed);
    std::stringstream text;
    writePomdpx(text, model);
    expectSame(readPomdpx(text, "random").flattened(), model);
  }
}

TEST(PomdpxFormat, WhatIsSeenFirstIsKept)
{
  Rover rover;
  rover.initial = R"(<InitialStateBelief>
<CondProb><Var>rover_0 rock_0</Var><Parent>null</Parent><Parameter>
<Entry><Instance>- -</Instance><ProbTable>0.25 0 0.25 0.5 0 0</ProbTable></Entry></Parameter></CondProb>
</InitialStateBelief>
)";
  const Model model = read(rover.text()).flattened();
  ASSERT_EQ(model.initialOutcomes().size(), 2U);
  std::stringstream text;
  writePomdpx(text, model);
  SolverLimits limits;
  limits.max_backups = 100000;
  limits.precision = 1e-6;
  EXPECT_NEAR(solve(readPomdpx(text, "rover").flattened(), limits).lower,
              solve(model, limits).lower, 2e-6);
}

TEST(PomdpxFormat, ErrorsNamePlaceAndWhatWasExpected)
{
  Rover rover;
  rover.rover.replace(rover.rover.find("west s2"), 7, "west s9");
  EXPECT_EQ(errorOf(rover.text()),
            "m:21:23: found 's9', expected a value of 'rover_0', '*' or '-'");
  rover = Rover();
  rover.observations.replace(rover.observations.find("0.25 0.75"), 9, "0.25");
  EXPECT_EQ(errorOf(rover.text()).substr(0, 7), "m:32:41");
  EXPECT_NE(errorOf(rover.text()).find("found 3 numbers, expected 4"), std::string::npos);
  rover = Rover();
  rover.rewards.replace(rover.rewards.find("action rover_0"), 14, "action rovre_0");
  EXPECT_NE(errorOf(rover.text()).find("found 'rovre_0', expected a declared variable"),
            std::string::npos);
  rover = Rover();
  rover.variables.replace(rover.variables.find(">3<"), 3, ">0<");
  EXPECT_NE(errorOf(rover.text()).find("expected a number of values from 1"), std::string::npos);
}

TEST(PomdpxFormat, BrokenFilesAreRefused)
{
  const std::string good = Rover().text();
  for (std::size_t length = 0; length + 12 < good.size(); length += 37)
  {
    EXPECT_EQ(errorOf(good.substr(0, length)).substr(0, 2), "m:") << length;
  }
  EXPECT_NE(errorOf("<pomdp/>").find("expected <pomdpx>"), std::string::npos);
  EXPECT_EQ(errorOf(std::string("<pomdpx\0/>", 10)).substr(0, 2), "m:");
  std::string circle = Rover().text();
  const std::string entry =
      "<Entry><Instance>* * - -</Instance><ProbTable>identity</ProbTable></Entry>";
  const std::size_t at = circle.find(entry);
  circle.replace(at, entry.size(),
                 "<DAG><SubDAG type=\"template\" idref=\"t\"/></DAG><SubDAGTemplate id=\"t\">"
                 "<SubDAG type=\"template\" idref=\"t\"/></SubDAGTemplate>");
  circle.replace(circle.rfind("<Parameter>", at), 11, "<Parameter type=\"DD\">");
  EXPECT_NE(errorOf(circle).find("does a template use itself?"), std::string::npos);
}

TEST(PomdpxFormat, AModelInFactorsRoundTripsExactly)
{
  for (std::uint64_t seed = 1; seed <= 3; ++seed)
  {
    FactoredModel model = test::randomFactored(seed);
    model.state[0].name = "place_0";
    model.state[0].values = {"at<door>", "&elsewhere"};
    model.rewards.push_back({{}, {}, {-0.1}});
    std::stringstream text;
    writePomdpx(text, model);
    const FactoredModel copy = readPomdpx(text, "copy");
    ASSERT_EQ(copy.state.size(), model.state.size());
    for (std::size_t v = 0; v < model.state.size(); ++v)
    {
      EXPECT_EQ(copy.state[v].name, model.state[v].name);
      EXPECT_EQ(copy.state[v].values, model.state[v].values);
      EXPECT_EQ(copy.state[v].observed, model.state[v].observed);
    }
    const auto expectSameFactors = [](const std::vector<Factor>& a, const std::vector<Factor>& b) {
      ASSERT_EQ(a.size(), b.size());
      for (std::size_t f = 0; f < a.size(); ++f)
      {
        EXPECT_EQ(a[f].parents, b[f].parents);
        EXPECT_EQ(a[f].of, b[f].of);
        EXPECT_EQ(a[f].values, b[f].values);
      }
    };
    expectSameFactors(copy.initial, model.initial);
    expectSameFactors(copy.transitions, model.transitions);
    expectSameFactors(copy.observing, model.observing);
    expectSameFactors(copy.rewards, model.rewards);
    expectSame(copy.flattened(), model.flattened());
  }
}

TEST(PomdpxFormat, WritingRejectsNamesThatItCannotHold)
{
  std::ostringstream out;
  FactoredModel model = test::randomFactored(1);
  model.state[1].values[0] = "two words";
  EXPECT_THROW(writePomdpx(out, model), InvalidArgument);
  model = test::randomFactored(1);
  model.actions[0].name = model.state[0].name;
  EXPECT_THROW(writePomdpx(out, model), InvalidArgument);
  model = test::randomFactored(1);
  model.transitions[0].values.pop_back();
  EXPECT_THROW(writePomdpx(out, model), InvalidArgument);
}

}  // namespace
}  // namespace kr3::pomdp
