#pragma once

#include <set>
#include <string>
#include <vector>

#include <kr3_reasoner/language.hpp>

#include "kr3_refinement/component_map.hpp"
#include "problems.hpp"

namespace kr3::refinement
{

/// Notes what keeps a refinement and a map from fitting a high-level description: what the language
/// alone does not show (docs/refinement.md lists it). Where it notes nothing, the three can be
/// composed.
void checkRefinement(const reasoner::Description& high_level,
                     const reasoner::Description& refinement, const ComponentMap& map,
                     Problems& problems);

/// The fluents that are no part of the world: knowledge fluents and what is defined by them.
[[nodiscard]] std::set<std::string> fluentsOfKnowledge(
    const std::vector<const reasoner::Description*>& descriptions);

}  // namespace kr3::refinement
