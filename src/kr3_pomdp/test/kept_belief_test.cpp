#include "kr3_pomdp/kept_belief.hpp"

#include <limits>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_pomdp/model_text.hpp"
#include "support/models.hpp"

namespace kr3::pomdp
{
namespace
{

std::shared_ptr<const SolvedModel> tiger()
{
  const auto source = std::make_shared<const NamedModel>(NamedModel{{}, test::tiger()});
  SolverLimits limits;
  limits.precision = 0.01;
  return std::make_shared<const SolvedModel>(
      solvedModel(source, limits, solve(source->model, limits)));
}

template <typename Expected>
std::string errorOf(const std::function<void()>& call)
{
  try
  {
    call();
  }
  catch (const Expected& e)
  {
    return e.what();
  }
  return "no error";
}

TEST(KeptBelief, FollowsTheExactUpdate)
{
  const auto solved = tiger();
  KeptBelief kept(solved, solved->model().initialBelief());
  EXPECT_EQ(kept.version(), 1U);
  const KeptBelief::Advanced once = kept.advance("listen", "hear_left", 1);
  EXPECT_EQ(once.now.version, 2U);
  EXPECT_DOUBLE_EQ(once.probability, 0.5);
  EXPECT_DOUBLE_EQ(once.now.belief[0], 0.85);
  const BeliefUpdate expected = updated(solved->model(), once.now.belief, 0, 0);
  const KeptBelief::Advanced twice = kept.advance("listen", "hear_left", 0);
  EXPECT_EQ(twice.now.belief.probabilities(), expected.posterior.probabilities());
  EXPECT_EQ(kept.snapshot().belief.probabilities(), expected.posterior.probabilities());
  EXPECT_EQ(choiceAt(*solved, twice.now.belief)->action, 2U);
}

TEST(KeptBelief, AFailedChangeLeavesItAsItWas)
{
  const auto solved = tiger();
  KeptBelief kept(solved, solved->model().initialBelief());
  EXPECT_EQ(errorOf<InvalidArgument>([&] { kept.advance("lisen", "hear_left", 0); }),
            "the model has no action 'lisen'; did you mean 'listen'?");
  EXPECT_EQ(errorOf<InvalidArgument>([&] { kept.advance("listen", "hear_leftt", 0); }),
            "the model has no observation 'hear_leftt'; did you mean 'hear_left'?");
  EXPECT_EQ(errorOf<FailedPrecondition>([&] { kept.advance("listen", "hear_left", 7); }),
            "the belief has version 1, expected 7");
  EXPECT_THROW(kept.reset(Belief({1.0})), InvalidArgument);
  EXPECT_EQ(kept.version(), 1U);
  EXPECT_EQ(kept.snapshot().belief.probabilities(), std::vector<double>({0.5, 0.5}));
}

TEST(KeptBelief, AnImpossibleObservationIsRefused)
{
  const std::string text =
      "discount: 0.9\nvalues: reward\nstates: a b\nactions: go\nobservations: x y\n"
      "start: 1 0\nT: * identity\nO: go : a : x 1\nO: go : b : y 1\n";
  const auto source = std::make_shared<const NamedModel>(
      NamedModel{{"pomdp", text}, readModel({"pomdp", text}, "model")});
  const auto solved = std::make_shared<const SolvedModel>(unsolvedModel(source, std::nullopt));
  KeptBelief kept(solved, source->model.initialBelief());
  EXPECT_EQ(kept.numNonzero(), 1U);
  EXPECT_THROW(kept.advance("go", "y", 0), FailedPrecondition);
  EXPECT_EQ(kept.version(), 1U);
  EXPECT_DOUBLE_EQ(kept.advance("go", "x", 0).probability, 1.0);
  EXPECT_FALSE(choiceAt(*solved, kept.snapshot().belief));
}

TEST(SparseBelief, GivesBackTheSame)
{
  const Belief belief({0.0, 0.25, 0.0, 0.75});
  EXPECT_EQ(sparse(belief).size(), 2U);
  EXPECT_EQ(dense(sparse(belief), 4).probabilities(), belief.probabilities());
  EXPECT_THROW((void)dense({{4, 1.0}}, 4), InvalidArgument);
  EXPECT_THROW((void)dense({{2, 0.5}, {2, 0.5}}, 4), InvalidArgument);
  EXPECT_THROW((void)dense({{2, 0.5}, {1, 0.5}}, 4), InvalidArgument);
  EXPECT_THROW((void)dense({{1, 0.5}, {2, 0.4}}, 4), InvalidArgument);
  EXPECT_THROW((void)dense({{1, -0.5}, {2, 1.5}}, 4), InvalidArgument);
  EXPECT_THROW((void)dense({{1, std::numeric_limits<double>::quiet_NaN()}}, 4), InvalidArgument);
  EXPECT_THROW((void)dense({}, 4), InvalidArgument);
}

TEST(InitialBelief, TakesWhatIsSeenFirst)
{
  EXPECT_EQ(initialBelief(test::tiger(), "").probabilities(), std::vector<double>({0.5, 0.5}));
  EXPECT_THROW((void)initialBelief(test::tiger(), "left"), InvalidArgument);
  // Two cells that the robot sees, two places of the object that it does not.
  const std::string variables =
      "<Variable>"
      "<StateVar vnamePrev='cell_0' vnameCurr='cell_1' fullyObs='true'>"
      "<ValueEnum>c1 c2</ValueEnum></StateVar>"
      "<StateVar vnamePrev='object_0' vnameCurr='object_1' fullyObs='false'>"
      "<ValueEnum>o1 o2</ValueEnum></StateVar>"
      "<ObsVar vname='seen'><ValueEnum>yes no</ValueEnum></ObsVar>"
      "<ActionVar vname='act'><ValueEnum>look</ValueEnum></ActionVar>"
      "<RewardVar vname='earned'/></Variable>";
  const auto table =
      [](const std::string& var, const std::string& parents, const std::string& entries) {
    return "<CondProb><Var>" + var + "</Var><Parent>" + parents +
           "</Parent><Parameter type='TBL'>" + entries + "</Parameter></CondProb>";
  };
  const auto entry = [](const std::string& instance, const std::string& values) {
    return "<Entry><Instance>" + instance + "</Instance><ProbTable>" + values +
           "</ProbTable></Entry>";
  };
  const std::string text =
      "<pomdpx version='0.1'><Discount>0.9</Discount>" + variables + "<InitialStateBelief>" +
      table("cell_0", "null", entry("-", "0.25 0.75")) +
      table("object_0", "cell_0", entry("c1 -", "1 0") + entry("c2 -", "0.5 0.5")) +
      "</InitialStateBelief><StateTransitionFunction>" +
      table("cell_1", "act cell_0", entry("* - -", "identity")) +
      table("object_1", "act object_0", entry("* - -", "identity")) +
      "</StateTransitionFunction><ObsFunction>" +
      table("seen", "act object_1", entry("* - -", "uniform")) +
      "</ObsFunction><RewardFunction><Func><Var>earned</Var><Parent>act object_0</Parent>"
      "<Parameter type='TBL'><Entry><Instance>* o1</Instance><ValueTable>1</ValueTable></Entry>"
      "</Parameter></Func></RewardFunction></pomdpx>";
  const Model model = readModel({detectedFormat(text), text}, "model");
  EXPECT_THROW((void)initialBelief(model, ""), InvalidArgument);
  EXPECT_EQ(initialBelief(model, "c1,o1").probabilities(),
            std::vector<double>({1.0, 0.0, 0.0, 0.0}));
  EXPECT_EQ(initialBelief(model, "c2,o1").probabilities(),
            std::vector<double>({0.0, 0.0, 0.5, 0.5}));
  EXPECT_EQ(errorOf<InvalidArgument>([&] { (void)initialBelief(model, "c2,o3"); }),
            "the model has no state 'c2,o3'; did you mean 'c2,o1'?");
  // The sizes are checked before the factors are multiplied.
  ReadOptions options;
  options.max_names = 3;
  EXPECT_THROW((void)readModel({"pomdpx", text}, "model", options), ResourceExhausted);
}

TEST(ModelText, FormatIsFoundOutAndSizeChecked)
{
  EXPECT_EQ(checkedModelText("", "discount: 0.9", 100).format, "pomdp");
  EXPECT_EQ(checkedModelText("", "\n <?xml version='1.0'?>", 100).format, "pomdpx");
  EXPECT_EQ(checkedModelText("pomdpx", "x", 100).format, "pomdpx");
  EXPECT_THROW((void)checkedModelText("", "discount: 0.9", 5), ResourceExhausted);
  EXPECT_THROW((void)checkedModelText("", " \n", 5), InvalidArgument);
  EXPECT_THROW((void)checkedModelText("xml", "x", 5), InvalidArgument);
}

}  // namespace
}  // namespace kr3::pomdp
