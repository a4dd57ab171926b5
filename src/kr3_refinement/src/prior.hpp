#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "kr3_refinement/low_level_domain.hpp"
#include "kr3_refinement/pomdp_task.hpp"
#include "kr3_refinement/zoom.hpp"
#include "semantics.hpp"

namespace kr3::refinement
{

/// The coarse name of each fine ground fluent, with the indices of the fluents that it stands for.
using CoarseFluents = std::map<std::string, std::vector<std::size_t>>;
[[nodiscard]] CoarseFluents coarseFluents(const LowLevelDomain& domain, const Semantics& semantics);

/// The value of a coarse fluent, given those of its fine fluents. A boolean one is true when a
/// component's is; another has the value that all components agree on, else "several".
[[nodiscard]] std::string coarseValue(const std::vector<std::string>& fine_values, bool boolean);

/// The fluents that need the value `elsewhere`: the hidden ones, and fine ones with mass outside
/// the zoom.
/// @return names of fine ground fluents
[[nodiscard]] std::set<std::string> withElsewhere(const LowLevelDomain& domain, const Zoom& zoom,
                                                  const InitialKnowledge& knowledge);

/// Weights of states under the initial knowledge (DESIGN.md 4.3), normalised.
///
/// @param states  of `semantics`, shape [states]
/// @throws InvalidArgument, FailedPrecondition  as generatePomdp
[[nodiscard]] std::vector<double> initialWeights(const LowLevelDomain& domain, const Zoom& zoom,
                                                 const InitialKnowledge& knowledge,
                                                 const Semantics& semantics,
                                                 const std::vector<Values>& states);

}  // namespace kr3::refinement
