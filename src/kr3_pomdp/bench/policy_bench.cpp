// Time of one action look-up among 2000 alpha vectors of 1000 states.

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include <benchmark/benchmark.h>

#include "kr3_pomdp/policy.hpp"

namespace
{

constexpr std::size_t kNumStates = 1000;
constexpr std::size_t kNumVectors = 2000;

double uniform(std::mt19937_64& random)
{
  return static_cast<double>(random() >> 11U) * 0x1.0p-53;
}

kr3::pomdp::Policy randomPolicy()
{
  std::mt19937_64 random(1);
  std::vector<kr3::pomdp::AlphaVector> vectors(kNumVectors);
  for (std::size_t v = 0; v < kNumVectors; ++v)
  {
    vectors[v].action = v % 10;
    for (std::size_t s = 0; s < kNumStates; ++s)
    {
      vectors[v].values.push_back(uniform(random));
    }
  }
  return {kNumStates, vectors};
}

/// The argument is the number of states with a probability.
void bestAt(benchmark::State& state)
{
  const kr3::pomdp::Policy policy = randomPolicy();
  const auto support = static_cast<std::size_t>(state.range(0));
  std::vector<double> probabilities(kNumStates, 0.0);
  for (std::size_t i = 0; i < support; ++i)
  {
    probabilities[i * kNumStates / support] = 1.0 / static_cast<double>(support);
  }
  const kr3::pomdp::Belief belief(probabilities);
  for (auto _ : state)
  {
    benchmark::DoNotOptimize(policy.bestAt(belief));
  }
}

BENCHMARK(bestAt)->Arg(1)->Arg(10)->Arg(50)->Arg(1000)->Unit(benchmark::kMicrosecond);

}  // namespace

BENCHMARK_MAIN();
