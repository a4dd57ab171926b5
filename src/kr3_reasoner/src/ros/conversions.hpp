#pragma once

#include <string>
#include <vector>

#include <kr3_msgs/ExplanationPart.h>
#include <kr3_msgs/HistoryModel.h>
#include <kr3_msgs/HistoryRecord.h>
#include <kr3_msgs/MakePlanGoal.h>
#include <kr3_msgs/MakePlanResult.h>
#include <kr3_msgs/MinimalExplanation.h>
#include <kr3_msgs/ProblemSize.h>
#include <kr3_msgs/Reason.h>
#include <kr3_msgs/RelevantItem.h>
#include <kr3_msgs/Retraction.h>

#include "kr3_reasoner/reasoner.hpp"

namespace kr3::reasoner
{

/// @throws InvalidArgument  an unknown kind of record
[[nodiscard]] Record fromMsg(const kr3_msgs::HistoryRecord& message);
[[nodiscard]] std::vector<Record> fromMsg(const std::vector<kr3_msgs::HistoryRecord>& messages);

[[nodiscard]] kr3_msgs::HistoryRecord toMsg(const Record& record);

/// What a goal says of the options; what it leaves open stays as in `defaults`.
/// @throws InvalidArgument  an unknown preference, a time limit below 0 or a number out of range
[[nodiscard]] PlanOptions fromMsg(const kr3_msgs::MakePlanGoal& goal, const PlanOptions& defaults);

/// The plans start at `first_step`. The status is left alone.
[[nodiscard]] kr3_msgs::MakePlanResult toMsg(const PlanResult& result, int first_step);

[[nodiscard]] kr3_msgs::ProblemSize toMsg(const ProblemSize& size);
[[nodiscard]] kr3_msgs::RelevantItem toMsg(const RelevantItem& item);
[[nodiscard]] kr3_msgs::Retraction toMsg(const Retraction& retraction);
[[nodiscard]] kr3_msgs::MinimalExplanation toMsg(const ExplanationAlternative& alternative);
[[nodiscard]] kr3_msgs::ExplanationPart toMsg(const ExplanationPart& part);
/// @param description  says in which form literals are written
[[nodiscard]] kr3_msgs::HistoryModel toMsg(const HistoryModel& model,
                                           const Description& description);

/// A proof in pre-order.
[[nodiscard]] std::vector<kr3_msgs::Reason> toMsg(const Reason& proof);

/// Several of them.
template <typename Message, typename Item>
[[nodiscard]] std::vector<Message> toMsgs(const std::vector<Item>& items)
{
  std::vector<Message> messages;
  for (const Item& item : items)
  {
    messages.push_back(toMsg(item));
  }
  return messages;
}

[[nodiscard]] std::string joined(const std::vector<std::string>& items,
                                 const std::string& separator);

}  // namespace kr3::reasoner
