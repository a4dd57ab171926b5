#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "random_case.hpp"

/// What tests on many cases run over.
namespace kr3::reasoner
{

/// The seeds of a run: KR3_REASONER_CASES of them, from KR3_REASONER_SEED or 1 on.
struct Seeds
{
  std::uint64_t first = 1;
  std::uint64_t count = 0;
};

/// A number in the environment, or another one.
inline std::uint64_t numberFrom(const char* variable, std::uint64_t otherwise)
{
  const char* text = std::getenv(variable);
  return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

/// @param cases  how many seeds when the environment says nothing
inline Seeds seedsOfRun(std::uint64_t cases)
{
  return {numberFrom("KR3_REASONER_SEED", 1), numberFrom("KR3_REASONER_CASES", cases)};
}

/// Calls `check(drawn, seed)` for the random case of each seed, until a test fails fatally.
template <typename Check>
void forEachCase(const Seeds& seeds, const CaseSize& size, Check check)
{
  for (std::uint64_t seed = seeds.first; seed < seeds.first + seeds.count; ++seed)
  {
    const RandomCase drawn = randomCase(seed, size);
    SCOPED_TRACE(toString(drawn));
    check(drawn, seed);
    if (testing::Test::HasFatalFailure())
    {
      return;
    }
  }
}

/// The descriptions that come with the repository, and those of the tests.
inline std::vector<std::string> shippedDomains()
{
  std::vector<std::string> paths = {std::string(KR3_TEST_DIR) + "/data/lamps.kr3"};
  for (const auto& entry : std::filesystem::directory_iterator(KR3_DOMAINS_DIR))
  {
    const std::filesystem::path path = entry.path() / "domain.kr3";
    if (std::filesystem::exists(path))
    {
      paths.push_back(path.string());
    }
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

}  // namespace kr3::reasoner
