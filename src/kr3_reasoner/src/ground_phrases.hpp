#pragma once

#include <string>

#include "kr3_reasoner/language.hpp"
#include "symbols.hpp"

namespace kr3::reasoner
{

/// As the functions of the same names in language.hpp, for many texts about one description: its
/// sorts are indexed only once. Private to the package.
[[nodiscard]] Literal parseGroundLiteral(const std::string& text, const Symbols& symbols);
[[nodiscard]] Atom parseGroundAction(const std::string& text, const Symbols& symbols);

}  // namespace kr3::reasoner
