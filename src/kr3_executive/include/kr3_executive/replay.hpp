#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "kr3_executive/mission_log.hpp"
#include "kr3_executive/recorded_mission.hpp"

/// Computes a recorded mission again, without robot and without ROS.
namespace kr3::executive
{

enum class Verdict : std::uint8_t
{
  kSame,
  kOtherBasis,  ///< the same choice from other numbers: costs, bounds or beliefs
  kDiffers,     ///< another choice, or none where there was one
  kNew,         ///< made after the first other choice: no longer compared
};

/// "same", "other numbers", "differs", "new".
[[nodiscard]] const char* toString(Verdict verdict);

struct ReplayedDecision
{
  Verdict verdict = Verdict::kSame;
  std::uint32_t sequence = 0;  ///< of the recorded input that it stands beside
  int hl_step = 0;             ///< step of the high-level history
  std::string hl_action;       ///< under execution; empty if none
  std::optional<ReportedDecision> recorded;
  std::optional<ReportedDecision> replayed;
};

enum class ReplayEnd : std::uint8_t
{
  kMissionEnded,
  kRecordingEnded,  ///< as far as it was recorded
  kOtherAction,     ///< the robot would have to do something of which nothing is recorded
};

struct ReplayResult
{
  std::vector<ReplayedDecision> decisions;
  ReplayEnd end = ReplayEnd::kMissionEnded;
  std::string reason;  ///< of the end
  /// Where equality is not promised, and why: a line each, in the order of the recording.
  std::vector<std::string> not_promised;

  /// Whether each decision is the recorded one, its numbers included, to the end of the recording.
  [[nodiscard]] bool isSame() const;
  /// The first decision that is not the same, and the first that is another choice; null if none.
  [[nodiscard]] const ReplayedDecision* firstDifference() const;
  [[nodiscard]] const ReplayedDecision* firstOtherChoice() const;
};

struct ReplayOptions
{
  /// Go on in the abstract world with this seed where the recording gives no result any more. It
  /// starts from what the robot knows there, from `truths`, and is drawn at random otherwise.
  std::optional<std::uint64_t> continue_with_seed;
  std::vector<std::string> truths;  ///< literals of the high level
  /// Directory with other files of the same names, to be used instead of the recorded texts; empty:
  /// none. The map stays.
  std::string domain;
  /// Called with each decision as it is made; may be empty.
  std::function<void(const ReplayedDecision&)> on_decision;
};

/// Runs the recorded mission again with the reasoner and the solver in process, and with the
/// recorded results, facts and interruptions at the places where they were taken in, and compares
/// the decisions.
///
/// Nothing depends on wall time but what the result names: a policy whose solving ended by time is
/// solved with the recorded number of backups, and the clock shows the recorded stamps. With the
/// same build the decisions repeat exactly.
///
/// After a first other choice recorded results are still used while the same actions are executed
/// in the same order.
///
/// @throws InvalidArgument  the domain, the goal or a record does not fit
/// @throws Unavailable      a file of ReplayOptions::domain cannot be read
[[nodiscard]] ReplayResult replay(const RecordedMission& mission, const ReplayOptions& options);

}  // namespace kr3::executive
