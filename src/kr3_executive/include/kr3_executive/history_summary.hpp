#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "kr3_executive/interfaces.hpp"

namespace kr3::executive
{

/// Source of the records that stand for earlier ones.
inline constexpr char kSummarySource[] = "summary";

/// A history that begins later: what is earlier than a step is replaced by observations of what
/// followed from it, and steps count from there. So a robot that works for months starts, stores
/// and publishes histories of bounded length. (Within a mission the reasoner progresses, which is
/// exact; history_window.hpp.)
///
/// What was observed, or came of actions, is observed at step 0; what a default gives is left to
/// the default; where a fluent's value is not known, the values that it was seen not to have stay.
/// Lost are earlier steps as such: a later surprise is explained by what happened since, or by an
/// error of these observations.
///
/// @param history     consistent; the reasoner holds it
/// @param first_step  that becomes step 0, in [1, current step]
/// @param reasoner    holds the result afterwards, or again `history` if there is none
/// @param confidence  of a literal that is entailed at `first_step`, (0, 1]
/// @return nothing if the shorter history would not entail the same, at its first step and now
[[nodiscard]] std::optional<std::vector<reasoner::Record>> summarised(
    const std::vector<reasoner::Record>& history, int first_step, HighLevelReasoner& reasoner,
    const std::function<double(const std::string& literal)>& confidence);

}  // namespace kr3::executive
