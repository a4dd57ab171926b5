// Whole missions in process: the real reasoner, refinement and solver, a simulated world.

#include "kr3_executive/abstract_mission.hpp"

#include <cstdio>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_executive/knowledge_file.hpp"

namespace kr3::executive
{
namespace
{

class Events : public MissionObserver
{
public:
  void onEvent(const ReportedEvent& event) override { events.push_back(event); }
  void onBelief(const ReportedBelief& belief) override
  {
    for (const auto& [fluent, values] : belief.fluents)
    {
      double sum = 0.0;
      for (const auto& value : values)
        sum += value.second;
      EXPECT_NEAR(sum, 1.0, 1e-9) << fluent;
    }
  }
  void onSnapshot(const Snapshot& snapshot) override { last = snapshot; }

  [[nodiscard]] std::string text(EventKind kind) const
  {
    for (const auto& event : events)
    {
      if (event.kind == kind)
        return event.narration.text;
    }
    return {};
  }

  std::vector<ReportedEvent> events;
  Snapshot last;
};

/// Counted work only, so that a run repeats exactly.
AbstractMissionConfig config()
{
  AbstractMissionConfig config;
  config.driver.budget = {0.5, 0.0, 400};
  config.components_per_whole = 3;
  return config;
}

const std::string kOffice = std::string(KR3_DOMAINS_DIR) + "/office";
const std::string kWorkbench = std::string(KR3_DOMAINS_DIR) + "/workbench";

class OfficeMission : public testing::TestWithParam<const char*>
{
};

TEST_P(OfficeMission, BringsTheBookFromWhereverItIs)
{
  AbstractMissions missions(kOffice, config());
  Events events;
  const std::string goal = missions.scenario().goal;
  const auto result =
      missions.run(goal, {missions.targetFluent(goal) + " = " + GetParam()}, 1, events);
  EXPECT_TRUE(result.mission.achieved) << result.mission.reason;
  EXPECT_TRUE(result.goal_is_true);
  EXPECT_EQ(events.events.back().kind, EventKind::kDone);
}

INSTANTIATE_TEST_SUITE_P(Places, OfficeMission,
                         testing::Values("main_library", "aux_library", "office", "kitchen",
                                         "corridor", "study_corner"));

/// The belief after the first look of the first grasp.
class FirstLook : public MissionObserver
{
public:
  void onEvent(const ReportedEvent& /*event*/) override {}
  void onBelief(const ReportedBelief& belief) override
  {
    const auto where = belief.fluents.find("loc(tb1)");
    if (!elsewhere && where != belief.fluents.end())
      elsewhere = where->second.at(refinement::kElsewhere);
  }
  void onSnapshot(const Snapshot& /*snapshot*/) override {}

  std::optional<double> elsewhere;
};

TEST(AbstractMission, ThePlaceThatIsLeftIsNotRefutedByTheNumberOfTheOthers)
{
  AbstractMissions missions(kOffice, config());
  MissionSetup setup;
  setup.goal = "in_hand(rob1, tb1)";
  setup.truths = {"loc(tb1) = corridor"};
  setup.initial_records = missions.scenario().initial_records;
  for (const char* place : {"office", "main_library", "aux_library", "kitchen", "study_corner"})
  {
    setup.initial_records.push_back(
        {reasoner::RecordKind::kObserved, std::string("loc(tb1) = ") + place, false, 0, 0.7});
  }
  FirstLook look;
  static_cast<void>(missions.run(setup, look));
  // The first look sees the book. Its likelihood ratio makes 0.13 of the prior odds 1, and 0.43 of
  // 0.7^5, the product of all that was refuted.
  ASSERT_TRUE(look.elsewhere.has_value());
  EXPECT_LE(*look.elsewhere, 0.2);

  setup.truths = {"loc(tb1) = kitchen"};
  Events events;
  static_cast<void>(missions.run(setup, events));
  const std::string text = events.text(EventKind::kDiagnosis);
  EXPECT_NE(text.find("expected tb1 in corridor (every other value was observed to be false)"),
            std::string::npos)
      << text;
}

TEST(AbstractMission, SaysWhyItExpectsTheBookElsewhere)
{
  AbstractMissions missions(kOffice, config());
  Events events;
  static_cast<void>(missions.run(missions.scenario().goal, {"loc(tb1) = aux_library"}, 1, events));
  const std::string text = events.text(EventKind::kDiagnosis);
  EXPECT_NE(text.find("expected tb1 in main_library (default d1"), std::string::npos) << text;
  EXPECT_NE(text.find("tb1 is an exception to d1"), std::string::npos) << text;
  EXPECT_NE(text.find("now expected tb1 in aux_library (default d2"), std::string::npos) << text;
}

TEST(AbstractMission, RepeatsExactlyWithItsSeed)
{
  std::vector<std::string> runs[2];
  for (auto& run : runs)
  {
    AbstractMissions missions(kOffice, config());
    Events events;
    static_cast<void>(missions.run(missions.scenario().goal, {"loc(tb1) = office"}, 5, events));
    for (const auto& event : events.events)
    {
      if (event.kind == EventKind::kLowLevelAction)
        run.push_back(event.narration.text);
    }
  }
  EXPECT_FALSE(runs[0].empty());
  EXPECT_EQ(runs[0], runs[1]);
}

TEST(AbstractMission, NothingIsDoneForAGoalThatHolds)
{
  AbstractMissions missions(kOffice, config());
  Events events;
  const auto result = missions.run("loc(rob1) = office", {}, 1, events);
  EXPECT_TRUE(result.mission.achieved);
  EXPECT_EQ(result.mission.hl_actions, 0U);
}

TEST(AbstractMission, LooksBeforeItDeclaresAGoalThatOnlyADefaultEntails)
{
  AbstractMissions missions(kOffice, config());
  for (const char* place : {"main_library", "aux_library"})
  {
    Events events;
    const auto result =
        missions.run("loc(tb1) = main_library", {std::string("loc(tb1) = ") + place}, 2, events);
    EXPECT_TRUE(result.mission.achieved && result.goal_is_true)
        << place << ": " << result.mission.reason;
    const std::string plan = events.text(EventKind::kPlan);
    EXPECT_NE(plan.find("to make sure that tb1 in main_library (default d1"), std::string::npos)
        << plan;
  }
}

TEST(AbstractMission, TrustsADefaultThatIsHeldForKnowledge)
{
  auto trusting = config();
  trusting.driver.default_probability = 0.9;  // above the threshold
  AbstractMissions missions(kOffice, trusting);
  Events events;
  const auto result =
      missions.run("loc(tb1) = main_library", {"loc(tb1) = aux_library"}, 2, events);
  EXPECT_TRUE(result.mission.achieved);
  EXPECT_FALSE(result.goal_is_true);
  EXPECT_EQ(result.mission.hl_actions, 0U);
}

TEST(AbstractMission, AnUnknownObjectStartsNothing)
{
  AbstractMissions missions(kOffice, config());
  Events events;
  EXPECT_THROW(static_cast<void>(missions.run("loc(tb9) = office", {}, 1, events)),
               InvalidArgument);
  EXPECT_TRUE(events.events.empty());
}

TEST(AbstractMission, AnUnreachableGoalEndsWithAReason)
{
  AbstractMissions missions(kOffice, config());
  Events events;
  const auto result = missions.run("in_hand(rob1, tb1) and in_hand(rob1, mug1)", {}, 1, events);
  EXPECT_EQ(result.mission.code, ErrorCode::kOk);
  EXPECT_FALSE(result.mission.achieved);
  EXPECT_FALSE(result.mission.reason.empty());
}

TEST(AbstractMission, AnotherDomainNeedsNoOtherCode)
{
  AbstractMissions missions(kWorkbench, config());
  for (const char* device : {"psu", "amplifier"})
  {
    Events events;
    const auto result =
        missions.run("resolved(hum)", {std::string("cause(hum) = ") + device}, 3, events);
    EXPECT_TRUE(result.mission.achieved && result.goal_is_true)
        << device << ": " << result.mission.reason;
  }
}

TEST(KnowledgeFile, GivesBackWhatWasWritten)
{
  const std::string path = testing::TempDir() + "/knowledge_file_test.json";
  std::remove(path.c_str());
  EXPECT_FALSE(readKnowledge(path).has_value());
  Knowledge knowledge;
  knowledge.history.push_back(
      {reasoner::RecordKind::kObserved, "loc(tb1) = office", false, 3, 0.875, "robot"});
  knowledge.memory["loc(tb1)"] = {{{"office_c0", 0.25}, {"elsewhere", 0.75}}, "office"};
  writeKnowledge(path, knowledge);
  const auto read = readKnowledge(path);
  ASSERT_TRUE(read.has_value());
  ASSERT_EQ(read->history.size(), 1U);
  EXPECT_EQ(reasoner::toString(read->history[0]), reasoner::toString(knowledge.history[0]));
  EXPECT_EQ(read->memory.at("loc(tb1)").values, knowledge.memory.at("loc(tb1)").values);
  std::remove(path.c_str());
}

}  // namespace
}  // namespace kr3::executive
