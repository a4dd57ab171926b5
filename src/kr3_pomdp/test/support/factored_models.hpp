#pragma once

#include <cstdint>

#include "kr3_pomdp/factored_model.hpp"

namespace kr3::pomdp::test
{

/// Two variables that the robot sees (of 2 and 3 values) among two that it does not (of 3 and 2),
/// two sensors and random factors with some zeros; rewards in [-1, 1].
[[nodiscard]] FactoredModel randomFactored(std::uint64_t seed);

}  // namespace kr3::pomdp::test
