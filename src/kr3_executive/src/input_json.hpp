#pragma once

#include <nlohmann/json.hpp>

#include "kr3_executive/domain_files.hpp"
#include "kr3_executive/mission_log.hpp"
#include "kr3_executive/mission_recording.hpp"

/// JSON of what enters a mission and of what it decides (docs/replay.md). Reading throws
/// nlohmann::json::exception where a field is missing or of another type, and InvalidArgument where
/// its value is wrong.
namespace kr3::executive
{

/// Raised when a field changes its meaning.
inline constexpr int kRecordingVersion = 1;

[[nodiscard]] nlohmann::json toJson(const ReasonerSettings& settings);
[[nodiscard]] ReasonerSettings settingsFromJson(const nlohmann::json& json);

/// The field "code" of an input.
[[nodiscard]] ErrorCode codeFromJson(const nlohmann::json& item);

[[nodiscard]] nlohmann::json toJson(const DomainFiles& domain);
[[nodiscard]] DomainFiles domainFromJson(const nlohmann::json& json);

/// Without `on_horizon`.
[[nodiscard]] nlohmann::json toJson(const reasoner::PlanOptions& plan);
[[nodiscard]] reasoner::PlanOptions planOptionsFromJson(const nlohmann::json& json);

[[nodiscard]] nlohmann::json toJson(const PlanningMethod& method);
/// @throws InvalidArgument  no such method or way of planning
[[nodiscard]] PlanningMethod methodFromJson(const nlohmann::json& json);

[[nodiscard]] nlohmann::json toJson(const MissionBegun& mission);
[[nodiscard]] MissionBegun missionFromJson(const nlohmann::json& json);

[[nodiscard]] nlohmann::json toJson(const SkillEnded& skill);
[[nodiscard]] SkillEnded skillFromJson(const nlohmann::json& json);

[[nodiscard]] nlohmann::json toJson(const FactTold& told);
[[nodiscard]] FactTold toldFromJson(const nlohmann::json& json);

[[nodiscard]] nlohmann::json toJson(const ReportedDecision& decision);
[[nodiscard]] ReportedDecision decisionFromJson(const nlohmann::json& json);

}  // namespace kr3::executive
