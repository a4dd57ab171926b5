#include "kr3_pomdp/policy_format.hpp"

#include <random>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_pomdp/model_builder.hpp"
#include "kr3_pomdp/simulation.hpp"
#include "kr3_pomdp/solver.hpp"
#include "support/factored_models.hpp"
#include "support/models.hpp"

namespace kr3::pomdp
{
namespace
{

std::string applText(const Policy& policy, const Model& model)
{
  std::ostringstream out;
  writeApplPolicy(out, policy, model, "m");
  return out.str();
}

Policy fromAppl(const std::string& text, const Model& model)
{
  std::istringstream in(text);
  return readApplPolicy(in, "p", model);
}

/// A random belief over the states with one label, some of them without mass.
Belief beliefOfLabel(const Model& model, std::uint32_t label, std::mt19937_64& random)
{
  std::vector<double> weights(model.numStates(), 0.0);
  double sum = 0.0;
  for (std::size_t s = 0; s < weights.size(); ++s)
  {
    if (model.initialLabels().empty() || model.initialLabels()[s] == label)
    {
      weights[s] = random() % 3 == 0 ? 0.0 : static_cast<double>(1 + random() % 1000);
      sum += weights[s];
    }
  }
  if (sum == 0.0)
  {
    return beliefOfLabel(model, label, random);
  }
  for (double& weight : weights)
  {
    weight /= sum;
  }
  return Belief(weights);
}

Policy solved(const Model& model)
{
  SolverLimits limits;
  limits.precision = 0.01;
  limits.max_backups = 2000;
  return solve(model, limits).policy;
}

TEST(ApplPolicy, KeepsValuesAndActionsWhereTheRobotSeesNothingOfTheState)
{
  const Model model = test::tiger();
  const Policy policy = solved(model);
  const Policy copy = fromAppl(applText(policy, model), model);
  EXPECT_EQ(copy.numAlphaVectors(), policy.numAlphaVectors());
  std::mt19937_64 random(1);
  for (int i = 0; i < 200; ++i)
  {
    const Belief belief = beliefOfLabel(model, 0, random);
    EXPECT_EQ(copy.valueAt(belief), policy.valueAt(belief));
    EXPECT_EQ(copy.actionAt(belief), policy.actionAt(belief));
  }
}

TEST(ApplPolicy, KeepsValuesWhereTheRobotSeesSomeVariables)
{
  for (std::uint64_t seed = 1; seed <= 5; ++seed)
  {
    const Model model = test::randomFactored(seed).flattened();
    const Policy policy = solved(model);
    const std::string text = applText(policy, model);
    EXPECT_NE(text.find("vectorLength=\"6\" numObsValue=\"6\""), std::string::npos);
    const Policy copy = fromAppl(text, model);
    std::mt19937_64 random(seed);
    for (std::uint32_t label = 0; label < 6; ++label)
    {
      for (int i = 0; i < 50; ++i)
      {
        const Belief belief = beliefOfLabel(model, label, random);
        EXPECT_DOUBLE_EQ(copy.valueAt(belief), policy.valueAt(belief)) << "label " << label;
      }
    }
  }
}

// What the search found by itself that the robot always knows is no variable of the file: the
// vectors are filled up from below, which must not change what the policy does.
TEST(ApplPolicy, FillsVectorsOverSomeStatesFromBelow)
{
  const Model model = test::roomSearch(2);
  const Policy policy = solved(model);
  const Policy copy = fromAppl(applText(policy, model), model);
  EXPECT_DOUBLE_EQ(copy.valueAt(model.initialBelief()), policy.valueAt(model.initialBelief()));
  EvaluationLimits limits;
  limits.trials = 200;
  EXPECT_DOUBLE_EQ(evaluate(model, copy, limits, 1).mean, evaluate(model, policy, limits, 1).mean);
}

TEST(ApplPolicy, WritingReadsBackAsTheSameText)
{
  const Model model = test::randomFactored(2).flattened();
  const std::string once = applText(fromAppl(applText(solved(model), model), model), model);
  EXPECT_EQ(applText(fromAppl(once, model), model), once);
}

TEST(ApplPolicy, ReadsDenseAndSparseVectors)
{
  const Policy policy = fromAppl(R"(<?xml version="1.0" encoding="ISO-8859-1"?>
<Policy version="0.1" type="value" model="tiger.pomdp" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance">
<AlphaVector vectorLength="2" numObsValue="1" numVectors="2">
<Vector action="0" obsValue="0">-1.5e-05 2 </Vector>
<SparseVector action="2" obsValue="0"><Entry>0 7.5</Entry></SparseVector>
</AlphaVector> </Policy>
)",
                                 test::tiger());
  const std::vector<AlphaVector> vectors = policy.alphaVectors();
  ASSERT_EQ(vectors.size(), 2U);
  EXPECT_EQ(vectors[0].values, (std::vector<double>{-1.5e-05, 2.0}));
  EXPECT_EQ(vectors[1].action, 2U);
  EXPECT_EQ(vectors[1].values, (std::vector<double>{7.5, 0.0}));
}

TEST(ApplPolicy, ReadingNamesThePlace)
{
  const auto errorOf = [](const std::string& text) {
    try
    {
      (void)fromAppl(text, test::tiger());
    }
    catch (const InvalidArgument& e)
    {
      return std::string(e.what());
    }
    return std::string("no error");
  };
  const auto policy = [](const std::string& attributes, const std::string& vectors) {
    return "<Policy type=\"value\">\n<AlphaVector " + attributes + ">\n" + vectors +
           "</AlphaVector></Policy>";
  };
  const std::string tiger = "vectorLength=\"2\" numObsValue=\"1\" numVectors=\"1\"";
  EXPECT_EQ(errorOf("<Policy>\n</Polic>"),
            "p:2:3: found Start-end tags mismatch, expected "
            "well-formed XML");
  EXPECT_EQ(errorOf("<pomdpx/>"), "p:1:1: found <pomdpx>, expected <Policy>");
  EXPECT_EQ(errorOf("<Policy type=\"graph\"/>"), "p:1:1: found type 'graph', expected 'value'");
  EXPECT_EQ(errorOf("<Policy/>"),
            "p:1:1: found <Policy> without it, expected a <AlphaVector> "
            "inside");
  EXPECT_EQ(errorOf(policy("vectorLength=\"3\" numObsValue=\"1\"", "")),
            "p:2:1: found vectorLength '3', expected 2, the number of states that the robot cannot "
            "tell apart");
  EXPECT_EQ(
      errorOf(policy("vectorLength=\"2\" numObsValue=\"4\"", "")),
      "p:2:1: found numObsValue '4', expected 1, the number of values of what the robot sees");
  EXPECT_EQ(errorOf(policy(tiger, "")), "p:2:1: found no vectors, expected at least one");
  EXPECT_EQ(errorOf(policy("vectorLength=\"2\" numObsValue=\"1\" numVectors=\"9\"",
                           "<Vector action=\"0\" obsValue=\"0\">1 2 </Vector>")),
            "p:2:1: found numVectors '9', expected 1, the number of vectors in the file");
  EXPECT_EQ(errorOf(policy(tiger, "<Vector action=\"3\" obsValue=\"0\">1 2 </Vector>")),
            "p:3:1: found action '3', expected the index of one of 3 actions");
  EXPECT_EQ(errorOf(policy(tiger, "<Vector action=\"0\" obsValue=\"1\">1 2 </Vector>")),
            "p:3:1: found obsValue '1', expected the index of one of 1 values of what the robot "
            "sees");
  EXPECT_EQ(errorOf(policy(tiger, "<Vector action=\"0\">1 2 </Vector>")),
            "p:3:1: found <Vector> without it, expected an attribute 'obsValue'");
  EXPECT_EQ(errorOf(policy(tiger, "<Vector action=\"0\" obsValue=\"0\">1 </Vector>")),
            "p:3:1: found 1 values, expected 2");
  EXPECT_EQ(errorOf(policy(tiger, "<Vector action=\"0\" obsValue=\"0\">1\nnan</Vector>")),
            "p:4:1: found 'nan', expected a number");
  EXPECT_EQ(errorOf(policy(tiger,
                           "<SparseVector action=\"0\" obsValue=\"0\"><Entry>2 1</Entry>"
                           "</SparseVector>")),
            "p:3:46: found '2', expected an index below 2");
  EXPECT_EQ(errorOf(policy(tiger, "<Node action=\"0\" obsValue=\"0\"/>")),
            "p:3:1: found <Node>, expected <Vector> or <SparseVector>");
}

TEST(ApplPolicy, NeedsAsManyStatesForEachValueThatTheRobotSees)
{
  ModelParts parts;
  parts.states = {"a", "b", "c"};
  parts.actions = {"go"};
  parts.observations = {"none"};
  parts.initial_belief = {0.5, 0.25, 0.25};
  parts.initial_labels = {0, 1, 1};
  SharedRowsBuilder stay;
  SharedRowsBuilder nothing;
  for (std::uint32_t s = 0; s < 3; ++s)
  {
    stay.append({{s, 1.0}});
    nothing.append({{0, 1.0}});
  }
  parts.discount = 0.5;
  parts.transitions = stay.take();
  parts.observation_rows = nothing.take();
  parts.rewards = {0.0, 0.0, 0.0};
  const Model model(std::move(parts));
  EXPECT_THROW((void)applText(Policy(3, {{0, {}, {0, 0, 0}}}), model), InvalidArgument);
}

TEST(PolicyFormat, RejectsAPolicyOfAnotherModel)
{
  std::ostringstream out;
  EXPECT_THROW(writeApplPolicy(out, Policy(3, {{0, {}, {0, 0, 0}}}), test::tiger(), "m"),
               InvalidArgument);
  EXPECT_THROW(checkFits(Policy(2, {{7, {}, {0, 0}}}), test::tiger()), InvalidArgument);
  EXPECT_THROW((void)loadPolicy("/no/such/file", test::tiger()), Unavailable);
}

}  // namespace
}  // namespace kr3::pomdp
