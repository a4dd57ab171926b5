#pragma once

#include <cstddef>

namespace kr3::reasoner
{

/// What a diagnosis may assume besides exceptions to defaults.
struct Assumable
{
  bool exogenous = false;    ///< exogenous actions
  bool retractions = false;  ///< that records of confidence below 1 are wrong
};

constexpr std::size_t kNumAssumables = 4;

/// Tells the values of Assumable apart, below kNumAssumables.
[[nodiscard]] constexpr std::size_t indexOf(const Assumable& assumable)
{
  return (assumable.exogenous ? 1U : 0U) + (assumable.retractions ? 2U : 0U);
}

/// Minimal prices of an explanation; retractions weigh more than all else.
struct Price
{
  int retractions = 0;
  int assumptions = 0;

  void add(int price, bool is_retraction) { (is_retraction ? retractions : assumptions) += price; }

  [[nodiscard]] int sum() const { return retractions + assumptions; }
};

}  // namespace kr3::reasoner
