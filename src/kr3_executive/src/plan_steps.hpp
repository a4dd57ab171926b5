#pragma once

#include <kr3_reasoner/reasoner.hpp>

namespace kr3::executive
{

/// Actions that occur together are executed one after the other.
[[nodiscard]] reasoner::Plan serialised(const reasoner::Plan& plan);

}  // namespace kr3::executive
