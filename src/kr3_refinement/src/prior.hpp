#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "kr3_refinement/low_level_domain.hpp"
#include "kr3_refinement/models.hpp"
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

/// What the models say of a fluent of the low level alone before anything is known of it; nothing
/// for any other fluent, and for a boolean one without a prior, which is false then.
/// @param symbol  the fluent's name
[[nodiscard]] std::optional<Distribution> priorOf(const LowLevelDomain& domain,
                                                  const Models& models, const std::string& symbol);

/// The same for each ground fluent of some constants that the knowledge is silent about.
/// @return by the ground fluent's name
[[nodiscard]] std::map<std::string, Distribution> priorsOf(const LowLevelDomain& domain,
                                                           const Models& models,
                                                           const std::set<std::string>& constants,
                                                           const InitialKnowledge& knowledge);

/// The fluents that need the value `elsewhere`: the hidden ones, and fine ones with mass outside
/// the zoom.
/// @param priors  as priorsOf()
/// @return names of fine ground fluents
[[nodiscard]] std::set<std::string> withElsewhere(
    const LowLevelDomain& domain, const Zoom& zoom, const InitialKnowledge& knowledge,
    const std::map<std::string, Distribution>& priors);

/// Weights of states under the initial knowledge (docs/refinement.md), normalised.
///
/// @param states  of `semantics`, shape [states]
/// @throws InvalidArgument, FailedPrecondition  as generatePomdp
[[nodiscard]] std::vector<double> initialWeights(const LowLevelDomain& domain, const Zoom& zoom,
                                                 const InitialKnowledge& knowledge,
                                                 const std::map<std::string, Distribution>& priors,
                                                 const Semantics& semantics,
                                                 const std::vector<Values>& states);

}  // namespace kr3::refinement
