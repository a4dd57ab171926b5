#pragma once

#include <cstdint>
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

#include "models.hpp"

/// What tests on many random models run over.
namespace kr3::pomdp::test
{

/// A number in the environment, or another one.
inline std::uint64_t numberFrom(const char* variable, std::uint64_t otherwise)
{
  const char* text = std::getenv(variable);
  return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

/// Calls `check(model, seed)` for the random model of each seed, until a test fails fatally:
/// KR3_POMDP_CASES of them, or else `cases`, from KR3_POMDP_SEED or 1 on. Each fourth is a search.
template <typename Check>
void forEachModel(std::uint64_t cases, Check check)
{
  const std::uint64_t first = numberFrom("KR3_POMDP_SEED", 1);
  const std::uint64_t end = first + numberFrom("KR3_POMDP_CASES", cases);
  for (std::uint64_t seed = first; seed < end && !testing::Test::HasFatalFailure(); ++seed)
  {
    if (seed % 4 == 0)
    {
      SCOPED_TRACE("search, seed " + std::to_string(seed));
      check(randomSearch(seed), seed);
      continue;
    }
    const RandomShape shape = randomShape(seed);
    SCOPED_TRACE("seed " + std::to_string(seed) + ": " + toString(shape));
    check(randomModel(shape, seed), seed);
  }
}

}  // namespace kr3::pomdp::test
