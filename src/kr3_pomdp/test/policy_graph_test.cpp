#include "kr3_pomdp/policy_graph.hpp"

#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_pomdp/model_builder.hpp"
#include "kr3_pomdp/solver.hpp"
#include "support/factored_models.hpp"
#include "support/models.hpp"

namespace kr3::pomdp
{
namespace
{

Policy solved(const Model& model)
{
  SolverLimits limits;
  limits.precision = 0.01;
  limits.max_backups = 2000;
  return solve(model, limits).policy;
}

std::string dotOf(const PolicyGraph& graph, const Model& model)
{
  std::ostringstream out;
  writeDot(out, graph, model);
  return out.str();
}

// Listen until one side was heard twice more than the other, then open the other door; after that
// all begins again. Source: Kaelbling, Littman and Cassandra (1998), Fig. 17 (for this discount).
TEST(PolicyGraph, OfTigerListensUntilItHeardTwoMoreOfOneSide)
{
  const Model model = test::tiger();
  PolicyGraphLimits limits;
  limits.min_probability = 0.01;
  for (const PolicyGraphNodes kind : {PolicyGraphNodes::kBeliefs, PolicyGraphNodes::kVectors})
  {
    const PolicyGraph graph = policyGraph(model, solved(model), limits, kind);
    ASSERT_EQ(graph.nodes.size(), 5U);
    ASSERT_EQ(graph.starts.size(), 1U);
    EXPECT_EQ(graph.starts.front().node, 0U);
    EXPECT_EQ(graph.starts.front().probability, 1.0);
    EXPECT_EQ(graph.edges.size(), 10U);
    EXPECT_EQ(graph.nodes[0].action, 0U);
    EXPECT_EQ(graph.nodes[0].value, solved(model).valueAt(model.initialBelief()));
    for (const PolicyGraph::Edge& edge : graph.edges)
    {
      const bool opens = graph.nodes[edge.from].action != 0;
      EXPECT_TRUE(!opens || edge.to == 0) << "after opening a door all begins again";
    }
    EXPECT_EQ(graph.nodes[3].action + graph.nodes[4].action, 3U);
    EXPECT_EQ(graph.nodes[3].depth, 2U);
  }
}

TEST(PolicyGraph, ObservationsAfterANodeSumToOne)
{
  const Model model = test::randomFactored(3).flattened();
  PolicyGraphLimits limits;
  limits.min_probability = 0.0;
  limits.max_nodes = 100000;
  limits.max_depth = 3;
  const PolicyGraph graph = policyGraph(model, solved(model), limits);
  EXPECT_EQ(graph.starts.size(), model.initialOutcomes().size());
  std::vector<double> sums(graph.nodes.size(), 0.0);
  for (const PolicyGraph::Edge& edge : graph.edges)
  {
    sums[edge.from] += edge.probability;
  }
  for (std::size_t i = 0; i < sums.size(); ++i)
  {
    const bool ends = graph.nodes[i].end != PolicyGraph::End::kNone;
    EXPECT_NEAR(sums[i], ends ? 0.0 : 1.0, 1e-9);
    EXPECT_TRUE(!ends || graph.nodes[i].depth == limits.max_depth);
  }
}

TEST(PolicyGraph, KeepsToItsLimits)
{
  const Model model = test::roomSearch(2);
  const Policy policy = solved(model);
  PolicyGraphLimits limits;
  limits.max_nodes = 7;
  EXPECT_EQ(policyGraph(model, policy, limits).nodes.size(), 7U);
  limits.max_nodes = 1000;
  limits.max_depth = 0;
  EXPECT_EQ(policyGraph(model, policy, limits).nodes.size(), 1U);
  limits.max_nodes = 0;
  EXPECT_THROW((void)policyGraph(model, policy, limits), InvalidArgument);
  limits.max_nodes = 1;
  limits.min_probability = 1.5;
  EXPECT_THROW((void)policyGraph(model, policy, limits), InvalidArgument);
  EXPECT_THROW((void)policyGraph(test::tiger(), policy, {}), InvalidArgument);
}

TEST(PolicyGraph, ADotTextQuotesNamesAndMarksWhereAllIsOver)
{
  ModelBuilder builder({R"(a "b\)", "over"}, {"wait"}, {"see\nit", "nothing"});
  builder.setDiscount(0.5);
  builder.setInitialBelief({1.0, 0.0});
  builder.setTransition(kAny, kAny, 1, 1.0);
  builder.setObservation(0, kAny, 0, 0.25);
  builder.setObservation(0, kAny, 1, 0.75);
  builder.setReward(0, 0, 1.0);
  const Model model = builder.build();
  const Policy policy(2, {{0, {}, {1.0, 0.0}}});
  EXPECT_EQ(dotOf(policyGraph(model, policy, {}), model), R"dot(digraph policy {
  graph [rankdir=TB, nodesep=0.3, ranksep=0.5];
  node [shape=box, style="rounded,filled", fontname="Helvetica", fontsize=11];
  edge [fontname="Helvetica", fontsize=9];
  n0 [label="wait\nvalue 1\na \"b\\ 1", fillcolor="#cfe2f3"];
  n1 [label="finished\nvalue 0\nover 1", fillcolor="#ffffff", peripheries=2];
  start0 [shape=point, width=0.12];
  start0 -> n0;
  n0 -> n1 [label="nothing 0.75\nsee it 0.25"];
}
)dot");
}

}  // namespace
}  // namespace kr3::pomdp
