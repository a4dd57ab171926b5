#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "kr3_executive/driver.hpp"

namespace kr3::executive
{

/// A mission that has not ended: a node that is started again goes on with it.
struct MissionUnderWay
{
  std::string goal;
  std::uint32_t max_hl_actions = 0;  ///< that are left to it
  double time_left_s = 0.0;          ///< 0 = no limit
};

/// Writes knowledge as JSON; the old file stays whole until the new one is.
/// @throws Unavailable  the file cannot be written
void writeKnowledge(const std::string& path, const Knowledge& knowledge,
                    const std::optional<MissionUnderWay>& mission = std::nullopt);

/// @return nothing when there is no such file
/// @throws Unavailable      it cannot be read
/// @throws InvalidArgument  it is malformed
[[nodiscard]] std::optional<Knowledge> readKnowledge(const std::string& path);

/// The mission that was under way when the file was written; nothing when there was none, or no
/// such file. Errors as readKnowledge().
[[nodiscard]] std::optional<MissionUnderWay> readMissionUnderWay(const std::string& path);

}  // namespace kr3::executive
