#pragma once

#include <set>
#include <string>
#include <vector>

#include <kr3_reasoner/language.hpp>

#include "kr3_refinement/low_level_domain.hpp"
#include "kr3_refinement/models.hpp"

namespace kr3::refinement
{

/// A constant and why it matters to a transition.
struct RelevantConstant
{
  std::string name;
  std::string reason;  ///< "argument of grasp(rob1, tb1)", "value of loc(tb1), on which grasp(rob1,
                       ///< tb1) depends"
};

/// The part of a domain that matters to one high-level action.
struct Zoom
{
  std::string action;  ///< the high-level action, "grasp(rob1, tb1)"
  std::vector<RelevantConstant>
      relevant;  ///< high-level constants, in the order in which they were found
  std::vector<reasoner::Literal> start;    ///< s1: the literals over relevant constants
  std::vector<reasoner::Literal> effects;  ///< literals of s2 that are not in s1
  std::set<std::string> constants;  ///< low-level constants: the relevant ones and their components
};

/// Relevant part for T = <s1, a, s2>: constants of a; of literals in s1 or s2 but not both; values
/// in s1 of fluents in executability conditions of a that are ground once a's arguments are
/// (docs/refinement.md).
///
/// @param state   s1, as literals `f = v` of the high level. Boolean fluents that it does not list
/// are false; a valued
///                fluent that it does not list is unknown and no condition on it holds. A
///                hypothesis of the plan (where the target is expected) belongs into it.
/// @param action  ground action of the high level. A non-deterministic one is taken to have its
/// first outcome.
/// @throws FailedPrecondition  the action is impossible in s1 (names the condition's place),
/// changes nothing, or a value
///                             it depends on is missing
[[nodiscard]] Zoom zoom(const LowLevelDomain& domain, const std::vector<reasoner::Literal>& state,
                        const reasoner::Atom& action);

/// Nothing zoomed away: all constants, with a goal in the place of an action's effects (the flat
/// POMDP of the paper's baseline POMDP-1).
[[nodiscard]] Zoom wholeDomain(const LowLevelDomain& domain,
                               const std::vector<reasoner::Literal>& state,
                               const std::vector<reasoner::Literal>& goal);

/// D_L restricted to the zoom, for people and for checks.
[[nodiscard]] reasoner::Description zoomedDescription(const LowLevelDomain& domain,
                                                      const Zoom& zoom);

/// The state after an action's effects under the high level's laws (s2). Conventions as in zoom().
[[nodiscard]] std::vector<reasoner::Literal> successor(const reasoner::Description& high_level,
                                                       const std::vector<reasoner::Literal>& state,
                                                       const reasoner::Atom& action);

}  // namespace kr3::refinement
