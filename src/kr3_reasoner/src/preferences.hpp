#pragma once

#include <vector>

#include "kr3_reasoner/language.hpp"

namespace kr3::reasoner
{

/// Reports defaults that are declared twice, preferences about unknown defaults or with a wrong
/// number of arguments, and preferences that close a cycle.
void checkPreferences(const Description& description, std::vector<Diagnostic>& problems);

}  // namespace kr3::reasoner
