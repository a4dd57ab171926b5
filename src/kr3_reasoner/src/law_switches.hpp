#pragma once

#include <string>

#include <clingo.hh>

#include "laws.hpp"

namespace kr3::reasoner
{

/// The description with a static `_law(n)` among the conditions of each law n, which a solver can
/// then be told to leave out. Private to the package.
[[nodiscard]] Description switchable(const Description& description, const Laws& laws);

/// Declares the switches (part `base`) as externals.
[[nodiscard]] std::string lawSwitches();

/// Lets fluents whose definition is left out be true or false (part `state(_t)`).
[[nodiscard]] std::string openDefinitions(const Description& description, const Laws& laws);

/// The external of a law.
[[nodiscard]] Clingo::Symbol switchOf(std::size_t law);

}  // namespace kr3::reasoner
