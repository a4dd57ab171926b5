#pragma once

// Rows of the table for Algorithm 1 (algorithm_test.cpp), and the states and events that they are
// made of.

#include <functional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "kr3_executive/mission.hpp"

namespace kr3::executive
{

using reasoner::Record;
using reasoner::RecordKind;

/// A state and an event in, a decision and a state out.
struct Row
{
  std::string line;  // of the algorithm, and what it says here
  State state;
  Event event;
  std::vector<std::string> decision;  // its kind and details
  Phase phase;
  std::function<bool(const State&)> also = [](const State&) { return true; };
};

inline void PrintTo(const Row& row, std::ostream* out)
{
  *out << "line " << row.line;
}

inline const reasoner::Plan kPlan{
    {}, {{"move(rob1, library)"}, {"grasp(rob1, book)"}, {"move(rob1, office)"}}};
inline const reasoner::Plan kShort{{"loc(book) = hall"},
                                   {{"grasp(rob1, book)"}, {"move(rob1, office)"}}};
inline const reasoner::Plan kLong{
    {"loc(book) = kitchen"},
    {{"move(rob1, kitchen)"}, {"grasp(rob1, book)"}, {"move(rob1, office)"}}};

inline State inPhase(Phase phase, std::size_t plan_index = 0)
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
inline State grasping()
{
  State state = inPhase(Phase::kExecuting, 1);
  state.ll_actions_here = 1;
  state.ll_actions_done = 7;
  return state;
}

inline State with(State state, const std::function<void(State&)>& change)
{
  change(state);
  return state;
}

inline State recorded(ActionResult result, std::size_t plan_index = 1)
{
  State state = inPhase(Phase::kRecording, plan_index);
  state.last_result = result;
  return state;
}

inline Assessment believing(double achieved, double refuted, bool attempted = false)
{
  Assessment assessment;
  assessment.achieved = achieved;
  assessment.effects = {"in_hand(rob1, book)"};
  assessment.refutations = {{"loc(book) = library", refuted}};
  assessment.attempted = attempted;
  return assessment;
}

inline Assessment seeing(const std::string& literal, double confidence, bool overturns,
                         Assessment rest)
{
  rest.noticed.push_back({literal, confidence, overturns});
  return rest;
}

inline PlanReady plans(std::vector<CostedPlan> found)
{
  return {false, std::move(found), ""};
}

inline const Record kAtOffice{
    RecordKind::kInitially, "loc(rob1) = office", true, 0, 1.0, "scenario"};
inline const Record kTold{RecordKind::kObserved, "loc(book) = hall", true, 0, 0.9, "person"};

[[nodiscard]] std::vector<Row> lineOneToEight();
[[nodiscard]] std::vector<Row> lineNineToFifteen();
[[nodiscard]] std::vector<Row> lineSixteen();
[[nodiscard]] std::vector<Row> lineSeventeenToTwentyTwo();

}  // namespace kr3::executive
