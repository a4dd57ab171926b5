#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace kr3::pomdp
{

/// sums[v] = sum_i weights[i] rows[places[i]][v]: the values of many vectors at a sparse belief.
///
/// @param rows     row-major, shape [states, count]
/// @param places   the rows that are summed up, shape of `weights`
/// @param sums     shape [count], overwritten
void sumWeightedRows(const double* rows, const std::vector<std::size_t>& places,
                     const std::vector<double>& weights, std::vector<double>& sums);

}  // namespace kr3::pomdp
