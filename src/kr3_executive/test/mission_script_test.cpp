// Scripted missions: every file of test/scenarios, and the scripts' own rules.

#include "kr3_executive/mission_script.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_executive/script_runner.hpp"

namespace kr3::executive
{
namespace
{

class Silent : public MissionObserver
{
public:
  void onEvent(const ReportedEvent& /*event*/) override {}
  void onBelief(const ReportedBelief& /*belief*/) override {}
  void onSnapshot(const Snapshot& /*snapshot*/) override {}
};

const std::string kScenarios = std::string(KR3_TEST_DIR) + "/scenarios";

std::vector<std::string> scenarioFiles()
{
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(kScenarios))
  {
    if (entry.path().extension() == ".yaml")
      names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// One for all scripts, so that domains are loaded and policies solved once.
ScriptRunner& runner()
{
  static ScriptRunner shared;
  return shared;
}

class ScenarioTest : public testing::TestWithParam<std::string>
{
};

TEST_P(ScenarioTest, EndsAsExpected)
{
  Silent observer;
  const ScriptReport report = runner().run(kScenarios + "/" + GetParam() + ".yaml", observer);
  for (const auto& difference : report.differences)
    ADD_FAILURE() << difference;
}

INSTANTIATE_TEST_SUITE_P(Files, ScenarioTest, testing::ValuesIn(scenarioFiles()),
                         [](const auto& file) { return file.param; });

TEST(Scenarios, CoverEveryRecoveryInTwoDomains)
{
  std::map<std::string, std::set<std::string>> covered;  // recoveries by domain
  for (const auto& name : scenarioFiles())
  {
    const std::string path = kScenarios + "/" + name + ".yaml";
    const ScriptHeader header = readScriptHeader(path);
    covered[header.domain].insert(
        readScript(path, runner().missionsOf(path, header).domain()).recovery);
  }
  const std::vector<std::string> everywhere{"object not there",
                                            "object elsewhere seen by chance",
                                            "failed grasp",
                                            "false negative in the right room",
                                            "wrong statement by a person",
                                            "person moved the object",
                                            "target room unreachable",
                                            "contradictory observations",
                                            "false positive at the wrong cell"};
  for (const auto& recovery : everywhere)
  {
    EXPECT_EQ(covered["office"].count(recovery), 1U) << recovery;
    EXPECT_EQ(covered["workbench"].count(recovery), 1U) << recovery;
  }
  for (const char* of_places :
       {"object dropped on the way", "robot not where it thought", "blocked door"})
    EXPECT_EQ(covered["office"].count(of_places), 1U) << of_places;
}

TEST(MatchesPattern, TakesAStarForAnyCharacters)
{
  EXPECT_TRUE(matchesPattern("search(rob1, c1, tb1)", "search(*, c1, *)"));
  EXPECT_TRUE(matchesPattern("search(rob1, c1, tb1)", "*"));
  EXPECT_TRUE(matchesPattern("", "*"));
  EXPECT_TRUE(matchesPattern("aXbXc", "a*b*c"));
  EXPECT_TRUE(matchesPattern("abab", "*ab"));
  EXPECT_FALSE(matchesPattern("search(rob1, c1, tb1)", "search(*, c2, *)"));
  EXPECT_FALSE(matchesPattern("abc", "ab"));
  EXPECT_FALSE(matchesPattern("ab", "abc*d"));
}

/// A script for the workbench with one line put in.
std::string withLine(const std::string& line)
{
  return "name: x\ndomain: workbench\ngoal: \"resolved(hum)\"\n" + line +
         "\nexpect: {declared: true}\n";
}

struct BadScript
{
  const char* line;
  const char* message;
};

class BadScriptTest : public testing::TestWithParam<BadScript>
{
};

TEST_P(BadScriptTest, IsRefusedWithItsPlaceAndReason)
{
  const std::string path = kScenarios + "/x.yaml";
  const auto& domain = runner().missionsOf(path, {"workbench", "", 3}).domain();
  try
  {
    static_cast<void>(parseScript(withLine(GetParam().line), "x.yaml", domain));
    FAIL() << "accepted";
  }
  catch (const InvalidArgument& e)
  {
    EXPECT_EQ(std::string(e.what()).rfind("x.yaml:4: ", 0), 0U) << e.what();
    EXPECT_NE(std::string(e.what()).find(GetParam().message), std::string::npos) << e.what();
  }
}

INSTANTIATE_TEST_SUITE_P(
    Lines, BadScriptTest,
    testing::Values(
        BadScript{"colour: red", "unknown key 'colour'"}, BadScript{"seed: -1", "no count"},
        BadScript{"true: [\"cause(hum) = toaster\"]", "toaster"},
        BadScript{"true: [\"opened(psu)\"]", "'psu' has components"},
        BadScript{"true: [\"cause(hum) != psu\"]", "gives a value"},
        BadScript{"interventions: [{force: {blocked: true}}]", "no 'when'"},
        BadScript{"interventions: [{when: {action: \"unscrw(*)\"}}]", "matches no action"},
        BadScript{"interventions: [{when: {occurrence: 0}}]", "counts from 1"},
        BadScript{"interventions: [{when: {action: \"unscrew(*)\"}, force: {outcome: broken}}]",
                  "'broken' is no outcome of unscrew"},
        BadScript{"interventions: [{when: {action: \"probe(*)\"}, force: {observe: [a, b]}}]",
                  "2 values, expected 1"},
        BadScript{"interventions: [{when: {}, before: {tell: [{statement: \"resolved(rust)\"}]}}]",
                  "rust"},
        BadScript{
            "interventions: [{when: {}, after: {sightings: [{literal: opened(preamp), confidence: "
            "1.5}]}}]",
            "confidence outside (0, 1]"},
        BadScript{"limits: {max_patience: 3}", "unknown key 'max_patience'"}));

TEST(MissionScript, WithoutExpectationsOrGoalIsRefused)
{
  const std::string path = kScenarios + "/x.yaml";
  const auto& domain = runner().missionsOf(path, {"workbench", "", 3}).domain();
  try
  {
    static_cast<void>(parseScript("name: x\ndomain: workbench\n", "x.yaml", domain));
    FAIL() << "accepted";
  }
  catch (const InvalidArgument& e)
  {
    EXPECT_NE(std::string(e.what()).find("no 'expect'"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("no 'goal'"), std::string::npos) << e.what();
  }
}

TEST(MissionScript, OfAnotherDomainOrOfNoneIsRefused)
{
  ScriptRunner of_office(std::string(KR3_DOMAINS_DIR) + "/office");
  EXPECT_THROW(of_office.missionsOf("x.yaml", {"workbench", "", 3}), InvalidArgument);
  EXPECT_THROW(runner().missionsOf(kScenarios + "/x.yaml", {"nowhere", "", 3}), InvalidArgument);
}

/// Expectations that the mission does not meet are differences, each of its kind.
TEST(Differences, NameWhatWasExpectedAndWhatWas)
{
  TrialResult result;
  result.mission.achieved = true;
  result.mission.reason = "because";
  result.history = {{reasoner::RecordKind::kInitially, "a = b"},
                    {reasoner::RecordKind::kHappened, "go(x)", true, 0}};
  MissionTrace trace;
  trace.high_level = {{"go(x)", "achieved"}};
  trace.low_level = {"go(x1)", "look(x1)"};
  trace.explanations = {{"moved(y) at 0"}};
  trace.num_initial_records = 1;

  Expectations fine;
  fine.declared = true;
  fine.goal_true = false;
  fine.reason = "be*";
  fine.high_level = {{{"go(*)", "achieved"}}};
  fine.low_level = {"go(*)", "look(*)"};
  fine.never = {"take(*)"};
  fine.history = {{"hpd(go(x), 0)"}};
  fine.explanations = {{{"moved(*) at 0"}}};
  fine.reopened = 0;
  fine.taken_back = std::vector<std::string>{};
  EXPECT_EQ(differences(fine, result, trace), std::vector<std::string>{});

  const auto failsWith = [&](auto change) {
    Expectations wrong;
    change(wrong);
    EXPECT_EQ(differences(wrong, result, trace).size(), 1U);
  };
  failsWith([](auto& e) { e.declared = false; });
  failsWith([](auto& e) { e.goal_true = true; });
  failsWith([](auto& e) { e.reason = "why"; });
  failsWith([](auto& e) { e.high_level = {{{"go(x)", "refuted"}}}; });
  failsWith([](auto& e) { e.high_level = std::vector<ExpectedAction>{}; });
  failsWith([](auto& e) { e.low_level = {"look(*)", "go(*)"}; });
  failsWith([](auto& e) { e.never = {"look(*)"}; });
  failsWith([](auto& e) { e.history = {{"hpd(go(x), 0)", "hpd(go(y), 1)"}}; });
  failsWith([](auto& e) { e.recorded = {"hpd(go(y), *)"}; });
  failsWith([](auto& e) { e.not_recorded = {"hpd(go(x), *)"}; });
  failsWith([](auto& e) { e.explanations = std::vector<std::vector<std::string>>{}; });
  failsWith([](auto& e) { e.reopened = 1; });
  failsWith([](auto& e) { e.taken_back = {{"obs(*)"}}; });
  failsWith([](auto& e) { e.max_low_level_actions = 1; });
}

}  // namespace
}  // namespace kr3::executive
