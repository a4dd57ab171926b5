#pragma once

#include <string>
#include <vector>

#include <kr3_reasoner/language.hpp>

#include "semantics.hpp"

namespace kr3::refinement
{

/// A high-level state given as literals, as values: booleans not listed are false, other fluents
/// not listed unknown.
/// @throws InvalidArgument  a literal that is no `f = v` of the description, or two values of one
/// fluent
[[nodiscard]] Values valuesOf(const Semantics& semantics,
                              const std::vector<reasoner::Literal>& state);

/// The literal `f = v` for a fluent's value.
[[nodiscard]] reasoner::Literal literalOf(const Semantics& semantics, std::size_t fluent,
                                          int value);

/// A ground fluent's name without regard to spaces, as the language writes it: "in_hand(rob1,tb1)"
/// is "in_hand(rob1, tb1)".
[[nodiscard]] std::string normalised(const std::string& fluent);

}  // namespace kr3::refinement
