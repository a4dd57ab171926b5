#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace kr3::reasoner::bench
{

/// A long mission in the rooms x objects domain: at each step the robot walks and sees where it is,
/// at every tenth it finds a book missing, and after each step the reasoner is asked where the
/// robot and that book are.
///
/// @param window  as in ReasonerOptions
/// @return `steps`; mean CPU milliseconds of a step: `mean_ms`, `first_ms` of the first 100 steps,
///         `last_ms` of the last 100, `ratio` of the two; `records` that are kept
/// @throws NotFound  no such domain or history
[[nodiscard]] nlohmann::json mission(const std::string& domain, const std::string& history,
                                     int steps, int window);

}  // namespace kr3::reasoner::bench
