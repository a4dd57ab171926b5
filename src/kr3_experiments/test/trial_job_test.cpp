#include "trial_job.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

namespace
{

using namespace kr3::experiments;
using testing::ElementsAre;
using testing::HasSubstr;

std::string problemOf(const std::string& line)
{
  try
  {
    static_cast<void>(readTrialJob(line));
  }
  catch (const kr3::InvalidArgument& error)
  {
    return error.what();
  }
  return "none";
}

TEST(TrialJob, SaysEverythingThatARowDependsOn)
{
  const TrialJob job = readTrialJob(
      R"({"job": "a7", "domain": "d", "method": "pomdp2", "bias": 0.7, "flat_backups": 50,
          "max_ll_actions": 9, "models": "learned.yaml", "world_models": "models.yaml",
          "trials": [{"seed": 3, "truths": ["f = 1"], "initially": ["g = 2"]}, {"seed": 4}]})");
  EXPECT_EQ(job.id, "a7");
  EXPECT_EQ(job.config.method, kr3::executive::Method::kPomdp2);
  EXPECT_EQ(job.config.baseline.default_probability, 0.7);
  EXPECT_EQ(job.config.baseline.budget.max_backups, 50U);
  EXPECT_EQ(job.limits.max_ll_actions, 9U);
  EXPECT_EQ(job.config.models, "learned.yaml");
  EXPECT_EQ(job.config.world_models, "models.yaml");
  ASSERT_EQ(job.trials.size(), 2U);
  EXPECT_THAT(job.trials[0].truths, ElementsAre("f = 1"));
  EXPECT_THAT(job.trials[0].initially, ElementsAre("g = 2"));
}

TEST(TrialJob, WhatTheRobotIsToldReplacesTheScenario)
{
  using kr3::reasoner::Record;
  using kr3::reasoner::RecordKind;
  const auto description = kr3::reasoner::parseDescription(
      "sorts\n  place = {kitchen, office}.\n  thing = {cup, pen}.\n"
      "fluents\n  inertial loc(thing) : place.  inertial lit(place).\n",
      "places.kr3");
  const std::vector<Record> of_scenario{{RecordKind::kInitially, "loc(cup) = kitchen"},
                                        {RecordKind::kInitially, "loc(pen) = kitchen"},
                                        {RecordKind::kInitially, "lit(kitchen)"},
                                        {RecordKind::kObserved, "lit(office)"}};
  const auto told = [&](std::vector<std::string> initially) {
    std::vector<std::string> texts;
    const kr3::experiments::Trial trial{1, {}, std::move(initially)};
    for (const auto& record : kr3::experiments::initialRecords(of_scenario, trial, description))
      texts.push_back(toString(record));
    return texts;
  };
  EXPECT_THAT(told({"loc(pen) = office", "-lit(kitchen)"}),
              ElementsAre("init(loc(cup) = kitchen, true)", "obs(lit(office), true, 0)",
                          "init(loc(pen) = office, true)", "init(lit(kitchen), false)"));
  EXPECT_EQ(told({}).size(), of_scenario.size());
  EXPECT_THROW(told({"loc(pen) = cellar"}), kr3::InvalidArgument);
  EXPECT_THROW(told({"loc(pen) != office"}), kr3::InvalidArgument);
  EXPECT_THROW(told({"loc(pen) = office", "loc(pen) = kitchen"}), kr3::InvalidArgument);
  EXPECT_THROW(told({"-lit(office)"}), kr3::InvalidArgument);
}

TEST(TrialJob, RefusesNumbersThatNoSolverEndsWith)
{
  const auto problem = [](const std::string& entry) {
    return problemOf(R"({"job": "1", "domain": "d", "trials": [{"seed": 1}], )" + entry + "}");
  };
  EXPECT_THAT(problem(R"("precision": 0)"),
              HasSubstr("'precision': found 0, expected a number above 0"));
  EXPECT_THAT(problem(R"("flat_precision": -1)"), HasSubstr("expected a number above 0"));
  EXPECT_THAT(problem(R"("threshold": 0.3)"),
              HasSubstr("'threshold': found 0.3, expected a number in (0.5, 1)"));
  EXPECT_EQ(problem(R"("threshold": 0.9, "precision": 0.5)"), "none");
}

TEST(TrialJob, SolversHaveCountedWorkOnly)
{
  const TrialJob job = readTrialJob(R"({"job": "1", "domain": "d", "trials": [{"seed": 1}]})");
  EXPECT_EQ(job.config.driver.budget.time_s, 0.0);
  EXPECT_EQ(job.config.baseline.budget.time_s, 0.0);
}

TEST(TrialJob, SharesWhatIsPreparedWhateverTheTrials)
{
  const auto configuration = [](const std::string& rest) {
    return readTrialJob(R"({"job": "1", "domain": "d", )" + rest + "}").configuration;
  };
  const std::string first = configuration(R"("trials": [{"seed": 1}])");
  EXPECT_EQ(first, configuration(R"("max_hl_actions": 3, "trials": [{"seed": 2}])"));
  EXPECT_NE(first, configuration(R"("method": "pa_star", "trials": [{"seed": 1}])"));
  EXPECT_NE(first, configuration(R"("world_models": "w.yaml", "trials": [{"seed": 1}])"));
}

TEST(TrialJob, NamesWhatIsWrong)
{
  EXPECT_THAT(problemOf("{"), HasSubstr("no JSON"));
  EXPECT_THAT(problemOf("[]"), HasSubstr("expected an object"));
  EXPECT_THAT(problemOf(R"({"job": "1", "domain": "d"})"), HasSubstr("'trials' is missing"));
  EXPECT_THAT(problemOf(R"({"job": "1", "domain": "d", "trials": []})"), HasSubstr("'trials'"));
  EXPECT_THAT(problemOf(R"({"job": "1", "domain": "d", "trials": [{"seed": -1}]})"),
              HasSubstr("'seed': found -1"));
  const auto with = [](const std::string& entry) {
    return R"({"job": "1", "domain": "d", "trials": [{"seed": 1}], )" + entry + "}";
  };
  EXPECT_THAT(problemOf(with(R"("bias": 1.5)")), HasSubstr("'bias': found 1.5"));
  EXPECT_THAT(problemOf(with(R"("colour": 1)")), HasSubstr("unknown key 'colour'"));
  EXPECT_THAT(problemOf(with(R"("method": "magic")")), HasSubstr("pa_star"));
  EXPECT_THAT(problemOf(with(R"("goal": 7)")), HasSubstr("'goal': found 7"));
  EXPECT_THAT(problemOf(with(R"("world_models": 7)")), HasSubstr("'world_models': found 7"));
}

}  // namespace
