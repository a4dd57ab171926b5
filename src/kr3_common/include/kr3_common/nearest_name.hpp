#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace kr3
{

/// Levenshtein's distance: the least number of characters to insert, delete or replace that turns
/// `a` into `b`. Takes |a| |b| steps.
///
/// @param limit  the answer is exact up to here; a larger distance may be returned as limit + 1,
///               which is faster
[[nodiscard]] std::size_t editDistance(std::string_view a, std::string_view b,
                                       std::size_t limit = std::numeric_limits<std::size_t>::max() -
                                                           1);

/// The candidate with the least edit distance to `name`, the first of several.
///
/// @param limit  the largest distance that counts as near
/// @return nullptr when no candidate is that near; otherwise an element of `candidates`
[[nodiscard]] const std::string* nearestName(
    std::string_view name, const std::vector<std::string>& candidates,
    std::size_t limit = std::numeric_limits<std::size_t>::max() - 1);

}  // namespace kr3
