#pragma once

#include <string>
#include <vector>

#include "kr3_reasoner/language.hpp"

namespace kr3::reasoner
{

/// Checks a description and completes its sorts. Returns every problem found, in the order of the
/// parts.
[[nodiscard]] std::vector<Diagnostic> check(Description& description);

/// Checks that a ground literal or action fits a description.
[[nodiscard]] std::vector<Diagnostic> checkGround(const Literal& literal,
                                                  const Description& description);
[[nodiscard]] std::vector<Diagnostic> checkGroundAction(const Atom& action,
                                                        const Description& description);

/// The candidate nearest to `name` by edit distance, as "; did you mean 'x'?", or nothing when none
/// is near.
[[nodiscard]] std::string suggestion(const std::string& name,
                                     const std::vector<std::string>& candidates);

/// One line "file:line:column: message" for each problem. @throws InvalidArgument  when there is
/// one
void throwIfAny(const std::vector<Diagnostic>& problems);

}  // namespace kr3::reasoner
