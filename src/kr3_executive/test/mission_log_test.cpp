// What enters a mission and what it decides, as an observer is told.

#include "kr3_executive/mission_log.hpp"

#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "kr3_executive/abstract_mission.hpp"

namespace kr3::executive
{
namespace
{

class Log : public MissionObserver
{
public:
  void onEvent(const ReportedEvent& /*event*/) override {}
  void onBelief(const ReportedBelief& /*belief*/) override {}
  void onSnapshot(const Snapshot& /*snapshot*/) override {}
  void onInput(const Input& input) override { inputs.push_back(input); }
  void onDecision(const ReportedDecision& decision) override { decisions.push_back(decision); }

  [[nodiscard]] std::vector<std::string> lines() const
  {
    std::vector<std::string> lines;
    for (const auto& decision : decisions)
    {
      lines.push_back(decision.kind);
      for (const auto& detail : decision.details)
        lines.back() += " | " + detail;
    }
    return lines;
  }

  std::vector<Input> inputs;
  std::vector<ReportedDecision> decisions;
};

MissionResult runOffice(std::uint64_t seed, Log& log)
{
  AbstractMissionConfig config;
  config.driver.budget = {0.5, 0.0, 400};
  config.components_per_whole = 2;
  AbstractMissions missions(std::string(KR3_DOMAINS_DIR) + "/office", config);
  return missions.run(missions.scenario().goal, {"loc(tb1) = aux_library"}, seed, log).mission;
}

TEST(MissionLog, HoldsEveryInputOnceInOrder)
{
  Log log;
  const MissionResult result = runOffice(1, log);
  ASSERT_FALSE(log.inputs.empty());
  ASSERT_TRUE(std::holds_alternative<MissionBegun>(log.inputs.front()));
  const auto& begun = std::get<MissionBegun>(log.inputs.front());
  EXPECT_FALSE(begun.initial.empty());
  EXPECT_TRUE(begun.knowledge.history.empty());
  EXPECT_EQ(log.inputs.size(), 1U + result.ll_actions);  // nothing else came from outside
  std::size_t executed = 0;
  for (const auto& decision : log.decisions)
  {
    if (decision.kind != "low_level_action")
      continue;
    ++executed;
    const auto& ended = std::get<SkillEnded>(log.inputs.at(executed));
    EXPECT_EQ(ended.action.text, decision.details.front());
  }
  EXPECT_EQ(executed, result.ll_actions);
}

TEST(MissionLog, CountsDecisionsAndEndsWithTheResult)
{
  Log log;
  static_cast<void>(runOffice(1, log));
  for (std::size_t i = 0; i < log.decisions.size(); ++i)
    EXPECT_EQ(log.decisions[i].sequence, i);
  EXPECT_EQ(log.decisions.front().kind, "add_records");
  EXPECT_EQ(log.decisions.back().kind, "finish");
  EXPECT_EQ(log.decisions.back().details.front(), "achieved");
}

TEST(MissionLog, TheSameInputsGiveTheSameDecisions)
{
  Log first;
  Log second;
  Log other;
  static_cast<void>(runOffice(1, first));
  static_cast<void>(runOffice(1, second));
  static_cast<void>(runOffice(2, other));
  EXPECT_EQ(first.lines(), second.lines());
  EXPECT_NE(first.lines(), other.lines());
}

TEST(MissionLog, NamesWhatAPlanRestsOn)
{
  State state;
  state.plan =
      CostedPlan{{{"loc(tb1) = office"}, {{"grasp(rob1, tb1)"}, {"move(rob1, kitchen)"}}}, 1.0};
  const auto decision = reported(RequestPolicy{"grasp(rob1, tb1)", false}, state);
  EXPECT_EQ(decision.kind, "request_policy");
  EXPECT_EQ(decision.details,
            (std::vector<std::string>{"grasp(rob1, tb1)", "assuming loc(tb1) = office",
                                      "then move(rob1, kitchen)"}));
}

}  // namespace
}  // namespace kr3::executive
