#pragma once

#include <string>
#include <vector>

#include <kr3_msgs/HistoryRecord.h>
#include <kr3_msgs/MakePlanResult.h>

#include "kr3_reasoner/reasoner.hpp"

namespace kr3::reasoner
{

/// @throws InvalidArgument  an unknown kind of record
[[nodiscard]] Record fromMsg(const kr3_msgs::HistoryRecord& message);
[[nodiscard]] std::vector<Record> fromMsg(const std::vector<kr3_msgs::HistoryRecord>& messages);

/// The plans start at `first_step`. The status is left alone.
[[nodiscard]] kr3_msgs::MakePlanResult toMsg(const PlanResult& result, int first_step);

[[nodiscard]] std::string joined(const std::vector<std::string>& items,
                                 const std::string& separator);

}  // namespace kr3::reasoner
