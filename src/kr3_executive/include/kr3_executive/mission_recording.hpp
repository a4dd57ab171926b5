#pragma once

#include <cstdint>
#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

#include "kr3_executive/domain_files.hpp"
#include "kr3_executive/method.hpp"
#include "kr3_executive/mission_log.hpp"
#include "kr3_executive/narration.hpp"

/// Inputs and decisions of a mission as numbered JSON objects, for bags and files. docs/replay.md
/// has the fields of each kind.
namespace kr3::executive
{

/// The values equal the constants of kr3_msgs/MissionInput.
enum class InputKind : std::uint8_t
{
  kDomain = 0,
  kMission = 1,
  kSkillResult = 2,
  kTold = 3,
  kCancel = 4,  ///< cancelled, out of time, or a request was refused
  kDecision = 5,
};

/// "DOMAIN", "MISSION", ...
[[nodiscard]] const char* toString(InputKind kind);

struct RecordedInput
{
  std::uint32_t sequence = 0;  ///< from 0 in each mission, without gaps
  InputKind kind = InputKind::kDomain;
  double stamp_s = 0.0;  ///< on the driver's clock
  std::string data;      ///< one JSON object; numbers have all their digits
};

/// {"sequence": 3, "kind": "TOLD", "stamp_s": 1.5, "data": {...}} in one line.
[[nodiscard]] std::string toJsonLine(const RecordedInput& input);

/// One input a line; empty lines are skipped.
/// @param name  of the source, for messages
/// @throws InvalidArgument  "name:line: what is wrong"
[[nodiscard]] std::vector<RecordedInput> readInputs(std::istream& lines, const std::string& name);

/// How a mission is planned, as it is recorded with it.
struct PlanningMethod
{
  Method method = Method::kPa;
  BaselineOptions baseline;
};

/// What reasoner_node tells of its parameters, one JSON object.
/// @param history_window  which the node does not know
/// @throws InvalidArgument  it is malformed
[[nodiscard]] ReasonerSettings settingsFromText(const std::string& text,
                                                std::uint32_t history_window);

/// Turns what a driver reports into recorded inputs: the domain and the mission at its start, then
/// each input and decision in order. From these alone the mission can be computed again
/// (replay.hpp).
///
/// Not thread-safe beyond what Mission promises of its observer.
class MissionRecorder : public MissionObserver
{
public:
  using Clock = std::function<double()>;  ///< s, that of the driver
  using Sink = std::function<void(const RecordedInput&)>;

  /// @param sink  called with each input, in the mission's thread; must not throw
  MissionRecorder(const DomainFiles& domain, const reasoner::PlanOptions& plan, Clock clock,
                  Sink sink, const PlanningMethod& method = {});

  [[nodiscard]] Interest interest() const override { return {false, true, false}; }
  void onInput(const Input& input) override;
  void onDecision(const ReportedDecision& decision) override;
  void onEvent(const ReportedEvent& /*event*/) override {}
  void onBelief(const ReportedBelief& /*belief*/) override {}
  void onSnapshot(const Snapshot& /*snapshot*/) override {}

private:
  void add(InputKind kind, std::string data);

  std::string domain_;  // JSON
  std::string plan_;    // JSON
  std::string method_;  // JSON
  Clock clock_;
  Sink sink_;
  std::uint32_t sequence_ = 0;
  bool begun_ = false;  // a mission; what is told before is in its history
};

}  // namespace kr3::executive
