#pragma once

#include <vector>

#include "kr3_reasoner/language.hpp"

namespace kr3::reasoner
{

/// Completes the elements of all sorts by those of their member sorts, in the order of declaration
/// and without repetition. Reports unknown members, cycles, elements that are listed twice, and
/// more than kMaxElements elements in all.
///
/// @return false when there were too many elements: the rest is then not worth checking
[[nodiscard]] bool completeSorts(Description& description, std::vector<Diagnostic>& problems);

}  // namespace kr3::reasoner
