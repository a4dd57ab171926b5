#pragma once

#include <vector>

#include "kr3_reasoner/language.hpp"

namespace kr3::reasoner
{

/// Reports definitions that rest on their own negation: then a state of the inertial fluents would
/// not settle the defined ones. What matters are the ground instances: `win(X) if move(X, Y),
/// -win(Y)` is a definition when the static `move` has no cycle. The same for statics that axioms
/// derive. Private to the package.
///
/// A condition for well-founded descriptions in the sense of Gelfond and Inclezan, "Some properties
/// of system descriptions of AL_d" (2013), checked on ground rules instead of predicates; inertial
/// fluents end a path, as a state gives all of them values.
///
/// @param description  without any other problem; the cost is that of its text, and of grounding
///                     definitions only where names alone leave it open
void checkDefinitions(const Description& description, std::vector<Diagnostic>& problems);

}  // namespace kr3::reasoner
