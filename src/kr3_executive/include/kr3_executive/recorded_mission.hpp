#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "kr3_executive/domain_files.hpp"
#include "kr3_executive/mission_log.hpp"
#include "kr3_executive/mission_recording.hpp"

namespace kr3::executive
{

/// Something that ended a mission from outside.
struct RecordedEnd
{
  enum class Reason : std::uint8_t
  {
    kCancelled,
    kTime,
    kRefused,
  };
  Reason reason = Reason::kCancelled;
  ErrorCode code = ErrorCode::kCancelled;  ///< of kRefused
  std::string message;                     ///< of kRefused
};

/// One input or decision after the mission's start.
struct RecordedItem
{
  std::uint32_t sequence = 0;
  double stamp_s = 0.0;
  std::variant<SkillEnded, FactTold, RecordedEnd, ReportedDecision> content;
};

/// A recorded mission, checked: what it started from, then what came in and what was decided.
struct RecordedMission
{
  DomainFiles domain;
  reasoner::PlanOptions plan;
  PlanningMethod method;  ///< PA where the recording does not say
  MissionBegun start;
  double start_s = 0.0;  ///< on the driver's clock
  std::vector<RecordedItem> items;

  /// Whether the recording reaches the mission's end.
  [[nodiscard]] bool isComplete() const;
};

/// Splits what was recorded where a mission begins. Inputs before the first DOMAIN belong to a
/// mission whose start is not there.
/// @throws InvalidArgument  there is no beginning of a mission at all, or the recording begins in
///                          the middle of one
[[nodiscard]] std::vector<std::vector<RecordedInput>> splitMissions(
    const std::vector<RecordedInput>& inputs);

/// Changes one field of one input, as in "12.observation=false", "12.confidence=0.7" or
/// "1.history.0.value=false" (path after the sequence number; list elements count from 0). The
/// value is JSON, or a text; what replaces a list may be its elements, separated by commas.
/// @throws InvalidArgument  no such input, or no such field
void alter(std::vector<RecordedInput>& mission, const std::string& change);

/// @param mission  from DOMAIN on
/// @throws InvalidArgument  a gap in the sequence, a recording of another version, missing or
///                          malformed fields, a changed text of the domain; names the input
[[nodiscard]] RecordedMission readMission(const std::vector<RecordedInput>& mission);

}  // namespace kr3::executive
