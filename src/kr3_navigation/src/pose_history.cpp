#include "kr3_navigation/pose_history.hpp"

#include <algorithm>

namespace kr3::navigation
{

void PoseHistory::add(double time_s, const Pose& pose)
{
  if (!entries_.empty() && time_s <= entries_.back().time_s)
    return;
  entries_.push_back({time_s, pose});
  while (entries_.front().time_s < time_s - span_s_)
    entries_.pop_front();
}

std::optional<Pose> PoseHistory::at(double time_s) const
{
  constexpr double kRounding = 1e-9;
  if (entries_.empty() || time_s < entries_.front().time_s - kRounding ||
      time_s > entries_.back().time_s + kRounding)
    return std::nullopt;
  const auto after =
      std::lower_bound(entries_.begin(), entries_.end(), time_s,
                       [](const Entry& entry, double time) { return entry.time_s < time; });
  if (after == entries_.end())
    return entries_.back().pose;
  if (after == entries_.begin())
    return after->pose;
  const Entry& before = *std::prev(after);
  const double share = (time_s - before.time_s) / (after->time_s - before.time_s);
  return Pose{before.pose.x + share * (after->pose.x - before.pose.x),
              before.pose.y + share * (after->pose.y - before.pose.y),
              wrapAngle(before.pose.yaw + share * wrapAngle(after->pose.yaw - before.pose.yaw))};
}

}  // namespace kr3::navigation
