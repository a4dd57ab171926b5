#pragma once

#include <string>
#include <vector>

#include <kr3_reasoner/language.hpp>

#include "kr3_refinement/low_level_domain.hpp"

namespace kr3::refinement
{

/// The fluents that the theory of observations adds for one observed fluent f.
struct ObservationFluents
{
  std::string tested;        ///< knowledge: it was tested whether f has this value
  std::string observed;      ///< defined: tested, and it has (directly observed to be so)
  std::string found;         ///< defined, coarse: some part of it was observed
  std::string may_discover;  ///< defined, coarse: not found, and a part was not tested yet
  std::string failure;       ///< defined, coarse: all parts were tested, and none has it
};

/// The names for a fluent: `tested_f`, `observed_f`, `found_f`, `may_discover_f`, `failure_f`.
[[nodiscard]] ObservationFluents observationFluents(const std::string& fluent);

/// D_L with its theory of observations: for each fluent f that an action observes, with the
/// arguments and, unless it is boolean, the value of f as arguments,
///
///     a causes tested_f(X, V).                            for `a observes f(X) = V`
///     a causes tested_f(X, V).                            for `a observes f(X)`, all V
///     observed_f(X, V) if tested_f(X, V), f(X) = V.
///     found_f(X*, V*) if observed_f(X, V), part_of(V) = V*.
///     may_discover_f(X*, V*) if -found_f(X*, V*), -tested_f(X, V), part_of(V) = V*.
///     failure_f(X*, V*) if -found_f(X*, V*), -may_discover_f(X*, V*).
///
/// where the starred terms are wholes (of magnified sorts; others stay). Knowledge is the
/// mission's, not one robot's, and starts afresh with each high-level action. Not for a POMDP's
/// states: these leave knowledge out, and the belief takes its place.
///
/// Source: Sridharan et al. (JAIR 65, 2019), theory of observations: directly_observed is true,
/// false or undetermined where observed_f holds, where tested_f holds without it, and where neither
/// does; indirectly_observed is true where found_f holds, false where failure_f does.
/// Deviation: the test is remembered, not its result, so a change by the robot itself is followed;
/// and no robot is named.
///
/// @throws InvalidArgument  the domain has other declarations of these names
[[nodiscard]] reasoner::Description withObservationTheory(const LowLevelDomain& domain);

/// The knowledge with which a high-level action starts: every knowledge fluent of a description is
/// false.
[[nodiscard]] std::vector<reasoner::Literal> freshKnowledge(
    const reasoner::Description& description);

}  // namespace kr3::refinement
