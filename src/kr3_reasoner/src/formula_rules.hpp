#pragma once

#include <string>

#include "kr3_reasoner/language.hpp"

namespace kr3::reasoner
{

/// Rules by which `root` is true at the step `n` exactly when a formula is; the part has the
/// parameter n. Private to the package.
[[nodiscard]] std::string formulaRules(const Formula& formula, const Description& description,
                                       const std::string& root);

}  // namespace kr3::reasoner
