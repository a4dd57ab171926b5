// Algorithm 1 of Zhang, Sridharan, Gelfond and Wyatt (2014) line by line: a state and an event in,
// a decision and a state out. docs/control_loop.md has the lines and what differs from the paper.

#include <functional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "kr3_executive/mission.hpp"
#include "kr3_executive/mission_log.hpp"

namespace kr3::executive
{
namespace
{

using reasoner::Record;
using reasoner::RecordKind;

struct Row
{
  std::string line;  // of the algorithm, and what it says here
  State state;
  Event event;
  std::vector<std::string> decision;  // its kind and details
  Phase phase;
  std::function<bool(const State&)> also = [](const State&) { return true; };
};

void PrintTo(const Row& row, std::ostream* out)
{
  *out << "line " << row.line;
}

const reasoner::Plan kPlan{
    {}, {{"move(rob1, library)"}, {"grasp(rob1, book)"}, {"move(rob1, office)"}}};
const reasoner::Plan kShort{{"loc(book) = hall"}, {{"grasp(rob1, book)"}, {"move(rob1, office)"}}};
const reasoner::Plan kLong{
    {"loc(book) = kitchen"},
    {{"move(rob1, kitchen)"}, {"grasp(rob1, book)"}, {"move(rob1, office)"}}};

State inPhase(Phase phase, std::size_t plan_index = 0)
{
  State state;
  state.phase = phase;
  state.goal = "loc(book) = office";
  state.step = 4;
  state.plan = CostedPlan{kPlan, 30.0};
  state.plan_index = plan_index;
  return state;
}

/// The grasp is under way, after one low-level action.
State grasping()
{
  State state = inPhase(Phase::kExecuting, 1);
  state.ll_actions_here = 1;
  state.ll_actions_done = 7;
  return state;
}

State with(State state, const std::function<void(State&)>& change)
{
  change(state);
  return state;
}

State recorded(ActionResult result, std::size_t plan_index = 1)
{
  State state = inPhase(Phase::kRecording, plan_index);
  state.last_result = result;
  return state;
}

Assessment believing(double achieved, double refuted, bool attempted = false)
{
  Assessment assessment;
  assessment.achieved = achieved;
  assessment.effects = {"in_hand(rob1, book)"};
  assessment.refutations = {{"loc(book) = library", refuted}};
  assessment.attempted = attempted;
  return assessment;
}

Assessment seeing(const std::string& literal, double confidence, bool overturns, Assessment rest)
{
  rest.noticed.push_back({literal, confidence, overturns});
  return rest;
}

PlanReady plans(std::vector<CostedPlan> found)
{
  return {false, std::move(found), ""};
}

const Record kAtOffice{RecordKind::kInitially, "loc(rob1) = office", true, 0, 1.0, "scenario"};
const Record kTold{RecordKind::kObserved, "loc(book) = hall", true, 0, 0.9, "person"};

std::vector<Row> lineOneToEight()
{
  const std::vector<std::string> first{"request_policy", "move(rob1, library)", "assuming ",
                                       "then grasp(rob1, book)", "then move(rob1, office)"};
  return {
      {"1: what is known at the start is reported to the history",
       State{},
       GoalGiven{"loc(book) = office", {}, {kAtOffice}, 0},
       {"add_records", "init(loc(rob1) = office, true), 1, scenario"},
       Phase::kReporting},
      {"1: what the history has already is not told again",
       State{},
       GoalGiven{"loc(book) = office", {}, {}, 4},
       {"request_plan", "loc(book) = office"},
       Phase::kPlanning,
       [](const State& s) { return s.step == 4; }},
      {"2: the task gives the goal",
       State{},
       GoalGiven{"loc(book) = office", {}, {kAtOffice}, 0},
       {"add_records", "init(loc(rob1) = office, true), 1, scenario"},
       Phase::kReporting,
       [](const State& s) { return s.goal == "loc(book) = office" && !s.plan; }},
      {"2: a second task has to wait",
       inPhase(Phase::kPlanning),
       GoalGiven{"other", {}, {}, 0},
       {"wait"},
       Phase::kPlanning,
       [](const State& s) { return s.goal == "loc(book) = office"; }},
      {"3: plans are made once the records are in",
       inPhase(Phase::kReporting),
       RecordsAdded{0, false},
       {"request_plan", "loc(book) = office"},
       Phase::kPlanning},
      {"3: nothing to do for a goal that is entailed",
       inPhase(Phase::kPlanning),
       PlanReady{true, {}, ""},
       {"finish", "achieved", "the history entails the goal"},
       Phase::kFinished},
      {"4-6: of several plans the one with the lowest expected cost, though it is longer",
       inPhase(Phase::kPlanning),
       plans({{kShort, 60.0}, {kLong, 50.0}}),
       {"request_policy", "move(rob1, kitchen)", "assuming loc(book) = kitchen",
        "then grasp(rob1, book)", "then move(rob1, office)"},
       Phase::kPreparing},
      {"4-6: a plan that failed as often as allowed is passed over",
       with(inPhase(Phase::kPlanning),
            [](State& s) { s.failures["move(rob1, kitchen) | loc(book) = kitchen"] = 3; }),
       plans({{kShort, 60.0}, {kLong, 50.0}}),
       {"request_policy", "grasp(rob1, book)", "assuming loc(book) = hall",
        "then move(rob1, office)"},
       Phase::kPreparing},
      {"4-6: a plan that begins with what was just found impossible is passed over",
       with(inPhase(Phase::kPlanning),
            [](State& s) { s.impossible = {"move(rob1, kitchen) | loc(book) = kitchen"}; }),
       plans({{kShort, 60.0}, {kLong, 50.0}}),
       {"request_policy", "grasp(rob1, book)", "assuming loc(book) = hall",
        "then move(rob1, office)"},
       Phase::kPreparing},
      {"7: every plan rests on what was looked for in vain: the least certain refutation is taken "
       "back",
       inPhase(Phase::kPlanning),
       plans({{kShort, 60.0, "", "", true}, {kLong, 50.0, "", "", true}}),
       {"reopen_refutation"},
       Phase::kReopening},
      {"7: the same, and nothing may be taken back any more",
       with(inPhase(Phase::kPlanning), [](State& s) { s.reopened = s.limits.max_reopened = 2; }),
       plans({{kLong, 50.0, "", "", true}}),
       {"finish", "not achieved",
        "everything that the goal may rest on was looked for in vain; 2 refutations were taken "
        "back"},
       Phase::kFinished},
      {"7: one plan does not: it goes on, with the cheapest",
       inPhase(Phase::kPlanning),
       plans({{kShort, 60.0}, {kLong, 50.0, "", "", true}}),
       {"request_policy", "move(rob1, kitchen)", "assuming loc(book) = kitchen",
        "then grasp(rob1, book)", "then move(rob1, office)"},
       Phase::kPreparing},
      {"7: no plan exists: the least certain refutation is taken back",
       inPhase(Phase::kPlanning),
       PlanReady{false, {}, "nothing reaches it"},
       {"reopen_refutation"},
       Phase::kReopening},
      {"7: no plan exists and nothing is left to take back",
       with(inPhase(Phase::kPlanning), [](State& s) { s.reopened = s.limits.max_reopened; }),
       PlanReady{false, {}, "nothing reaches it"},
       {"finish", "not achieved", "no plan is left: nothing reaches it"},
       Phase::kFinished},
      {"7: after it was taken back plans are made again",
       inPhase(Phase::kReopening),
       RefutationReopened{true},
       {"request_plan", "loc(book) = office"},
       Phase::kPlanning},
      {"8: the first action of the plan", inPhase(Phase::kPlanning), plans({{kPlan, 30.0}}), first,
       Phase::kPreparing, [](const State& s) { return s.plan_index == 0; }},
      {"8: the actions of a plan end at the mission's limit",
       with(inPhase(Phase::kPlanning), [](State& s) { s.hl_actions_done = 40; }),
       plans({{kPlan, 30.0}}),
       {"finish", "not achieved", "limit of 40 high-level actions reached"},
       Phase::kFinished},
  };
}

std::vector<Row> lineNineToFifteen()
{
  const std::vector<std::string> grasped{"add_records", "hpd(grasp(rob1, book), 4), 1, robot",
                                         "obs(in_hand(rob1, book), true, 5) [0.9], 0.9, robot"};
  return {
      {"9: the next action goes to the low level",
       recorded(ActionResult::kAchieved, 0),
       RecordsAdded{5, false},
       {"request_policy", "grasp(rob1, book)", "assuming ", "then move(rob1, office)"},
       Phase::kPreparing},
      {"10: the initial belief is the assessment that the action starts from",
       inPhase(Phase::kPreparing, 1),
       PolicyReady{believing(0.0, 0.15)},
       {"execute_policy_action", "grasp(rob1, book)"},
       Phase::kExecuting,
       [](const State& s) { return s.assessment.refutations.front().probability == 0.15; }},
      {"11: no policy for an action that is impossible now: plan again",
       inPhase(Phase::kPreparing, 1),
       ActionImpossible{"impossible"},
       {"request_plan", "loc(book) = office"},
       Phase::kPlanning,
       [](const State& s) {
    return s.failures.at("grasp(rob1, book)") == 1 && s.impossible.size() == 1;
       }},
      {"12: neither completed nor unachievable: go on",
       grasping(),
       ActionExecuted{"search", believing(0.5, 0.5)},
       {"execute_policy_action", "grasp(rob1, book)"},
       Phase::kExecuting},
      {"12: completed above the threshold", grasping(),
       ActionExecuted{"grasp", believing(0.9, 0.0)}, grasped, Phase::kRecording,
       [](const State& s) { return s.last_result == ActionResult::kAchieved; }},
      {"12: at the threshold is not above it",
       grasping(),
       ActionExecuted{"grasp", believing(0.85, 0.0)},
       {"execute_policy_action", "grasp(rob1, book)"},
       Phase::kExecuting},
      {"12: unachievable, for what it assumes is refuted",
       grasping(),
       ActionExecuted{"search", believing(0.0, 0.9)},
       {"add_records", "obs(loc(book) = library, false, 4) [0.9], 0.9, robot"},
       Phase::kRecording,
       [](const State& s) { return s.last_result == ActionResult::kRefuted; }},
      {"12: a sighting overturns what the plan rests on",
       grasping(),
       ActionExecuted{"search", seeing("loc(book) = hall", 0.95, true, believing(0.0, 0.7))},
       {"add_records", "obs(loc(book) = hall, true, 4) [0.95], 0.95, sighting"},
       Phase::kRecording,
       [](const State& s) { return s.last_result == ActionResult::kDisplaced && s.replan; }},
      {"12: a sighting of something else does not interrupt",
       grasping(),
       ActionExecuted{"search", seeing("loc(mug) = hall", 0.95, false, believing(0.0, 0.7))},
       {"execute_policy_action", "grasp(rob1, book)"},
       Phase::kExecuting},
      {"12: the low-level actions of an action are limited",
       with(grasping(), [](State& s) { s.ll_actions_here = 59; }),
       ActionExecuted{"search", believing(0.5, 0.5)},
       {"add_records"},
       Phase::kRecording,
       [](const State& s) { return s.last_result == ActionResult::kUnresolved; }},
      {"13: the first action of a policy is always executed: an assumed belief is no observation",
       inPhase(Phase::kPreparing, 1),
       PolicyReady{believing(0.0, 0.95)},
       {"execute_policy_action", "grasp(rob1, book)"},
       Phase::kExecuting},
      {"14: the updated belief is what counts from now on",
       grasping(),
       ActionExecuted{"search", believing(0.3, 0.6)},
       {"execute_policy_action", "grasp(rob1, book)"},
       Phase::kExecuting,
       [](const State& s) {
    return s.assessment.achieved == 0.3 && s.ll_actions_here == 2 && s.ll_actions_done == 8;
       }},
      {"14: an observation that the model cannot explain: the task is made anew",
       grasping(),
       TaskLost{"odd"},
       {"request_policy", "grasp(rob1, book)", "rebuild", "assuming ", "then move(rob1, office)"},
       Phase::kPreparing},
      {"15: the policy finishes", grasping(), PolicyFinished{believing(0.9, 0.0)}, grasped,
       Phase::kRecording},
      {"15: the policy gives up below the threshold",
       grasping(),
       PolicyFinished{believing(0.0, 0.8)},
       {"add_records"},
       Phase::kRecording,
       [](const State& s) { return s.last_result == ActionResult::kUnresolved; }},
      };
}

std::vector<Row> lineSixteen()
{
  Assessment elsewhere = believing(0.0, 0.0);
  elsewhere.changed = {"loc(rob1) = hall"};
  elsewhere.happened = "move(rob1, hall)";
  Assessment dropped = believing(1.0, 0.0);
  dropped.denied = true;
  dropped.changed = {"loc(rob1) = office"};
  dropped.happened = "move(rob1, office)";
  Assessment settled = believing(0.0, 0.7);
  settled.remembered = true;
  return {
      {"16: a failed attempt",
       grasping(),
       PolicyFinished{believing(0.05, 0.0, true)},
       {"add_records", "attempt(grasp(rob1, book), 4), 1, robot",
        "obs(in_hand(rob1, book), false, 5) [0.95], 0.95, robot"},
       Phase::kRecording},
      {"16: an attempt of which nothing is known is no falsehood",
       grasping(),
       PolicyFinished{believing(0.5, 0.5, true)},
       {"add_records", "attempt(grasp(rob1, book), 4), 1, robot"},
       Phase::kRecording},
      {"16: the robot is elsewhere: the action that this amounts to",
       grasping(),
       ActionExecuted{"move", elsewhere},
       {"add_records", "hpd(move(rob1, hall), 4), 1, robot",
        "obs(loc(rob1) = hall, true, 5) [0.999], 0.999, robot"},
       Phase::kRecording,
       [](const State& s) { return s.last_result == ActionResult::kDisplaced; }},
      {"16: what was held is seen not to be: the effects do not count as reached",
       with(grasping(), [](State& s) { s.plan_index = 2; }),
       ActionExecuted{"move", seeing("-in_hand(rob1, book)", 0.95, true, dropped)},
       {"add_records", "hpd(move(rob1, office), 4), 1, robot",
        "obs(loc(rob1) = office, true, 5) [0.999], 0.999, robot",
        "obs(in_hand(rob1, book), false, 5) [0.95], 0.95, sighting"},
       Phase::kRecording,
       [](const State& s) { return s.last_result == ActionResult::kDisplaced; }},
      {"16: what was seen by the way is so after the action",
       grasping(),
       ActionExecuted{"grasp", seeing("loc(mug) = hall", 0.9, false, believing(0.9, 0.0))},
       {"add_records", "hpd(grasp(rob1, book), 4), 1, robot",
        "obs(in_hand(rob1, book), true, 5) [0.9], 0.9, robot",
        "obs(loc(mug) = hall, true, 5) [0.9], 0.9, sighting"},
       Phase::kRecording},
      {"16: asked again, the policy has nothing new to try: what its looks left counts",
       inPhase(Phase::kExecuting, 1),
       PolicyFinished{settled},
       {"add_records", "obs(loc(book) = library, false, 4) [0.7], 0.7, robot"},
       Phase::kRecording,
       [](const State& s) { return s.last_result == ActionResult::kRefuted; }},
      {"16: that never makes an action achieved",
       inPhase(Phase::kExecuting, 1),
       PolicyFinished{[&] {
         Assessment half = believing(0.6, 0.0);
         half.remembered = true;
         return half;
       }()},
       {"add_records"},
       Phase::kRecording,
       [](const State& s) { return s.last_result == ActionResult::kUnresolved; }},
      {"16: a person's fact ends the action with what is known, and comes after it",
       grasping(),
       Told{kTold},
       {"add_records", "obs(loc(book) = hall, true, 4) [0.9], 0.9, person"},
       Phase::kRecording,
       [](const State& s) { return s.replan; }},
  };
}

std::vector<Row> lineSeventeenToTwentyTwo()
{
  const reasoner::Plan rest{{}, {kPlan.steps.begin() + 1, kPlan.steps.end()}};
  return {
      {"17: results as expected need no diagnosis",
       recorded(ActionResult::kAchieved),
       RecordsAdded{5, false},
       {"request_policy", "move(rob1, office)", "assuming "},
       Phase::kPreparing},
      {"17-18: unexpected results are diagnosed",
       recorded(ActionResult::kRefuted),
       RecordsAdded{4, true},
       {"request_diagnosis"},
       Phase::kDiagnosing,
       [](const State& s) { return s.step == 4 && s.plan_index == 1; }},
      {"17-18: also beside an action that was achieved",
       recorded(ActionResult::kAchieved),
       RecordsAdded{5, true},
       {"request_diagnosis"},
       Phase::kDiagnosing,
       [](const State& s) { return s.plan_index == 2; }},
      {"19: an explanation was found",
       inPhase(Phase::kDiagnosing),
       DiagnosisReady{true},
       {"request_plan", "loc(book) = office"},
       Phase::kPlanning},
      {"19: none was found: the least certain record is taken back",
       inPhase(Phase::kDiagnosing),
       DiagnosisReady{false},
       {"reopen_refutation"},
       Phase::kReopening},
      {"20: the plan is over: plans are asked for again, which finds the goal entailed or not",
       recorded(ActionResult::kAchieved, 2),
       RecordsAdded{6, false},
       {"request_plan", "loc(book) = office"},
       Phase::kPlanning},
      {"20: what is left of the plan is still valid after a surprise",
       with(recorded(ActionResult::kAchieved, 1), [](State& s) { s.phase = Phase::kPlanning; }),
       plans({{kLong, 1.0}, {rest, 9.0}}),
       {"request_policy", "grasp(rob1, book)", "assuming ", "then move(rob1, office)"},
       Phase::kPreparing},
      {"20-21: it is not valid any more: the best of the new ones",
       with(recorded(ActionResult::kAchieved, 1), [](State& s) { s.phase = Phase::kPlanning; }),
       plans({{kLong, 1.0}}),
       {"request_policy", "move(rob1, kitchen)", "assuming loc(book) = kitchen",
        "then grasp(rob1, book)", "then move(rob1, office)"},
       Phase::kPreparing},
      {"20-21: an action that was not achieved leaves no valid plan",
       recorded(ActionResult::kUnresolved),
       RecordsAdded{4, false},
       {"request_plan", "loc(book) = office"},
       Phase::kPlanning},
      {"20-21: a fact that was told may open a better plan",
       with(recorded(ActionResult::kAchieved), [](State& s) { s.replan = true; }),
       RecordsAdded{5, false},
       {"request_plan", "loc(book) = office"},
       Phase::kPlanning,
       [](const State& s) { return s.plan_index == 2 && !s.replan; }},
      {"22: cancelled while the robot acts: what it did is recorded first",
       grasping(),
       CancelRequested{},
       {"add_records"},
       Phase::kRecording,
       [](const State& s) { return s.cancelling; }},
      {"22: and then the mission ends",
       with(recorded(ActionResult::kUnresolved), [](State& s) { s.cancelling = true; }),
       RecordsAdded{4, false},
       {"finish", "not achieved", "cancelled"},
       Phase::kFinished},
      {"22: a request that cannot be answered ends it",
       grasping(),
       RequestFailed{ErrorCode::kUnavailable, "gone"},
       {"finish", "not achieved", "gone"},
       Phase::kFinished},
  };
}

class AlgorithmOne : public testing::TestWithParam<Row>
{
};

TEST_P(AlgorithmOne, Line)
{
  const Row& row = GetParam();
  const Transition transition = step(row.state, row.event);
  const ReportedDecision decision = reported(transition.decision, transition.state);
  std::vector<std::string> text{decision.kind};
  text.insert(text.end(), decision.details.begin(), decision.details.end());
  EXPECT_EQ(text, row.decision) << row.line;
  EXPECT_EQ(transition.state.phase, row.phase) << row.line;
  EXPECT_TRUE(row.also(transition.state)) << row.line;
}

INSTANTIATE_TEST_SUITE_P(Lines1To8, AlgorithmOne, testing::ValuesIn(lineOneToEight()));
INSTANTIATE_TEST_SUITE_P(Lines9To15, AlgorithmOne, testing::ValuesIn(lineNineToFifteen()));
INSTANTIATE_TEST_SUITE_P(Line16, AlgorithmOne, testing::ValuesIn(lineSixteen()));
INSTANTIATE_TEST_SUITE_P(Lines17To22, AlgorithmOne, testing::ValuesIn(lineSeventeenToTwentyTwo()));

// Every line of the algorithm that decides anything has a row.
TEST(AlgorithmOneTable, HasARowForEachLine)
{
  std::vector<bool> seen(23, false);
  for (const auto& rows :
       {lineOneToEight(), lineNineToFifteen(), lineSixteen(), lineSeventeenToTwentyTwo()})
  {
    for (const auto& row : rows)
    {
      std::size_t from = std::stoul(row.line);
      const auto dash = row.line.find('-');
      const bool range = dash != std::string::npos && dash < row.line.find(':');
      const std::size_t to = range ? std::stoul(row.line.substr(dash + 1)) : from;
      for (; from <= to; ++from)
        seen.at(from) = true;
    }
  }
  for (std::size_t line = 1; line <= 22; ++line)
    EXPECT_TRUE(seen[line]) << "line " << line;
}

}  // namespace
}  // namespace kr3::executive
