#pragma once

#include <vector>

#include <kr3_msgs/BeliefState.h>
#include <kr3_msgs/CellArray.h>
#include <kr3_msgs/HighLevelPlan.h>
#include <kr3_msgs/HistoryRecord.h>
#include <kr3_msgs/MissionEvent.h>
#include <kr3_msgs/MissionInput.h>
#include <kr3_msgs/MissionState.h>
#include <kr3_msgs/Reason.h>
#include <kr3_msgs/Status.h>
#include <kr3_refinement/component_map.hpp>

#include "kr3_executive/driver.hpp"
#include "kr3_executive/mission_recording.hpp"

namespace kr3::executive
{

[[nodiscard]] kr3_msgs::HistoryRecord toMsg(const reasoner::Record& record);
[[nodiscard]] std::vector<kr3_msgs::HistoryRecord> toMsg(
    const std::vector<reasoner::Record>& records);

[[nodiscard]] kr3_msgs::HighLevelPlan toMsg(const reasoner::Plan& plan, int first_step);
[[nodiscard]] reasoner::Plan fromMsg(const kr3_msgs::HighLevelPlan& message);

/// A proof, whose nodes come in pre-order.
[[nodiscard]] reasoner::Reason fromMsg(const std::vector<kr3_msgs::Reason>& proof);

[[nodiscard]] kr3_msgs::MissionEvent toMsg(const ReportedEvent& event);
[[nodiscard]] kr3_msgs::MissionState toMsg(const Snapshot& snapshot);
[[nodiscard]] kr3_msgs::BeliefState toMsg(const ReportedBelief& belief);
[[nodiscard]] kr3_msgs::MissionInput toMsg(const RecordedInput& input);

/// Cells are components; their rooms are what they are part of.
/// @throws InvalidArgument  a neighbour that is no cell, distances of another shape
[[nodiscard]] refinement::ComponentMap fromMsg(const kr3_msgs::CellArray& message);

/// Throws the error that a status stands for; nothing for OK.
/// @param request  what was asked, for the message
void throwIfFailed(const kr3_msgs::Status& status, const std::string& request);

}  // namespace kr3::executive
