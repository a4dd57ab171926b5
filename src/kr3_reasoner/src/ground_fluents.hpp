#pragma once

#include <string>
#include <vector>

#include "kr3_reasoner/transition_system.hpp"

namespace kr3::reasoner
{

/// All tuples of elements of these sorts, the last position varying fastest.
[[nodiscard]] std::vector<std::vector<std::string>> argumentTuples(
    const std::vector<std::string>& sorts, const Description& description);

/// `move(rob1, office)` of a name and constants.
[[nodiscard]] std::string groundName(const std::string& symbol,
                                     const std::vector<std::string>& arguments);

/// All ground fluents of a description, statics left out, in the order of declaration and of the
/// sorts' elements.
[[nodiscard]] std::vector<GroundFluent> groundFluents(const Description& description);

/// All ground instances of an action.
[[nodiscard]] std::vector<std::string> groundActions(const ActionDeclaration& action,
                                                     const Description& description);

/// `fluent = value`.
[[nodiscard]] Literal literalOf(const GroundFluent& fluent, const std::string& value);

}  // namespace kr3::reasoner
