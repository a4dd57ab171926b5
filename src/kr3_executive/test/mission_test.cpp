// Algorithm 1 as a table: state and event in, decision out.

#include "kr3_executive/mission.hpp"

#include <random>
#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

namespace kr3::executive
{
namespace
{

using reasoner::Record;
using reasoner::RecordKind;

const std::vector<std::vector<std::string>> kSteps{
    {"move(rob1, library)"}, {"grasp(rob1, book)"}, {"move(rob1, office)"}};

PlanReady planReady(std::vector<std::string> hypothesis = {}, double cost_s = 10.0)
{
  return {false, {{{std::move(hypothesis), kSteps}, cost_s}}, ""};
}

Assessment believing(double achieved, double refuted = 0.0, bool attempted = true)
{
  Assessment assessment;
  assessment.achieved = achieved;
  assessment.effects = {"in_hand(rob1, book)"};
  assessment.refutations = {{"loc(book) = library", refuted}};
  assessment.attempted = attempted;
  return assessment;
}

/// Feeds events to the core and keeps the state.
class Mission
{
public:
  Decision on(const Event& event)
  {
    Transition transition = step(state, event);
    state = std::move(transition.state);
    return transition.decision;
  }
  template <typename D>
  D expect(const Event& event)
  {
    Decision decision = on(event);
    EXPECT_TRUE(std::holds_alternative<D>(decision)) << "decision " << decision.index();
    return std::holds_alternative<D>(decision) ? std::get<D>(decision) : D{};
  }
  /// A mission whose first action is being executed.
  void start(std::vector<std::string> hypothesis = {})
  {
    expect<RequestPlan>(GoalGiven{"goal", limits, {}, 0});
    expect<RequestPolicy>(planReady(std::move(hypothesis)));
    expect<ExecutePolicyAction>(PolicyReady{believing(0.0)});
  }

  State state;
  Limits limits;
};

TEST(Mission, RunsAPlanToItsEnd)
{
  Mission mission;
  const Record initial{RecordKind::kInitially, "loc(rob1) = office", true, 0, 1.0, "scenario"};
  const auto told = mission.expect<AddRecords>(GoalGiven{"goal", {}, {initial}, 0});
  ASSERT_EQ(told.records.size(), 1U);
  mission.expect<RequestPlan>(RecordsAdded{0, false});
  EXPECT_EQ(mission.expect<RequestPolicy>(planReady()).action, "move(rob1, library)");
  for (int i = 0; i < 3; ++i)
  {
    mission.expect<ExecutePolicyAction>(PolicyReady{believing(0.0)});
    mission.expect<ExecutePolicyAction>(ActionExecuted{"a", believing(0.5)});
    const auto records = mission.expect<AddRecords>(ActionExecuted{"a", believing(0.9)}).records;
    ASSERT_EQ(records.size(), 2U);
    EXPECT_EQ(records[0].kind, RecordKind::kHappened);
    EXPECT_EQ(records[0].statement, kSteps[static_cast<std::size_t>(i)].front());
    EXPECT_EQ(records[0].step, i);
    EXPECT_EQ(records[1].kind, RecordKind::kObserved);
    EXPECT_EQ(records[1].step, i + 1);
    EXPECT_NEAR(records[1].confidence, 0.9, 1e-12);
    const Decision next = mission.on(RecordsAdded{i + 1, false});
    if (i < 2)
      EXPECT_TRUE(std::holds_alternative<RequestPolicy>(next));
    else
      EXPECT_TRUE(std::holds_alternative<RequestPlan>(next));
  }
  const auto finish = mission.expect<Finish>(PlanReady{true, {}, ""});
  EXPECT_TRUE(finish.achieved);
  EXPECT_EQ(mission.state.hl_actions_done, 3U);
  EXPECT_EQ(mission.state.ll_actions_done, 6U);
}

TEST(Mission, AGoalThatIsEntailedNeedsNothing)
{
  Mission mission;
  mission.expect<RequestPlan>(GoalGiven{"goal", {}, {}, 0});
  EXPECT_TRUE(mission.expect<Finish>(PlanReady{true, {}, ""}).achieved);
  EXPECT_EQ(mission.state.hl_actions_done, 0U);
}

TEST(Mission, ChoosesTheCheapestPlan)
{
  Mission mission;
  mission.expect<RequestPlan>(GoalGiven{"goal", {}, {}, 0});
  PlanReady plans = planReady({"loc(book) = library"}, 30.0);
  plans.plans.push_back({{{"loc(book) = kitchen"}, {{"move(rob1, kitchen)"}}}, 20.0});
  EXPECT_EQ(mission.expect<RequestPolicy>(plans).action, "move(rob1, kitchen)");
}

TEST(Mission, ARefutedAssumptionBecomesAFalseObservationAndADiagnosis)
{
  Mission mission;
  mission.start();
  const auto records =
      mission.expect<AddRecords>(ActionExecuted{"a", believing(0.0, 0.9, false)}).records;
  ASSERT_EQ(records.size(), 1U);  // not attempted: nothing occurred
  EXPECT_EQ(reasoner::RecordKind::kObserved, records[0].kind);
  EXPECT_EQ(records[0].statement, "loc(book) = library");
  EXPECT_FALSE(records[0].value);
  EXPECT_EQ(records[0].step, 0);
  EXPECT_NEAR(records[0].confidence, 0.9, 1e-12);
  mission.expect<RequestDiagnosis>(RecordsAdded{0, true});
  mission.expect<RequestPlan>(DiagnosisReady{true});
  EXPECT_EQ(mission.state.last_result, ActionResult::kRefuted);
}

TEST(Mission, APhysicalAttemptThatFailedIsRecordedAsAnAttempt)
{
  Mission mission;
  mission.start();
  const auto records = mission.expect<AddRecords>(PolicyFinished{believing(0.05, 0.4)}).records;
  ASSERT_EQ(records.size(), 2U);
  EXPECT_EQ(records[0].kind, RecordKind::kAttempted);
  EXPECT_EQ(records[1].statement, "in_hand(rob1, book)");
  EXPECT_FALSE(records[1].value);
  EXPECT_EQ(records[1].step, 1);
}

TEST(Mission, FinishingBelowTheThresholdRecordsNoFalsehood)
{
  Mission mission;
  mission.start();
  const auto records = mission.expect<AddRecords>(PolicyFinished{believing(0.5, 0.5)}).records;
  ASSERT_EQ(records.size(), 1U);
  EXPECT_EQ(records[0].kind, RecordKind::kAttempted);
  EXPECT_TRUE(
      recordsOf("a", 0, ActionResult::kUnresolved, believing(0.5, 0.5, false), 0.85).empty());
}

TEST(Mission, AnotherChangeOfTheWorldIsRecordedAsTheActionThatMadeIt)
{
  Mission mission;
  mission.start();
  Assessment assessment = believing(0.0);
  assessment.changed = {"loc(rob1) = corridor"};
  assessment.happened = "move(rob1, corridor)";
  const auto records = mission.expect<AddRecords>(ActionExecuted{"a", assessment}).records;
  ASSERT_EQ(records.size(), 2U);
  EXPECT_EQ(records[0].kind, RecordKind::kHappened);
  EXPECT_EQ(records[0].statement, "move(rob1, corridor)");
  EXPECT_EQ(records[1].statement, "loc(rob1) = corridor");
  EXPECT_EQ(records[1].step, 1);
  EXPECT_EQ(mission.state.last_result, ActionResult::kDisplaced);
}

TEST(Mission, KeepsAPlanThatIsStillValidAfterASurprise)
{
  Mission mission;
  mission.start();
  mission.expect<AddRecords>(ActionExecuted{"a", believing(0.9)});
  mission.expect<RequestDiagnosis>(RecordsAdded{1, true});
  mission.expect<RequestPlan>(DiagnosisReady{true});
  PlanReady plans;
  plans.plans.push_back({{{}, {{"move(rob1, kitchen)"}}}, 1.0});
  plans.plans.push_back({{{}, {kSteps.begin() + 1, kSteps.end()}}, 9.0});
  EXPECT_EQ(mission.expect<RequestPolicy>(plans).action, "grasp(rob1, book)");
}

TEST(Mission, APolicyThatGivesUpTwiceSettlesForTheBeliefItHasWithItsConfidence)
{
  Mission mission;
  mission.start();
  mission.expect<ExecutePolicyAction>(ActionExecuted{"a", believing(0.0, 0.8, false)});
  EXPECT_TRUE(
      mission.expect<AddRecords>(PolicyFinished{believing(0.0, 0.84, false)}).records.empty());
  mission.expect<RequestPlan>(RecordsAdded{0, false});
  mission.expect<RequestPolicy>(planReady());
  Assessment again = believing(0.0, 0.84, false);
  again.remembered = true;
  mission.expect<ExecutePolicyAction>(PolicyReady{again});
  const auto records = mission.expect<AddRecords>(PolicyFinished{again}).records;
  ASSERT_EQ(records.size(), 1U);
  EXPECT_FALSE(records[0].value);
  EXPECT_NEAR(records[0].confidence, 0.84, 1e-12);
}

TEST(Mission, WithoutEverLookingNothingIsRefuted)
{
  Mission mission;
  mission.start();
  for (int i = 0; i < 2; ++i)
  {
    EXPECT_TRUE(
        mission.expect<AddRecords>(PolicyFinished{believing(0.0, 0.8, false)}).records.empty());
    mission.expect<RequestPlan>(RecordsAdded{0, false});
    mission.expect<RequestPolicy>(planReady());
    mission.expect<ExecutePolicyAction>(PolicyReady{believing(0.0, 0.8, false)});
  }
}

TEST(Mission, DoesNotRepeatAPlanForEver)
{
  Mission mission;
  mission.limits.max_attempts = 2;
  mission.start({"loc(book) = library"});
  mission.expect<AddRecords>(PolicyFinished{believing(0.5, 0.5)});
  mission.expect<RequestPlan>(RecordsAdded{1, false});
  mission.expect<RequestPolicy>(planReady({"loc(book) = library"}));
  mission.expect<ExecutePolicyAction>(PolicyReady{believing(0.0)});
  mission.expect<AddRecords>(PolicyFinished{believing(0.5, 0.5)});
  mission.expect<RequestPlan>(RecordsAdded{2, false});
  mission.expect<ReopenRefutation>(planReady({"loc(book) = library"}));
  const auto finish = mission.expect<Finish>(RefutationReopened{false});
  EXPECT_FALSE(finish.achieved);
  EXPECT_NE(finish.reason.find("2 times"), std::string::npos) << finish.reason;
}

TEST(Mission, TakesTheLeastCertainRefutationBackWhenNoPlanIsLeftButNotForEver)
{
  Mission mission;
  mission.limits.max_reopened = 2;
  mission.expect<RequestPlan>(GoalGiven{"goal", mission.limits, {}, 0});
  for (int i = 0; i < 2; ++i)
  {
    mission.expect<ReopenRefutation>(PlanReady{false, {}, "nothing reaches it"});
    mission.expect<RequestPlan>(RefutationReopened{true});
  }
  const auto finish = mission.expect<Finish>(PlanReady{false, {}, "nothing reaches it"});
  EXPECT_EQ(finish.code, ErrorCode::kOk);
  EXPECT_FALSE(finish.achieved);
  EXPECT_NE(finish.reason.find("nothing reaches it"), std::string::npos);
}

TEST(Mission, LimitsLowLevelActionsOfOneHighLevelAction)
{
  Mission mission;
  mission.limits.max_ll_actions = 3;
  mission.start();
  mission.expect<ExecutePolicyAction>(ActionExecuted{"a", believing(0.1)});
  mission.expect<ExecutePolicyAction>(ActionExecuted{"a", believing(0.1)});
  mission.expect<AddRecords>(ActionExecuted{"a", believing(0.1)});
}

TEST(Mission, LimitsHighLevelActions)
{
  Mission mission;
  mission.limits.max_hl_actions = 1;
  mission.start();
  mission.expect<AddRecords>(ActionExecuted{"a", believing(0.9)});
  EXPECT_FALSE(mission.expect<Finish>(RecordsAdded{1, false}).achieved);
}

TEST(Mission, RebuildsALostTaskAFewTimes)
{
  Mission mission;
  mission.limits.max_rebuilds = 1;
  mission.start();
  EXPECT_TRUE(mission.expect<RequestPolicy>(TaskLost{"odd"}).rebuild);
  mission.expect<ExecutePolicyAction>(PolicyReady{believing(0.0)});
  mission.expect<AddRecords>(TaskLost{"odd"});
}

TEST(Mission, CancellingWhileTheRobotActsFirstRecordsWhatItDid)
{
  Mission mission;
  mission.start();
  mission.expect<ExecutePolicyAction>(ActionExecuted{"a", believing(0.1)});
  mission.expect<AddRecords>(CancelRequested{});
  const auto finish = mission.expect<Finish>(RecordsAdded{1, false});
  EXPECT_EQ(finish.code, ErrorCode::kCancelled);
  EXPECT_TRUE(std::holds_alternative<Wait>(mission.on(CancelRequested{})));
}

TEST(Mission, AToldFactInterruptsTheActionAndIsRecordedAfterWhatHappened)
{
  Mission mission;
  mission.start();
  mission.expect<ExecutePolicyAction>(ActionExecuted{"a", believing(0.5)});
  const Record fact{RecordKind::kObserved, "loc(book) = kitchen", true, 0, 0.9, "person"};
  const auto records = mission.expect<AddRecords>(Told{fact}).records;
  ASSERT_EQ(records.size(), 2U);
  EXPECT_EQ(records[0].kind, RecordKind::kAttempted);
  EXPECT_EQ(records[1].statement, "loc(book) = kitchen");
  EXPECT_EQ(records[1].step, 1);
  for (const auto& entry : mission.state.failures)
    EXPECT_EQ(entry.second, 0U) << entry.first;
}

TEST(Mission, AFailedRequestEndsItWithItsCode)
{
  Mission mission;
  mission.start();
  const auto finish =
      mission.expect<Finish>(RequestFailed{ErrorCode::kUnavailable, "skills/move_to is gone"});
  EXPECT_EQ(finish.code, ErrorCode::kUnavailable);
  EXPECT_EQ(finish.reason, "skills/move_to is gone");
}

// The law behind "each request ends in exactly one success or failure event".
TEST(Mission, EndsExactlyOnceWhateverHappens)
{
  std::mt19937_64 random(7);
  const auto draw = [&random](std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
  };
  const auto assessment = [&] {
    Assessment a = believing(static_cast<double>(draw(11)) / 10.0,
                             static_cast<double>(draw(11)) / 10.0, draw(2) == 0);
    if (draw(8) == 0)
      a.changed = {"loc(rob1) = corridor"};
    return a;
  };
  for (int trial = 0; trial < 2000; ++trial)
  {
    Mission mission;
    Decision decision = mission.on(GoalGiven{"goal", {}, {}, 0});
    int finished = 0;
    int step = 0;
    for (int i = 0; i < 20000 && finished == 0; ++i)
    {
      Event answer = RequestFailed{};
      if (draw(500) == 0)
        answer = CancelRequested{};
      else if (draw(200) == 0)
        answer = Told{{RecordKind::kObserved, "loc(book) = kitchen", true, 0, 0.9, "person"}};
      else if (std::holds_alternative<RequestPlan>(decision))
        answer = draw(5) == 0 ? PlanReady{} : planReady({}, static_cast<double>(draw(9)));
      else if (std::holds_alternative<RequestPolicy>(decision))
        answer = draw(9) == 0 ? Event(ActionImpossible{}) : Event(PolicyReady{assessment()});
      else if (std::holds_alternative<ExecutePolicyAction>(decision))
      {
        const auto kind = draw(6);
        answer = kind == 0   ? Event(PolicyFinished{assessment()})
                 : kind == 1 ? Event(TaskLost{})
                             : Event(ActionExecuted{"a", assessment()});
      }
      else if (std::holds_alternative<AddRecords>(decision))
        answer = RecordsAdded{++step, draw(3) == 0};
      else if (std::holds_alternative<RequestDiagnosis>(decision))
        answer = DiagnosisReady{draw(4) != 0};
      else if (std::holds_alternative<ReopenRefutation>(decision))
        answer = RefutationReopened{draw(2) == 0};
      const Decision next = mission.on(answer);
      if (!std::holds_alternative<Wait>(next))
        decision = next;
      finished += std::holds_alternative<Finish>(next) ? 1 : 0;
    }
    ASSERT_EQ(finished, 1) << "trial " << trial;
    ASSERT_TRUE(mission.state.outcome.has_value());
    EXPECT_TRUE(std::holds_alternative<Wait>(mission.on(PlanReady{true, {}, ""})));
  }
}

}  // namespace
}  // namespace kr3::executive
