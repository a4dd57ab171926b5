// Lines 16 to 22 of Algorithm 1: what enters the history, diagnosis, and planning anew.

#include "algorithm_rows.hpp"

namespace kr3::executive
{

namespace
{

const std::vector<std::string> kKitchen{"loc(book) = kitchen"};
constexpr char kHere[] = "loc(rob1) = library";

/// The drive to the kitchen was tried in vain so often.
State failed(std::uint32_t times)
{
  State state = inPhase(Phase::kPlanning);
  state.last_result = ActionResult::kUnresolved;
  state.alternatives = true;
  state.failures[attemptKey("move(rob1, kitchen)", kKitchen, kHere)] = times;
  return state;
}

CostedPlan at(CostedPlan plan, const std::string& situation)
{
  plan.situation = situation;
  return plan;
}

CostedPlan direct(double cost_s)
{
  return at({{kKitchen, {{"move(rob1, kitchen)"}}}, cost_s}, kHere);
}

CostedPlan through(const std::string& place, double cost_s)
{
  return at({{kKitchen, {{"move(rob1, " + place + ")"}, {"move(rob1, kitchen)"}}}, cost_s}, kHere);
}

CostedPlan round(double cost_s)
{
  CostedPlan plan = through("hall", cost_s);
  plan.detour = true;
  return plan;
}

}  // namespace

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
      {"20-22: what was tried in vain calls for other plans of the same hypothesis",
       with(recorded(ActionResult::kUnresolved), [](State& s) { s.alternatives = true; }),
       RecordsAdded{4, false},
       {"request_plan", "loc(book) = office", "with alternatives"},
       Phase::kPlanning},
      {"20-22: and so does an action that turns out to be impossible",
       inPhase(Phase::kPreparing, 1),
       ActionImpossible{"impossible", "loc(rob1) = hall"},
       {"request_plan", "loc(book) = office", "with alternatives"},
       Phase::kPlanning,
       [](const State& s) {
    return s.failuresOf("grasp(rob1, book)", {}, "loc(rob1) = hall") == 1;
       }},
      {"20-22: another plan that is as short, though it costs more",
       failed(1),
       plans({direct(20.0), through("hall", 30.0), through("lobby", 40.0)}),
       {"request_policy", "move(rob1, hall)", "assuming loc(book) = kitchen",
        "then move(rob1, kitchen)"},
       Phase::kPreparing},
      {"20-22: not one of another hypothesis, which failed no less likely",
       failed(1),
       plans({direct(20.0), {kShort, 30.0}}),
       {"request_policy", "move(rob1, kitchen)", "assuming loc(book) = kitchen"},
       Phase::kPreparing},
      {"20-22: elsewhere the same action has not failed",
       failed(3),
       plans({at(direct(20.0), "loc(rob1) = hall"), through("lobby", 40.0)}),
       {"request_policy", "move(rob1, kitchen)", "assuming loc(book) = kitchen"},
       Phase::kPreparing},
      {"20-22: a way round only when no shortest plan is left",
       failed(2),
       plans({direct(20.0), round(5.0)}),
       {"request_policy", "move(rob1, kitchen)", "assuming loc(book) = kitchen"},
       Phase::kPreparing},
      {"20-22: then it is taken, and counted",
       failed(3),
       plans({direct(20.0), round(25.0)}),
       {"request_policy", "move(rob1, hall)", "assuming loc(book) = kitchen",
        "then move(rob1, kitchen)"},
       Phase::kPreparing,
       [](const State& s) { return s.detours == 1; }},
      {"20-22: as often as is allowed",
       with(failed(3), [](State& s) { s.detours = s.limits.max_detours; }),
       plans({direct(20.0), round(25.0)}),
       {"reopen_refutation"},
       Phase::kReopening},
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

}  // namespace kr3::executive
