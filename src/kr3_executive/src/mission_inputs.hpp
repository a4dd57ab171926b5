#pragma once

#include <atomic>
#include <cstdint>
#include <functional>

#include <kr3_reasoner/reasoner.hpp>

#include "kr3_executive/interfaces.hpp"
#include "kr3_executive/mission_log.hpp"

/// What every mission does with what enters it from outside.
namespace kr3::executive
{

/// Has an action executed; one that was unavailable or too late is tried again, unless the mission
/// is cancelled.
/// @param note  is told each try
/// @throws Error  of the last try
[[nodiscard]] LowLevelResult executeNoting(LowLevelExecutor& executor, const LowLevelAction& action,
                                           const FluentLookup& believed, std::uint32_t max_retries,
                                           const std::atomic<bool>& cancel,
                                           const std::function<void(const Input&)>& note);

/// A fact that a person tells, as an observation whose step is yet to be set.
/// @throws InvalidArgument  it does not fit the description, or its confidence is not in (0, 1]
[[nodiscard]] reasoner::Record checkedFact(const reasoner::Record& record,
                                           const reasoner::Description& high_level);

}  // namespace kr3::executive
