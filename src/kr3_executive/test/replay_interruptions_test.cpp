// What comes from outside while a mission runs, and what fails on the way, happens again at the
// same place in a replay.

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <kr3_common/error.hpp>

#include "kr3_executive/abstract_world.hpp"
#include "kr3_executive/driver.hpp"
#include "kr3_executive/in_process.hpp"
#include "kr3_executive/replay.hpp"

namespace kr3::executive
{
namespace
{

const std::string kOffice = std::string(KR3_DOMAINS_DIR) + "/office";
const std::string kGoal = "loc(tb1) = study_corner and not in_hand(rob1, tb1)";

using Meddle = std::function<void(std::size_t number)>;

/// The abstract world, and what somebody does before its nth action.
class MeddledWorld : public LowLevelExecutor
{
public:
  explicit MeddledWorld(AbstractWorld& world) : world_(world) {}
  LowLevelResult execute(const LowLevelAction& action, const FluentLookup& believed,
                         const std::atomic<bool>& cancel) override
  {
    ++number_;
    if (meddle)
      meddle(number_);
    if (cancel)
      throw Cancelled("cancelled");
    return world_.execute(action, believed, cancel);
  }
  Meddle meddle;

private:
  AbstractWorld& world_;
  std::size_t number_ = 0;
};

class FailingReasoner : public InProcessReasoner
{
public:
  using InProcessReasoner::InProcessReasoner;
  reasoner::Diagnosis diagnose() override
  {
    if (fails)
      throw Unavailable("the reasoner does not answer");
    if (diagnoses_late)
      throw DeadlineExceeded("diagnosis took longer than its time limit");
    return InProcessReasoner::diagnose();
  }
  bool fails = false;
  bool diagnoses_late = false;
};

class ForgetfulPolicies : public InProcessPolicyServer
{
public:
  std::size_t actionAt(const std::string& policy_id, const pomdp::Belief& belief) override
  {
    if (++questions == forgets_at)
      throw NotFound("policy '" + policy_id + "'");
    return InProcessPolicyServer::actionAt(policy_id, belief);
  }
  std::size_t questions = 0;
  std::size_t forgets_at = 0;
};

/// A mission in the office with the book in the auxiliary library; meddled with, and recorded.
struct Stage
{
  Stage()
    : files(readDomainFiles(kOffice + "/domain.kr3", kOffice + "/refinement.kr3",
                            kOffice + "/models.yaml", kOffice + "/bindings.yaml",
                            refinement::gridMap({"office", "main_library", "aux_library", "kitchen",
                                                 "corridor", "study_corner"},
                                                2, 2.0)))
    , loaded(load(files))
    , reasoner(loaded.domain->highLevel(), {})
    , simulated(*loaded.domain, loaded.models, 1)
    , world(simulated)
    , narrator(loaded.bindings.phrases())
    , recorder(
          files, {}, [this] { return simulated.now(); },
          [this](const RecordedInput& input) { inputs.push_back(input); })
    , driver(
          *loaded.domain, loaded.models, narrator, reasoner, policies, world, recorder,
          [this] { return simulated.now(); }, configuration())
  {
    simulated.reset({{"loc(rob1)", "office"}, {"loc(tb1)", "aux_library"}});
  }

  static DriverConfig configuration()
  {
    DriverConfig config;
    config.budget = {0.5, 0.0, 300};
    return config;
  }

  MissionResult run(double time_limit_s = 0.0)
  {
    const reasoner::Record start{
        reasoner::RecordKind::kObserved, "loc(rob1) = office", true, 0, 1.0, "robot"};
    return driver.achieve(kGoal, {start}, driver.config().limits, time_limit_s);
  }

  void expectSame()
  {
    const ReplayResult result = replay(readMission(inputs), {});
    const ReplayedDecision* difference = result.firstDifference();
    EXPECT_TRUE(result.isSame()) << "at input " << difference->sequence << ": "
                                 << (difference->recorded ? difference->recorded->kind : "nothing")
                                 << ", now "
                                 << (difference->replayed ? difference->replayed->kind : "nothing");
    EXPECT_EQ(result.end, ReplayEnd::kMissionEnded) << result.reason;
  }

  [[nodiscard]] std::size_t count(InputKind kind) const
  {
    std::size_t number = 0;
    for (const auto& input : inputs)
      number += input.kind == kind ? 1 : 0;
    return number;
  }

  DomainFiles files;
  LoadedDomain loaded;
  FailingReasoner reasoner;
  ForgetfulPolicies policies;
  AbstractWorld simulated;
  MeddledWorld world;
  Narrator narrator;
  std::vector<RecordedInput> inputs;
  MissionRecorder recorder;
  MissionDriver driver;
};

TEST(ReplayInterruptions, AFactIsTakenInAtTheSamePlace)
{
  Stage stage;
  stage.world.meddle = [&](std::size_t number) {
    if (number == 2)
      stage.driver.tell(
          {reasoner::RecordKind::kObserved, "loc(tb1) = kitchen", true, 0, 0.9, "person"});
  };
  static_cast<void>(stage.run());
  EXPECT_EQ(stage.count(InputKind::kTold), 1U);
  stage.expectSame();
}

TEST(ReplayInterruptions, ASkillThatRefusesDoesNotEndTheMission)
{
  Stage stage;
  stage.world.meddle = [](std::size_t number) {
    if (number == 2)
      throw FailedPrecondition("the robot is outside the cell");
  };
  const MissionResult result = stage.run();
  EXPECT_TRUE(result.achieved) << result.reason;
  stage.expectSame();
}

TEST(ReplayInterruptions, AnotherFactChangesTheDecisionsAfterIt)
{
  Stage stage;
  stage.world.meddle = [&](std::size_t number) {
    if (number == 2)
      stage.driver.tell(
          {reasoner::RecordKind::kObserved, "loc(tb1) = aux_library", true, 0, 0.9, "person"});
  };
  static_cast<void>(stage.run());
  std::uint32_t told = 0;
  for (const auto& input : stage.inputs)
    told = input.kind == InputKind::kTold ? input.sequence : told;
  ASSERT_GT(told, 0U);
  alter(stage.inputs, std::to_string(told) + ".statement=loc(tb1) = kitchen");
  const ReplayResult result = replay(readMission(stage.inputs), {});
  ASSERT_NE(result.firstOtherChoice(), nullptr);
  EXPECT_GT(result.firstDifference()->sequence, told);
  bool to_the_kitchen = false;
  for (const auto& decision : result.decisions)
    to_the_kitchen =
        to_the_kitchen ||
        (decision.replayed && decision.replayed->kind == "plans" && decision.sequence > told &&
         decision.replayed->details.front().rfind("move(rob1, kitchen)", 0) == 0);
  EXPECT_TRUE(to_the_kitchen);
}

TEST(ReplayInterruptions, CancellingDuringAnActionRepeats)
{
  for (const std::size_t when : {1U, 2U, 4U})
  {
    Stage stage;
    stage.world.meddle = [&](std::size_t number) {
      if (number == when)
        stage.driver.cancel();
    };
    EXPECT_EQ(stage.run().code, ErrorCode::kCancelled);
    EXPECT_GE(stage.count(InputKind::kCancel), 1U);
    stage.expectSame();
  }
}

TEST(ReplayInterruptions, TheTimeRunsOutAtTheSamePlace)
{
  Stage stage;
  EXPECT_EQ(stage.run(20.0).code, ErrorCode::kDeadlineExceeded);
  stage.expectSame();
}

TEST(ReplayInterruptions, ASkillThatFailsOnceIsTriedAgain)
{
  Stage stage;
  stage.world.meddle = [](std::size_t number) {
    if (number == 2)
      throw Unavailable("no answer");
  };
  EXPECT_TRUE(stage.run().achieved);
  stage.expectSame();
}

TEST(ReplayInterruptions, ASkillThatKeepsFailingEndsTheMission)
{
  Stage stage;
  stage.world.meddle = [](std::size_t number) {
    if (number >= 3)
      throw Unavailable("no answer");
  };
  EXPECT_FALSE(stage.run().achieved);
  stage.expectSame();
}

TEST(ReplayInterruptions, AMissionGoesOnWithoutADiagnosisThatTakesTooLongAndSoDoesItsReplay)
{
  Stage stage;
  stage.reasoner.diagnoses_late = true;
  EXPECT_TRUE(stage.run().achieved);
  stage.expectSame();
}

TEST(ReplayInterruptions, AReasonerThatDoesNotAnswerEndsTheMissionAgain)
{
  Stage stage;
  stage.reasoner.fails = true;
  const MissionResult result = stage.run();
  EXPECT_EQ(result.code, ErrorCode::kUnavailable) << result.reason;
  stage.expectSame();
}

TEST(ReplayInterruptions, APolicyThatWasLostIsSolvedAgain)
{
  for (const std::size_t when : {1U, 3U})
  {
    Stage stage;
    stage.policies.forgets_at = when;
    EXPECT_TRUE(stage.run().achieved);
    stage.expectSame();
  }
}

TEST(ReplayInterruptions, AMissionAfterAnotherStartsFromItsKnowledge)
{
  Stage stage;
  EXPECT_TRUE(stage.run().achieved);
  stage.driver.tell(
      {reasoner::RecordKind::kObserved, "loc(tb1) = kitchen", true, 0, 0.9, "person"});
  const std::size_t first = stage.inputs.size();
  static_cast<void>(stage.run());
  const auto missions = splitMissions(stage.inputs);
  ASSERT_EQ(missions.size(), 2U);
  EXPECT_EQ(missions[0].size(), first);
  for (const auto& mission : missions)
    EXPECT_TRUE(replay(readMission(mission), {}).isSame());
}

}  // namespace
}  // namespace kr3::executive
