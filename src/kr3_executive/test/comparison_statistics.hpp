#pragma once

// Chi-squared tests of counts, several together.

#include <cstddef>
#include <map>
#include <string>

#include <boost/math/distributions/chi_squared.hpp>

namespace kr3::executive::test
{

/// How often each result came up, or how likely it is.
using Counts = std::map<std::string, double>;

inline constexpr double kSignificance = 0.001;  // of a whole comparison, shared by its tests
inline constexpr double kLeastExpected = 8.0;   // rarer results are counted together

/// p-values of several tests together.
struct Comparison
{
  double least = 1.0;
  std::size_t tests = 0;
  std::string where;

  void add(double p, const std::string& what)
  {
    ++tests;
    if (p < least)
    {
      least = p;
      where = what;
    }
  }
  /// Bonferroni: any of the tests rejects at its share of the significance.
  [[nodiscard]] bool rejected() const { return least < kSignificance / static_cast<double>(tests); }
};

inline double chiSquaredTail(double statistic, std::size_t cells)
{
  if (cells < 2)
    return 1.0;
  const boost::math::chi_squared distribution(static_cast<double>(cells - 1));
  return boost::math::cdf(boost::math::complement(distribution, statistic));
}

/// Pearson's test of counts against probabilities. A result that has no probability rejects.
inline double fitP(const Counts& observed, const Counts& probabilities, double trials)
{
  double statistic = 0.0;
  double rest_expected = 0.0;
  double rest_observed = trials;
  std::size_t cells = 0;
  for (const auto& [result, count] : observed)
  {
    if (count > 0.0 && probabilities.count(result) == 0)
      return 0.0;
  }
  for (const auto& [result, probability] : probabilities)
  {
    const double expected = probability * trials;
    if (expected < kLeastExpected)
    {
      rest_expected += expected;
      continue;
    }
    const auto found = observed.find(result);
    const double count = found == observed.end() ? 0.0 : found->second;
    statistic += (count - expected) * (count - expected) / expected;
    rest_observed -= count;
    ++cells;
  }
  if (rest_expected >= kLeastExpected)
  {
    statistic += (rest_observed - rest_expected) * (rest_observed - rest_expected) / rest_expected;
    ++cells;
  }
  return chiSquaredTail(statistic, cells);
}

/// Pearson's test of homogeneity of two samples of the same size.
inline double sameP(const Counts& a, const Counts& b)
{
  Counts total = a;
  for (const auto& [result, count] : b)
    total[result] += count;
  double statistic = 0.0;
  std::size_t cells = 0;
  double rest_a = 0.0;
  double rest_b = 0.0;
  const auto add = [&](double in_a, double in_b) {
    const double expected = (in_a + in_b) / 2.0;
    statistic +=
        ((in_a - expected) * (in_a - expected) + (in_b - expected) * (in_b - expected)) / expected;
    ++cells;
  };
  for (const auto& [result, count] : total)
  {
    const auto in_a = a.find(result);
    const auto in_b = b.find(result);
    const double count_a = in_a == a.end() ? 0.0 : in_a->second;
    const double count_b = in_b == b.end() ? 0.0 : in_b->second;
    if (count < 2.0 * kLeastExpected)
    {
      rest_a += count_a;
      rest_b += count_b;
    }
    else
      add(count_a, count_b);
  }
  if (rest_a + rest_b >= 2.0 * kLeastExpected)
    add(rest_a, rest_b);
  return chiSquaredTail(statistic, cells);
}

}  // namespace kr3::executive::test
