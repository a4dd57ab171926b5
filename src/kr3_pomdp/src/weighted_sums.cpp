#include "weighted_sums.hpp"

#include <algorithm>

#include "multiversion.hpp"

namespace kr3::pomdp
{

namespace
{

/// Four rows at once, so that the sums are read and written a quarter as often.
KR3_POMDP_MULTIVERSION void addRows(const double* rows, const std::size_t* places,
                                    const double* weights, std::size_t num_rows, double* sums,
                                    std::size_t count)
{
  std::size_t i = 0;
  for (; i + 4 <= num_rows; i += 4)
  {
    const double* a = rows + places[i] * count;
    const double* b = rows + places[i + 1] * count;
    const double* c = rows + places[i + 2] * count;
    const double* d = rows + places[i + 3] * count;
    for (std::size_t v = 0; v < count; ++v)
    {
      sums[v] += (weights[i] * a[v] + weights[i + 1] * b[v]) +
                 (weights[i + 2] * c[v] + weights[i + 3] * d[v]);
    }
  }
  for (; i < num_rows; ++i)
  {
    const double* row = rows + places[i] * count;
    for (std::size_t v = 0; v < count; ++v)
    {
      sums[v] += weights[i] * row[v];
    }
  }
}

}  // namespace

void sumWeightedRows(const double* rows, const std::vector<std::size_t>& places,
                     const std::vector<double>& weights, std::vector<double>& sums)
{
  std::fill(sums.begin(), sums.end(), 0.0);
  addRows(rows, places.data(), weights.data(), places.size(), sums.data(), sums.size());
}

}  // namespace kr3::pomdp
