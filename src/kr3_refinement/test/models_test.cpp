#include "kr3_refinement/models.hpp"

#include "fixtures.hpp"

namespace kr3::refinement
{
namespace
{

using test::expectError;

TEST(Models, ReadsTheDomainsOfTheRepository)
{
  const Models office = test::office().models;
  EXPECT_DOUBLE_EQ(office.actions.at("move").outcomes.probabilities.at("slipped"), 0.05);
  EXPECT_EQ(office.actions.at("move").parameters, (std::vector<std::string>{"R", "C"}));
  EXPECT_EQ(toString(*office.actions.at("move").cost.from), "loc(R)");
  EXPECT_DOUBLE_EQ(office.actions.at("search").observations.at("loc").true_positive, 0.9);
  const Models workbench = test::workbench().models;
  EXPECT_EQ(workbench.actions.at("replace").outcomes.source, ModelSource::kLearned);
  EXPECT_EQ(workbench.actions.at("replace").outcomes.counts.at("dead_part"), 2U);
}

TEST(Models, SaysThatAFileIsMissing)
{
  const test::Domain office = test::office();
  expectError(ErrorCode::kUnavailable, "nowhere.yaml",
              [&] { (void)readModels("nowhere.yaml", office.low_level.description()); });
}

class BadModels : public ::testing::Test
{
protected:
  /// Replaces a part of the office's models by another and expects the error.
  void expectProblem(const std::string& from, const std::string& to, const std::string& part)
  {
    std::string text = test::textOf(test::domainFile("office", "models.yaml"));
    const std::size_t position = text.find(from);
    ASSERT_NE(position, std::string::npos) << from;
    text.replace(position, from.size(), to);
    expectError(ErrorCode::kInvalidArgument, part,
                [&] { (void)parseModels(text, "models.yaml", office_.low_level.description()); });
  }

  test::Domain office_ = test::office();
};

TEST_F(BadModels, AreRefusedWithFileAndLine)
{
  expectProblem("discount: 0.98", "discount: 2", "models.yaml:4: discount: found '2'");
  expectProblem("discount: 0.98", "discuont: 0.98", "unknown key 'discuont'");
  expectProblem("  success: 100 ", "  sucess: 100 ", "rewards: unknown key 'sucess'");
  expectProblem("slipped: 0.05}", "slipped: 0.15}", "the probabilities sum to 1.1");
  expectProblem("slipped: 0.05}", "slid: 0.05}",
                "unknown key 'slid', expected one of 'reached', 'slipped'");
  expectProblem("source: hand-written", "source: guessed",
                "source 'guessed', expected 'learned' or 'hand-written'");
  expectProblem("source: hand-written", "source: learned", "learned without counts");
  expectProblem("  move(R, C):", "  fly(R, C):", "'fly(R, C)' is no action of the low level");
  expectProblem("  move(R, C):", "  move(R):", "'move(R)' has 1 parameters, expected 2");
  expectProblem("      loc: exact ", "      loc: vague ",
                "found 'vague', expected 'exact' or a map");
  expectProblem("true_positive: 0.90", "true_positive: 1.90", "true_positive: found '1.90'");
  expectProblem("from: loc(R)", "from: loc(X)", "expected a fluent over the action's parameters");
  expectProblem("to: C}", "to: D}", "distance to 'D'");
  expectProblem("cost: {base_s: 3.0, impossible_s: 12.0}", "cost: {base_s: 3.0}",
                "putdown, cost: found no impossible_s");
  expectProblem("    observations:\n      in_hand: exact       #", "    #",
                "found no observation model of 'in_hand'");
  expectProblem("rewards: ", "rewards: [", "models.yaml:");
}

TEST_F(BadModels, AreReportedAllAtOnce)
{
  const std::string text = "discount: 7\nthreshold: 0.1\nactions: {}\n";
  for (const char* part :
       {"models.yaml:1:", "models.yaml:2:", "found none for 'grasp'", "found none for 'search'"})
  {
    expectError(ErrorCode::kInvalidArgument, part,
                [&] { (void)parseModels(text, "models.yaml", office_.low_level.description()); });
  }
}

}  // namespace
}  // namespace kr3::refinement
