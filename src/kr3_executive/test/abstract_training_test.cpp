// The training phase in the abstract simulator: trials tell the models' chances.

#include "kr3_executive/abstract_training.hpp"

#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <kr3_common/error.hpp>
#include <kr3_refinement/low_level_files.hpp>

#include "kr3_executive/abstract_mission.hpp"

namespace kr3::executive
{
namespace
{

using testing::HasSubstr;

constexpr int kRounds = 600;
constexpr double kDeviations = 4.0;  // of a binomial share: a false alarm once in 16000 draws

std::vector<TrainingAttempt> trained(const AbstractMissions& missions, std::uint64_t seed,
                                     int rounds)
{
  AbstractTraining training(missions.domain(), missions.worldModels(), seed);
  std::vector<TrainingAttempt> attempts;
  for (int i = 0; i < rounds; ++i)
  {
    auto round = training.round();
    attempts.insert(attempts.end(), round.begin(), round.end());
  }
  return attempts;
}

AbstractMissions missionsOf(const std::string& domain)
{
  AbstractMissionConfig config;
  config.components_per_whole = 3;
  return {std::string(KR3_DOMAINS_DIR) + "/" + domain, config};
}

void expectShare(double count, double total, double probability, const std::string& what)
{
  ASSERT_GT(total, 0.0) << what;
  const double deviation = std::sqrt(probability * (1.0 - probability) / total);
  EXPECT_NEAR(count / total, probability, kDeviations * deviation + 1e-9) << what;
}

class Training : public testing::TestWithParam<const char*>
{
};

TEST_P(Training, TellsTheChancesOfTheWorld)
{
  const AbstractMissions missions = missionsOf(GetParam());
  const refinement::Models& models = missions.worldModels();
  // Per ground model, since classes of arguments have numbers of their own.
  std::map<const refinement::OutcomeModel*, std::map<std::string, double>> outcomes;
  std::map<std::pair<const refinement::ObservationModel*, bool>, std::pair<double, double>> said;
  for (const auto& attempt : trained(missions, 7, kRounds))
  {
    const auto& action = models.actions.at(attempt.action.symbol);
    if (!attempt.outcome.empty())
      outcomes[&action.outcomesOf(attempt.action.arguments)][attempt.outcome] += 1.0;
    for (const auto& one : attempt.observed)
    {
      auto& count = said[{&action.observationOf(one.fluent, attempt.action.arguments), one.truth}];
      count.first += one.said ? 1.0 : 0.0;
      count.second += 1.0;
    }
  }
  EXPECT_FALSE(said.empty());
  for (const auto& [sensor, count] : said)
    expectShare(count.first, count.second,
                sensor.second ? sensor.first->true_positive : sensor.first->false_positive,
                sensor.second ? "true positives" : "false positives");
  for (const auto& [model, counts] : outcomes)
  {
    // Labels of different laws never compete with each other: those of the office are of one.
    double total = 0.0;
    double weights = 0.0;
    for (const auto& [label, count] : counts)
    {
      total += count;
      weights += model->probabilities.at(label);
    }
    if (weights > 1.0 + 1e-9)
      continue;
    for (const auto& [label, count] : counts)
      expectShare(count, total, model->probabilities.at(label) / weights, label);
  }
}

INSTANTIATE_TEST_SUITE_P(Domains, Training,
                         testing::Values("office", "workbench", "warehouse", "waterworks"));

TEST(AbstractTraining, TriesEveryActionOnBothSidesOfTheTruth)
{
  const AbstractMissions missions = missionsOf("office");
  std::map<std::string, int> trials;
  for (const auto& attempt : trained(missions, 3, 20))
  {
    std::string kind = attempt.action.symbol;
    for (const auto& one : attempt.observed)
      kind += one.truth ? ", so" : ", not so";
    ++trials[kind];
  }
  const std::map<std::string, int> expected{
      {"grasp", 20}, {"move", 20}, {"putdown", 20}, {"search, not so", 20}, {"search, so", 20}};
  EXPECT_EQ(trials, expected);
}

TEST(AbstractTraining, MoreTrialsBeginWithTheSame)
{
  const AbstractMissions missions = missionsOf("office");
  const auto few = trained(missions, 5, 10);
  const auto many = trained(missions, 5, 20);
  const auto others = trained(missions, 6, 10);
  bool differs = false;
  for (std::size_t i = 0; i < few.size(); ++i)
  {
    EXPECT_EQ(few[i].action.text, many[i].action.text);
    EXPECT_EQ(few[i].outcome, many[i].outcome);
    EXPECT_EQ(few[i].duration_s, many[i].duration_s);
    differs = differs || few[i].action.text != others[i].action.text;
  }
  EXPECT_TRUE(differs);
}

TEST(AbstractTraining, DurationsAreThoseOfTheDistance)
{
  const AbstractMissions missions = missionsOf("office");
  const auto& cost = missions.worldModels().actions.at("move").cost;
  for (const auto& attempt : trained(missions, 2, 20))
  {
    EXPECT_EQ(attempt.metres.has_value(), attempt.action.symbol == "move");
    if (attempt.metres)
    {
      EXPECT_DOUBLE_EQ(attempt.duration_s, cost.base_s + cost.per_metre_s * *attempt.metres);
    }
  }
}

TEST(AbstractTraining, AnActionThatIsNeverPossibleIsNamed)
{
  const auto high_level = reasoner::parseDescription(
      "sorts\n  place = {a, b}.\n  robot = {r}.\nfluents\n  inertial loc(robot) : place.\n"
      "actions\n  move(robot, place).\naxioms\n  move(R, P) causes loc(R) = P.\n"
      "  impossible move(R, P) if loc(R) = P.\n  impossible move(R, P) if loc(R) != P.\n",
      "domain.kr3");
  const auto refined = refinement::parseRefinementText(
      "magnify place into cell by part_of.\nstatics\n  neighbor(cell, cell).\n", "refinement.kr3",
      high_level);
  const refinement::LowLevelDomain domain(high_level, refined,
                                          refinement::gridMap({"a", "b"}, 2, 1.0));
  const auto models = refinement::parseModels(
      "discount: 0.9\nthreshold: 0.85\nrewards: {success: 10, given_up: 2, wrong_finish: -10}\n"
      "actions:\n  move(R, P):\n    cost: {base_s: 1, impossible_s: 1}\n",
      "models.yaml", domain);
  AbstractTraining training(domain, models, 1);
  try
  {
    static_cast<void>(training.round());
    FAIL();
  }
  catch (const FailedPrecondition& error)
  {
    EXPECT_THAT(error.what(), HasSubstr("move is possible"));
  }
}

}  // namespace
}  // namespace kr3::executive
