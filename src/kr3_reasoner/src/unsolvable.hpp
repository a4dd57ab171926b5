#pragma once

#include <string>

#include "plan_program.hpp"

namespace kr3::reasoner
{

/// Why there is no plan: the goal is false in every state (what excludes it), something that it
/// needs can never be reached even if nothing ever became false (which condition can never hold),
/// or there is no plan of the length. Private to the package.
/// @param unverified  why a plan that may be right was not accepted, if there was one
/// @throws Cancelled  between two calls of the solver; DeadlineExceeded
[[nodiscard]] std::string whyUnsolvable(const PlanningProblem& problem, const Formula& goal,
                                        int max_horizon, const std::string& unverified,
                                        const SearchLimit& limit);

}  // namespace kr3::reasoner
