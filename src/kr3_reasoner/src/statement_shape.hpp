#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "kr3_reasoner/language.hpp"

namespace kr3::reasoner
{

/// Variables that stand in these terms. Private to the package, as all of this file.
[[nodiscard]] std::set<std::string> variablesOf(const std::vector<Term>& terms);

/// How often each variable stands in a body.
[[nodiscard]] std::map<std::string, int> variableUses(const Body& body);

/// Whether a statement is `impossible A, B if A != B`.
[[nodiscard]] bool isPairwiseExclusion(const Executability& rule);

/// Whether a condition `f != v` of a constraint may rest on the constraint's own head. Its support
/// then is that it held before, as for any literal that inertia keeps.
[[nodiscard]] bool isCircular(const Description& description, const StateConstraint& constraint,
                              const Condition& condition);

}  // namespace kr3::reasoner
