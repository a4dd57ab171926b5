#pragma once

#include <vector>

#include "diagnostics.hpp"
#include "kr3_reasoner/language.hpp"
#include "symbols.hpp"

namespace kr3::reasoner
{

/// Checks a description and completes its sorts. Returns every problem found.
[[nodiscard]] std::vector<Diagnostic> check(Description& description);

/// Checks that a ground literal or action fits a description.
[[nodiscard]] std::vector<Diagnostic> checkGround(const Literal& literal, const Symbols& symbols);
[[nodiscard]] std::vector<Diagnostic> checkGroundAction(const Atom& action, const Symbols& symbols);

}  // namespace kr3::reasoner
