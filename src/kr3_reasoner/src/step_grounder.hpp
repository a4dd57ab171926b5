#pragma once

#include "search_limit.hpp"
#include "signature.hpp"
#include "statics.hpp"
#include "step_program.hpp"

namespace kr3::reasoner
{

/// Whether groundStep can ground a description: raw answer set programming code, and comparisons of
/// actions by `<`, only clingo can.
[[nodiscard]] bool canGroundStep(const Description& description);

/// Grounds what a description says of one state and of one transition. The rules are those of
/// Encoding, up to conditions that a literal `not F = V` says shorter. Private to the package.
///
/// @param vocabulary  gets the constants that only rules mention
/// @param signature   numbers of what is ground; without exogenous actions, their laws are left out
[[nodiscard]] StepProgram groundStep(Vocabulary& vocabulary, const Statics& statics,
                                     const Signature& signature, const SearchLimit& limit = {});

}  // namespace kr3::reasoner
