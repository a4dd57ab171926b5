#pragma once

#include <deque>
#include <optional>

#include "kr3_navigation/geometry.hpp"

namespace kr3::navigation
{

/// Recent poses with their times, for the pose at the moment of a scan. Times ascend; what is older
/// than the span is forgotten.
class PoseHistory
{
public:
  explicit PoseHistory(double span_s) : span_s_(span_s) {}

  /// A pose that is not newer than the last one is ignored.
  void add(double time_s, const Pose& pose);
  void clear() { entries_.clear(); }

  [[nodiscard]] bool empty() const { return entries_.empty(); }
  [[nodiscard]] double latestTime() const { return entries_.back().time_s; }
  [[nodiscard]] const Pose& latest() const { return entries_.back().pose; }
  /// Interpolated; nothing when `time_s` lies outside what is remembered.
  [[nodiscard]] std::optional<Pose> at(double time_s) const;
  /// Whether poses up to `time_s` have arrived.
  [[nodiscard]] bool covers(double time_s) const
  {
    return !entries_.empty() && entries_.back().time_s >= time_s;
  }

private:
  struct Entry
  {
    double time_s;
    Pose pose;
  };

  double span_s_;
  std::deque<Entry> entries_;
};

}  // namespace kr3::navigation
