#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace kr3::pomdp
{

/// How far a vector is above all of a set, at the belief where that is most:
/// max_b min_i b . (vector - set_i). It lies between `lower` and `upper`, each of which is checked
/// without regard to how it was found.
struct Margin
{
  double lower;                ///< at `belief`
  double upper;                ///< of a convex combination of the set: at no belief more
  std::vector<double> belief;  ///< shape [num_states]
};

/// The margin of a vector over a set, by linear programming.
///
/// @param vector     shape [num_states]
/// @param set        each of the same shape; empty: the margin is infinite, at a certain belief
/// @param threshold  the search ends as soon as the margin is known to be above this or not;
/// without
///                   it the search goes on until `lower` and `upper` meet, up to rounding
/// Source: Littman's test of domination, in Cassandra, Littman and Zhang (1997), Sec. 2; here as a
/// matrix game between beliefs and vectors, solved by the revised simplex method.
[[nodiscard]] Margin marginOver(const std::vector<double>& vector,
                                const std::vector<const double*>& set,
                                std::optional<double> threshold = std::nullopt);

}  // namespace kr3::pomdp
