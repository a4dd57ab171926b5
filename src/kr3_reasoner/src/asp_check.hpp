#pragma once

#include <vector>

#include "kr3_reasoner/language.hpp"

namespace kr3::reasoner
{

/// Checks the raw answer set programming blocks of a description: their syntax and the safety of
/// their variables, by clingo; that they use the predicates that docs/language.md lists for their
/// part and otherwise only their own, which begin with `x_` and are defined somewhere; and that
/// they look at no other steps than t and t-1.
void checkAsp(const Description& description, std::vector<Diagnostic>& problems);

}  // namespace kr3::reasoner
